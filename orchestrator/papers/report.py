"""Rows of studies as tables and as plain data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..runs.batch import Outcome, Task
from ..tables import Table
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
    "verdict",
)
NUMBERS = HEADINGS[2:8]


@dataclass(frozen=True)
class Part:
    """Result of a study: its rows, its figures as files, and its stamps by name."""

    study: Study
    rows: Sequence[Row]
    figures: Sequence[Path] = ()
    stamps: Mapping[str, str] = field(default_factory=dict)


def cells(row: Row) -> tuple[str, ...]:
    """Return a row as text.

    Parameters
    ----------
    row : Row
        A line of the report.

    Returns
    -------
    tuple of str
        In the order of :data:`HEADINGS`.
    """
    return (
        row.quantity,
        "" if row.unit == "1" else row.unit,
        _number(row.paper),
        _number(row.experiment),
        _number(row.computed),
        _number(row.spread),
        _percent(row.deviation(row.paper)),
        _percent(row.deviation(row.experiment)),
        row.model,
        row.verdict,
    )


def is_empty(row: Row) -> bool:
    """Tell whether a row that should have a computed value has none; its note then says why."""
    return row.computed is None and not row.verdict


def _number(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def _percent(deviation: float | None) -> str:
    return "" if deviation is None else f"{100.0 * deviation:+.0f} %"


def table(part: Part) -> Table:
    """Return the table of a study without the details and without empty columns.

    Parameters
    ----------
    part : Part
        Rows of the study.

    Returns
    -------
    Table
        The notes of rows without a value, and of claims, are the notes of the table.
    """
    shown = [row for row in part.rows if not row.detail]
    lines = [cells(row) for row in shown]
    used = [place for place in range(len(HEADINGS)) if any(line[place] for line in lines)]
    headings = [HEADINGS[place] for place in used]
    made = Table(headings, right=NUMBERS, title=part.study.title)
    for row, line in zip(shown, lines, strict=True):
        made.add(*(line[place] for place in used))
        if row.note and (is_empty(row) or row.verdict):
            made.notes.append(f"{row.quantity}: {row.note}")
    return made


def as_data(
    parts: Sequence[Part],
    tasks: Sequence[Task],
    outcomes: Sequence[Outcome],
    folder: Path,
    facts: Mapping[str, Any],
) -> dict[str, Any]:
    """Return a reproduction as plain data.

    Parameters
    ----------
    parts : sequence of Part
        Studies with rows and figures.
    tasks : sequence of Task
        Runs that were asked for.
    outcomes : sequence of Outcome
        Their outcomes.
    folder : Path
        Folder from which the paths of figures count.
    facts : mapping
        Paper, time, versions.

    Returns
    -------
    dict
        Content of ``reproduction.json``.
    """
    by_key = {task.key: task for task in tasks}
    return {
        "format": FORMAT,
        **facts,
        "studies": [_study_data(part, folder) for part in parts],
        "runs": [_run_data(by_key[outcome.key], outcome) for outcome in outcomes],
    }


def _study_data(part: Part, folder: Path) -> dict[str, Any]:
    return {
        "name": part.study.name,
        "title": part.study.title,
        "notes": list(part.study.notes),
        "stamps": dict(part.stamps),
        "figures": [file.relative_to(folder).as_posix() for file in part.figures],
        "rows": [row_data(row) for row in part.rows],
    }


def row_data(row: Row) -> dict[str, Any]:
    """Return a row as plain data."""
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


def _run_data(task: Task, outcome: Outcome) -> dict[str, Any]:
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
