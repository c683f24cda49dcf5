"""Rows of studies as a table for the screen and as data."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.table import Table

from ..commands.screen import plain_table
from ..runs.batch import Outcome, Task
from .study import Row, Study

FORMAT = "rockshed reproduction 1"
"""Name and version of the form of ``reproduction.json``."""
HEADINGS = (
    "quantity",
    "unit",
    "paper",
    "experiment",
    "computed",
    "±",
    "to paper",
    "to exp.",
    "model",
)
NUMBERS = HEADINGS[2:8]


@dataclass(frozen=True)
class Part:
    """What a study gave."""

    study: Study
    rows: Sequence[Row]
    figures: Sequence[Path] = ()


def cells(row: Row) -> tuple[str, ...]:
    """A row as text, in the order of :data:`HEADINGS`. A claim has its verdict in the place of the deviations' model."""
    return (
        row.quantity,
        "" if row.unit == "1" else row.unit,
        _number(row.paper),
        _number(row.experiment),
        _number(row.computed),
        _number(row.spread),
        _percent(row.deviation(row.paper)),
        _percent(row.deviation(row.experiment)),
        ": ".join(filter(None, (row.model, row.verdict))),
    )


def is_empty(row: Row) -> bool:
    """Whether a row that should have a computed figure has none: its note then says why."""
    return row.computed is None and not row.verdict


def _number(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def _percent(deviation: float | None) -> str:
    return "" if deviation is None else f"{100.0 * deviation:+.0f} %"


def table(parts: Sequence[Part]) -> Table:
    """All studies in one table, details left out; a row without a result says why below."""
    made = plain_table(*HEADINGS, right=NUMBERS)
    for number, part in enumerate(parts):
        made.add_row(
            f"[bold]{part.study.title}[/]" if number == 0 else f"\n[bold]{part.study.title}[/]"
        )
        for row in part.rows:
            if row.detail:
                continue
            made.add_row(*cells(row))
            if is_empty(row) or row.verdict:
                made.add_row(f"[dim]  {_plain(row.note)}[/]")
    return made


def _plain(text: str) -> str:
    from rich.markup import escape

    return escape(text)


def as_data(
    parts: Sequence[Part],
    tasks: Sequence[Task],
    outcomes: Sequence[Outcome],
    folder: Path,
    **facts: Any,
) -> dict[str, Any]:
    """Everything of a reproduction as plain data: studies with their rows, and what was run."""
    by_key = {task.key: task for task in tasks}
    return {
        "format": FORMAT,
        **facts,
        "studies": [
            {
                "name": p.study.name,
                "title": p.study.title,
                "notes": list(p.study.notes),
                "figures": [file.relative_to(folder).as_posix() for file in p.figures],
                "rows": [row_data(row) for row in p.rows],
            }
            for p in parts
        ],
        "runs": [_run(by_key[outcome.key], outcome) for outcome in outcomes],
    }


def row_data(row: Row) -> dict[str, Any]:
    """A row as plain data."""
    return {
        "quantity": row.quantity,
        "unit": row.unit,
        "paper": row.paper,
        "experiment": row.experiment,
        "computed": row.computed,
        "spread": row.spread,
        "deviation_from_paper": row.deviation(row.paper),
        "deviation_from_experiment": row.deviation(row.experiment),
        "model": row.model,
        "verdict": row.verdict,
        "note": row.note,
        "model_options": dict(row.options),
        "seeds": list(row.seeds),
        "fmus": dict(row.fmus),
        "runs": list(row.runs),
    }


def _run(task: Task, outcome: Outcome) -> dict[str, Any]:
    return {
        "name": task.key,
        "case": task.request.target,
        "model": task.request.model,
        "settings": task.settings,
        "coupling": task.request.coupling,
        "options": dict(task.request.options),
        "seed": task.seed,
        "status": outcome.status,
        "error": outcome.error,
        "wall_time": outcome.wall_time,
        "model_options": dict(outcome.options),
        "fmus": dict(outcome.fmus),
    }
