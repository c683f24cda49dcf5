"""Load-penetration curves from CSV files."""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from rockshed.components.common.units import cm

from ...core.errors import InputRefused, Problem
from ...core.system.values import finite_number
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
        CSV file with the columns ``penetration (unit)`` and ``load (unit)``; lines that begin
        with # are comments.

    Returns
    -------
    Measurement
        Three points at least.

    Raises
    ------
    InputRefused
        Everything that is wrong with the file, by line and column.
    """
    lines = _lines(file)
    if not lines:
        raise InputRefused([Problem(str(file), "is empty", _FORM)])
    columns = _header(file, *lines[0])
    problems: list[Problem] = []
    rows = []
    for number, fields in lines[1:]:
        row = _row(f"{file}, line {number}", number, fields, columns, problems)
        if row is not None:
            rows.append(row)
    problems += _curve_problems(file, rows) if not problems else []
    if problems:
        raise InputRefused(problems)
    depth = np.array([row.depth for row in rows])
    return Measurement(file.name, depth, np.array([row.load for row in rows]))


def _lines(file: Path) -> list[tuple[int, list[str]]]:
    """Return number and fields of each line that is neither blank nor a comment."""
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = f"cannot be read: {getattr(error, 'strerror', None) or error}"
        remedy = "give a text file with comma-separated values"
        raise InputRefused([Problem(str(file), reason, remedy)]) from error
    return [
        (number, next(csv.reader([line]), []))
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]


def _header(file: Path, line: int, fields: Sequence[str]) -> list[tuple[str, float]]:
    """Return name, and size of the unit in SI, of each column."""
    problems = []
    columns = []
    for place, text in enumerate(fields, 1):
        where = f"{file}, line {line}, column {place}"
        name, unit = _title(text)
        if name not in _COLUMNS:
            fault = f"{text.strip()!r} is not penetration or load with a unit"
            problems.append(Problem(where, fault, _FORM))
        elif unit not in _COLUMNS[name]:
            remedy = f"choose of {', '.join(_COLUMNS[name])}: {_FORM}"
            problems.append(Problem(where, f"{text.strip()!r} has no known unit", remedy))
        else:
            columns.append((name, _COLUMNS[name][unit]))
    if not problems and sorted(name for name, _ in columns) != sorted(_COLUMNS):
        fault = "must have the columns penetration and load, each once"
        problems = [Problem(f"{file}, line {line}", fault, _FORM)]
    if problems:
        raise InputRefused(problems)
    return columns


def _title(text: str) -> tuple[str, str]:
    """Return name and unit in the title of a column; no unit where there is none."""
    parts = re.fullmatch(r"\s*(\w+?)\s*[\[(_ ]\s*([A-Za-z]+)\s*[\])]?\s*", text)
    return (parts.group(1).lower(), parts.group(2)) if parts else (text.strip().lower(), "")


def _row(
    where: str,
    line: int,
    fields: Sequence[str],
    columns: Sequence[tuple[str, float]],
    problems: list[Problem],
) -> _Row | None:
    if len(fields) != len(columns):
        fault = f"has {len(fields)} fields instead of {len(columns)}"
        remedy = "separate penetration and load by a comma, with a point in the numbers"
        problems.append(Problem(where, fault, remedy))
        return None
    values = {}
    for place, (text, (name, unit)) in enumerate(zip(fields, columns, strict=True), 1):
        value = finite_number(text)
        if value is None:
            fault = f"{text.strip()!r} is no finite number"
            problems.append(Problem(f"{where}, column {place} ({name})", fault, "write a number"))
        else:
            values[name] = value * unit
    if len(values) < len(columns):
        return None
    return _Row(line, values["penetration"], values["load"])


def _curve_problems(file: Path, rows: Sequence[_Row]) -> Iterator[Problem]:
    """Yield what is wrong with a curve as a whole."""
    if len(rows) < 3:
        remedy = "give at least three; for a single one give its spring constant"
        yield Problem(str(file), f"has {len(rows)} points", remedy)
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
