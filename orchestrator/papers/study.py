"""What a study is made of: tasks (runs), their outcomes, rows, and figures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ..runs.batch import COMPLETE, Outcome, Task


@dataclass(frozen=True)
class Outcomes:
    """The outcomes of all runs."""

    by_key: Mapping[str, Outcome]
    quick: bool = False

    def of(self, task: Task) -> Outcome:
        """The outcome of a task."""
        return self.by_key[task.key]


@dataclass(frozen=True)
class Row:
    """A line of the report, in the units of the paper.

    computed, spread: mean and standard deviation over the runs (spread: None for one run).
    verdict: for a claim: whether it holds. note: how the row was found, or why there is nothing in it.
    runs, seeds, options, fmus: where ``computed`` comes from.
    detail: left out of the table on the screen.
    """

    quantity: str
    unit: str
    paper: float | None = None
    experiment: float | None = None
    computed: float | None = None
    spread: float | None = None
    model: str = ""
    verdict: str = ""
    note: str = ""
    runs: Sequence[str] = ()
    seeds: Sequence[int] = ()
    options: Mapping[str, Any] = field(default_factory=dict)
    fmus: Mapping[str, str] = field(default_factory=dict)
    detail: bool = False

    def deviation(self, reference: float | None) -> float | None:
        """computed / reference - 1."""
        return None if self.computed is None or not reference else self.computed / reference - 1.0


def verdict(holds: bool) -> str:
    """In words."""
    return "holds" if holds else "does not"


def _no_tasks(quick: bool) -> list[Task]:
    return []


def _no_figures(found: Outcomes, rows: Sequence[Row], folder: Path) -> list[Path]:
    return []


@dataclass(frozen=True)
class Study:
    """A part of a paper that is reproduced.

    place: where in the paper; the studies are listed by it.
    tasks(quick): the runs. rows(outcomes): the lines of the report. draw(outcomes, rows, folder): figures, as files.
    notes: what a reader has to know, one sentence each.
    """

    name: str
    title: str
    place: float
    rows: Callable[[Outcomes], list[Row]]
    tasks: Callable[[bool], list[Task]] = _no_tasks
    draw: Callable[[Outcomes, Sequence[Row], Path], list[Path]] = _no_figures
    notes: Sequence[str] = ()


def row_of_runs(
    quantity: str,
    unit: str,
    scale: float,
    figure: str | Callable[[Outcome], float],
    tasks: Sequence[Task],
    found: Outcomes,
    paper: float | None = None,
    experiment: float | None = None,
    note: str = "",
) -> Row:
    """A figure of one or several runs (seeds of one model) beside its references.

    figure: name of the figure, or what finds it (SI) in an outcome that is complete.
    scale: size of ``unit`` in SI; references are given in ``unit``. Runs that failed, or have no such figure, are left out and
    named in the note.
    """
    outcomes = [found.of(task) for task in tasks]
    ended = [outcome for outcome in outcomes if outcome.status == COMPLETE]
    each = [
        outcome.figures.get(figure) if isinstance(figure, str) else figure(outcome)
        for outcome in ended
    ]
    values = [value / scale for value in each if value is not None]
    failures = list(
        dict.fromkeys(
            f"{o.status}: {o.error}".removesuffix(": ") for o in outcomes if o.status != COMPLETE
        )
    )
    failed = (
        [
            f"{len(outcomes) - len(ended)} of {len(outcomes)} runs did not end ({'; '.join(failures)})"
        ]
        if failures
        else []
    )
    failed += (
        [f"{len(ended) - len(values)} of {len(ended)} runs have no such figure"]
        if len(values) < len(ended)
        else []
    )
    mean = sum(values) / len(values) if values else None
    said = "; ".join([note] * bool(note) + failed)
    return Row(
        quantity,
        unit,
        paper,
        experiment,
        mean,
        _spread(values),
        tasks[0].model,
        note=said,
        **origin(tasks, found),
    )


def detail(row: Row) -> Row:
    """The row, left out of the table on the screen."""
    return replace(row, detail=True)


def origin(tasks: Sequence[Task], found: Outcomes) -> dict[str, Any]:
    """Where a row's figure comes from: runs, seeds, model options and FMUs."""
    first = next((found.of(task) for task in tasks if found.of(task).fmus), found.of(tasks[0]))
    options = {name: value for name, value in first.options.items() if name != "seed"}
    return {
        "runs": [task.key for task in tasks],
        "seeds": [task.seed for task in tasks if task.seed is not None],
        "options": options,
        "fmus": dict(first.fmus),
    }


def _spread(values: Sequence[float]) -> float | None:
    if len(values) < 2:
        return None
    mean = sum(values) / len(values)
    return float((sum((value - mean) ** 2 for value in values) / (len(values) - 1)) ** 0.5)
