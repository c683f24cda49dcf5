"""What was measured in a static loading test: a spring constant with its unit, or a load-penetration curve from a CSV file."""

import csv
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.units import cm, kgf, kN, mm, tf

from ...core.errors import InputRefused, Problem
from ...core.system.values import finite_number
from ...metrics.load_curve import DEPTH

FORCES: Mapping[str, float] = {"N": 1.0, "kN": kN, "kgf": kgf, "tf": tf}
LENGTHS: Mapping[str, float] = {"m": 1.0, "cm": cm, "mm": mm}
STIFFNESSES = {
    f"{force}/{length}": factor / size
    for force, factor in FORCES.items()
    for length, size in LENGTHS.items()
}

DEEPEST = 8 * cm
"""Largest penetration (m) of a curve: the layer has 10 cm, and the rock must not come near the floor."""
_COLUMNS = {"penetration": LENGTHS, "load": FORCES}
_FORM = "write for instance `penetration (cm),load (kgf)` as the first line"


@dataclass(frozen=True)
class Measurement:
    """Loads (N) at rising penetrations (m); a spring constant is the one load at 4 cm."""

    name: str
    depth: NDArray[np.float64]
    load: NDArray[np.float64]

    @property
    def is_curve(self) -> bool:
        """Whether there is more than one point."""
        return self.depth.size > 1


def of_stiffness(stiffness: float, name: str) -> Measurement:
    """The load at 4 cm that a secant spring constant (N/m) stands for."""
    return Measurement(name, np.array([DEPTH]), np.array([stiffness * DEPTH]))


def stiffness_from(text: str) -> float:
    """A spring constant (N/m) from a number with a unit: ``39.1 kgf/cm``.

    Raises:
        InputRefused: no number, no or another unit, not above zero.
    """
    found = re.fullmatch(r"\s*(\S*?\d\.?)\s*([A-Za-z]+/[A-Za-z]+)?\s*", text)
    units = f"write a number and one of {', '.join(STIFFNESSES)}: --stiffness '39.1 kgf/cm'"
    value = finite_number(found.group(1)) if found else None
    if found is None or value is None:
        raise InputRefused([Problem("--stiffness", f"{text!r} is no spring constant", units)])
    if found.group(2) not in STIFFNESSES:
        unit = f"the unit {found.group(2)}" if found.group(2) else "no unit"
        raise InputRefused([Problem("--stiffness", f"{text!r} has {unit}", units)])
    if value <= 0.0:
        raise InputRefused(
            [
                Problem(
                    "--stiffness",
                    f"{text!r} is not above zero",
                    "give the measured spring constant",
                )
            ]
        )
    return value * STIFFNESSES[found.group(2)]


def read_curve(file: Path) -> Measurement:
    """A measured load-penetration curve: columns ``penetration (unit)`` and ``load (unit)``; lines with ``#`` are comments.

    Raises:
        InputRefused: everything that is wrong with the file, by line and column.
    """
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputRefused(
            [
                Problem(
                    str(file),
                    f"cannot be read: {getattr(error, 'strerror', None) or error}",
                    "give a text file with comma-separated values",
                )
            ]
        ) from error
    lines = [
        (number, next(csv.reader([line]), []))
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise InputRefused([Problem(str(file), "is empty", _FORM)])
    columns = _header(file, *lines[0])
    problems: list[Problem] = []
    rows = [
        row
        for number, fields in lines[1:]
        if (row := _row(file, number, fields, columns, problems))
    ]
    problems += _shape(file, rows) if not problems else []
    if problems:
        raise InputRefused(problems)
    return Measurement(
        file.name, np.array([row.depth for row in rows]), np.array([row.load for row in rows])
    )


@dataclass(frozen=True)
class _Row:
    line: int
    depth: float
    load: float


def _header(file: Path, line: int, fields: Sequence[str]) -> list[tuple[str, float]]:
    """Name and unit (in SI) of each column."""
    problems, found = [], []
    for place, field in enumerate(fields, 1):
        matched = re.fullmatch(r"\s*(\w+?)\s*[\[(_ ]\s*([A-Za-z]+)\s*[\])]?\s*", field)
        name, unit = (
            (matched.group(1).lower(), matched.group(2)) if matched else (field.strip().lower(), "")
        )
        where = f"{file}, line {line}, column {place}"
        if name not in _COLUMNS:
            problems.append(
                Problem(where, f"{field.strip()!r} is not penetration or load with a unit", _FORM)
            )
        elif unit not in _COLUMNS[name]:
            problems.append(
                Problem(
                    where,
                    f"{field.strip()!r} has no known unit",
                    f"choose of {', '.join(_COLUMNS[name])}: {_FORM}",
                )
            )
        else:
            found.append((name, _COLUMNS[name][unit]))
    if not problems and sorted(name for name, _ in found) != sorted(_COLUMNS):
        problems = [
            Problem(
                f"{file}, line {line}",
                "must have the columns penetration and load, each once",
                _FORM,
            )
        ]
    if problems:
        raise InputRefused(problems)
    return found


def _row(
    file: Path,
    line: int,
    fields: Sequence[str],
    columns: Sequence[tuple[str, float]],
    problems: list[Problem],
) -> _Row | None:
    if len(fields) != len(columns):
        problems.append(
            Problem(
                f"{file}, line {line}",
                f"has {len(fields)} fields instead of {len(columns)}",
                "separate penetration and load by a comma, with a point in the numbers",
            )
        )
        return None
    values = {}
    for place, (field, (name, unit)) in enumerate(zip(fields, columns, strict=True), 1):
        value = finite_number(field)
        if value is None:
            problems.append(
                Problem(
                    f"{file}, line {line}, column {place} ({name})",
                    f"{field.strip()!r} is no finite number",
                    "write a number",
                )
            )
        else:
            values[name] = value * unit
    return (
        _Row(line, values["penetration"], values["load"]) if len(values) == len(columns) else None
    )


def _shape(file: Path, rows: Sequence[_Row]) -> Iterator[Problem]:
    """What is wrong with a curve as a whole."""
    if len(rows) < 3:
        yield Problem(
            str(file),
            f"has {len(rows)} points",
            "give at least three; for a single one use --stiffness",
        )
    for before, row in pairwise(rows):
        if row.depth <= before.depth:
            yield Problem(
                f"{file}, line {row.line}, column penetration",
                f"{row.depth / cm:g} cm does not lie below the "
                f"{before.depth / cm:g} cm of line {before.line}",
                "give the loading branch only, penetrations rising",
            )
    for row in rows:
        if not 0.0 <= row.depth <= DEEPEST:
            yield Problem(
                f"{file}, line {row.line}, column penetration",
                f"{row.depth / cm:g} cm: allowed is 0 to {DEEPEST / cm:g} cm",
                "the computed layer is 10 cm thick; leave deeper points out",
            )
        if row.load < 0.0:
            yield Problem(
                f"{file}, line {row.line}, column load",
                f"{row.load:g} N is negative",
                "give the force that pushes the rock down as positive",
            )
    if rows and not any(row.load > 0.0 for row in rows):
        yield Problem(str(file), "has no load above zero", "give the measured loads")
