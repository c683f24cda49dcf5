"""Load-penetration curves from CSV files."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from rockshed.components.common.units import cm

from ...core.errors import InputRefused, Problem, counted
from ...core.input_text import shown
from ...input_files.csv_table import CsvRow, CsvTable, read_csv
from ...input_files.form import LARGEST, first
from .measurement import FORCES, LENGTHS, Measurement

DEEPEST = 8 * cm
"""Largest penetration (m) of a curve.

The layer has 10 cm, and the rock must not come near the floor.
"""
_COLUMNS: Mapping[str, Mapping[str, float]] = {"penetration": LENGTHS, "load": FORCES}
_FORM = "write for instance `penetration (cm),load (kgf)` as the first line"


@dataclass(frozen=True)
class _Row:
    """A line of a file: its number, penetration (m) and load (N)."""

    line: int
    depth: float
    load: float


def read_curve(file: Path) -> Measurement:
    """Read a measured load-penetration curve.

    Parameters
    ----------
    file : Path
        CSV file with the columns ``penetration (unit)`` and ``load (unit)``, see
        :mod:`rockshed.input_files.csv_table`.

    Returns
    -------
    Measurement
        Three points at least.

    Raises
    ------
    InputRefused
        Everything that is wrong with the file, by line and column.
    """
    table = read_csv(file)
    if not table.rows:
        raise InputRefused([Problem(str(file), "is empty", _FORM)])
    columns = _header(table)
    problems: list[Problem] = []
    rows = []
    for line in table.rows[1:]:
        row = _row(table, line, columns, problems)
        if row is not None:
            rows.append(row)
    problems += _curve_problems(file, rows) if not problems else []
    if problems:
        raise InputRefused(first(problems))
    depth = np.array([row.depth for row in rows])
    return Measurement(file.name, depth, np.array([row.load for row in rows]))


def _header(table: CsvTable) -> list[tuple[str, float]]:
    """Return name, and size of the unit in SI, of each column."""
    titles = table.rows[0]
    problems = []
    columns = []
    for place, field in enumerate(titles.fields, 1):
        where = f"{table.place(titles)}, column {place}"
        name, unit = _title(field.text)
        if name not in _COLUMNS:
            fault = f"{shown(field.text)} is not penetration or load with a unit"
            problems.append(Problem(where, fault, _FORM))
        elif unit not in _COLUMNS[name]:
            remedy = f"choose of {', '.join(_COLUMNS[name])}: {_FORM}"
            problems.append(Problem(where, f"{shown(field.text)} has no known unit", remedy))
        else:
            columns.append((name, _COLUMNS[name][unit]))
    if not problems and sorted(name for name, _ in columns) != sorted(_COLUMNS):
        fault = "must have the columns penetration and load, each once"
        problems = [Problem(table.place(titles), fault, _FORM)]
    if problems:
        raise InputRefused(first(problems))
    return columns


def _title(text: str) -> tuple[str, str]:
    """Return name and unit in the title of a column; no unit where there is none."""
    parts = re.fullmatch(r"\s*(\w+?)\s*[\[(_ ]\s*([A-Za-z]+)\s*[\])]?\s*", text)
    return (parts.group(1).lower(), parts.group(2)) if parts else (text.strip().lower(), "")


def _row(
    table: CsvTable,
    line: CsvRow,
    columns: Sequence[tuple[str, float]],
    problems: list[Problem],
) -> _Row | None:
    where = table.place(line)
    if len(line.fields) != len(columns):
        fault = f"has {counted(len(line.fields), 'field')} instead of {len(columns)}"
        remedy = "separate penetration and load as in the first line"
        problems.append(Problem(where, fault, remedy))
        return None
    values = {}
    for place, (field, (name, unit)) in enumerate(zip(line.fields, columns, strict=True), 1):
        value = table.number(field)
        if value is None or abs(value) > LARGEST:
            fault = f"{shown(field.text)} is no finite number"
            problems.append(Problem(f"{where}, column {place} ({name})", fault, "write a number"))
        else:
            values[name] = value * unit
    if len(values) < len(columns):
        return None
    return _Row(line.line, values["penetration"], values["load"])


def _curve_problems(file: Path, rows: Sequence[_Row]) -> Iterator[Problem]:
    """Yield what is wrong with a curve as a whole."""
    if len(rows) < 3:
        remedy = "give at least three; for a single one give its spring constant"
        yield Problem(str(file), f"has {counted(len(rows), 'point')}", remedy)
    for before, row in pairwise(rows):
        if row.depth <= before.depth:
            fault = (
                f"{row.depth / cm:g} cm does not lie below the {before.depth / cm:g} cm "
                f"of line {before.line}"
            )
            remedy = "give the loading branch only, penetrations rising"
            yield Problem(f"{file}, line {row.line}, column penetration", fault, remedy)
    for row in rows:
        if not 0.0 <= row.depth <= DEEPEST:
            fault = f"{row.depth / cm:g} cm: allowed is 0 to {DEEPEST / cm:g} cm"
            remedy = "the computed layer is 10 cm thick; leave deeper points out"
            yield Problem(f"{file}, line {row.line}, column penetration", fault, remedy)
        if row.load < 0.0:
            fault = f"{row.load:g} N is negative"
            remedy = "give the force that pushes the rock down as positive"
            yield Problem(f"{file}, line {row.line}, column load", fault, remedy)
    if rows and not any(row.load > 0.0 for row in rows):
        yield Problem(str(file), "has no load above zero", "give the measured loads")
