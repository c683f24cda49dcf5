"""Study: a part of a paper that is reproduced, with its tasks, rows and figures."""

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ..runs.batch import COMPLETE, Outcome, Task
from ..runs.request import Request


@dataclass(frozen=True)
class Outcomes:
    """Outcomes of all runs of a reproduction.

    Attributes
    ----------
    by_key : mapping of str to Outcome
        By the key of the task.
    quick : bool
        Whether one run stands for all seeds.
    """

    by_key: Mapping[str, Outcome]
    quick: bool = False

    def of(self, task: Task) -> Outcome:
        """Return the outcome of a task."""
        return self.by_key[task.key]


@dataclass(frozen=True)
class Row:
    """Line of the report, in the units of the paper.

    Attributes
    ----------
    quantity, unit : str
        Name and unit; ``1`` where there is none.
    paper, experiment : float, optional
        References.
    computed, spread : float, optional
        Mean and standard deviation over the runs; no spread for one run.
    model : str
        Set of model options.
    verdict : str
        Of a claim: whether it holds.
    note : str
        How the row was computed, or why there is nothing in it.
    runs, seeds, options, fmus
        Origin of ``computed``: keys of the tasks, their seeds, parameters of the model, SHA-256 of
        the FMUs by component.
    detail : bool
        Left out of the table on the screen.
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
        """Return computed / reference - 1, or None without a value or a reference."""
        if self.computed is None or not reference:
            return None
        return self.computed / reference - 1.0


def verdict(holds: bool) -> str:
    """Return in words whether a claim holds."""
    return "holds" if holds else "does not"


def shortened(task: Task, stop_time: float) -> Request:
    """Return the beginning of a run, for :attr:`Study.stands_on`.

    Parameters
    ----------
    task : Task
        The run.
    stop_time : float
        End of the beginning (s).

    Returns
    -------
    Request
        Without FMU files: components run in the process that carries it out.
    """
    options = {**task.request.options, "stop_time": stop_time}
    return replace(task.request, options=options, in_process=True)


def _no_tasks(quick: bool) -> list[Task]:
    return []


def _no_figures(outcomes: Outcomes, rows: Sequence[Row], folder: Path) -> list[Path]:
    return []


@dataclass(frozen=True)
class Study:
    """Part of a paper that is reproduced.

    Attributes
    ----------
    name, title : str
        On the command line; in the report.
    place : float
        Where in the paper; studies are listed in this order.
    rows : callable
        From the outcomes to the lines of the report.
    tasks : callable
        From ``quick`` to the runs.
    draw : callable
        From outcomes, rows and a folder to the figures, as files.
    notes : sequence of str
        Remarks for the reader, one sentence each.
    stands_on : mapping of str to Request
        Short runs by name, through all the kernels that the study's own runs go through: what
        they give tells whether kept results come from the present kernel.
    """

    name: str
    title: str
    place: float
    rows: Callable[[Outcomes], list[Row]]
    tasks: Callable[[bool], list[Task]] = _no_tasks
    draw: Callable[[Outcomes, Sequence[Row], Path], list[Path]] = _no_figures
    notes: Sequence[str] = ()
    stands_on: Mapping[str, Request] = field(default_factory=dict)


@dataclass(frozen=True)
class Measure:
    """Quantity of the report that outcomes have.

    Attributes
    ----------
    quantity, unit : str
        Name and unit, as in the paper.
    scale : float
        Size of the unit in SI.
    metric : str or callable
        Name of a metric, or the function of a complete outcome that computes it (SI).
    """

    quantity: str
    unit: str
    scale: float
    metric: str | Callable[[Outcome], float]

    def of(self, outcome: Outcome) -> float | None:
        """Return the value for an outcome, in the unit of the paper; None where it has none."""
        if isinstance(self.metric, str):
            value = outcome.metrics.get(self.metric)
        else:
            value = self.metric(outcome)
        return None if value is None else value / self.scale


def row_of_runs(
    measure: Measure,
    tasks: Sequence[Task],
    outcomes: Outcomes,
    paper: float | None = None,
    experiment: float | None = None,
    note: str = "",
) -> Row:
    """Return the row of a quantity over one or several runs (seeds of one model).

    Parameters
    ----------
    measure : Measure
        The quantity.
    tasks : sequence of Task
        Runs over which the mean is taken. Runs that failed, or do not have the quantity, are left
        out and named in the note.
    outcomes : Outcomes
        Outcomes of all runs.
    paper, experiment : float, optional
        References, in the unit of the measure.
    note : str
        How the row was computed.

    Returns
    -------
    Row
        Mean and standard deviation beside the references.
    """
    every = [outcomes.of(task) for task in tasks]
    complete = [outcome for outcome in every if outcome.status == COMPLETE]
    values = [value for outcome in complete if (value := measure.of(outcome)) is not None]
    remarks = [note] if note else []
    if len(complete) < len(every):
        remarks.append(_failures(every))
    if len(values) < len(complete):
        missing = len(complete) - len(values)
        remarks.append(f"{missing} of {len(complete)} runs have no such metric")
    return Row(
        measure.quantity,
        measure.unit,
        paper,
        experiment,
        sum(values) / len(values) if values else None,
        statistics.stdev(values) if len(values) > 1 else None,
        tasks[0].model,
        note="; ".join(remarks),
        **origin(tasks, outcomes),
    )


def _failures(outcomes: Sequence[Outcome]) -> str:
    """Return in words how many runs did not end, and why; each reason once."""
    failed = [outcome for outcome in outcomes if outcome.status != COMPLETE]
    reasons = dict.fromkeys(f"{o.status}: {o.error}".removesuffix(": ") for o in failed)
    return f"{len(failed)} of {len(outcomes)} runs did not end ({'; '.join(reasons)})"


def detail(row: Row) -> Row:
    """Return the row, left out of the table on the screen."""
    return replace(row, detail=True)


def origin(tasks: Sequence[Task], outcomes: Outcomes) -> dict[str, Any]:
    """Return the origin of a row's value.

    Parameters
    ----------
    tasks : sequence of Task
        Runs of the row; the first one with FMUs tells the options of the model.
    outcomes : Outcomes
        Outcomes of all runs.

    Returns
    -------
    dict
        Keywords of :class:`Row`: runs, seeds, options and fmus.
    """
    every = [outcomes.of(task) for task in tasks]
    first = next((outcome for outcome in every if outcome.fmus), every[0])
    options = {name: value for name, value in first.options.items() if name != "seed"}
    return {
        "runs": [task.key for task in tasks],
        "seeds": [task.seed for task in tasks if task.seed is not None],
        "options": options,
        "fmus": dict(first.fmus),
    }
