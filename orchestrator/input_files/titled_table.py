"""Columns with titles and units, ``mass (kg)``, of CSV files."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..core.errors import InputRefused, Problem
from ..core.input_text import shown
from ..core.system.quantities import in_si
from .csv_table import CsvTable, read_csv
from .form import LARGEST

_TITLE = re.compile(r"\s*(.+?)\s*[\[(_ ]\s*([A-Za-z0-9/]+)\s*[\])]?\s*")


@dataclass(frozen=True)
class TitledColumns:
    """Columns of known titles.

    Attributes
    ----------
    values : mapping of str to array of float, shape (rows,)
        By title, in SI; NaN where a field is empty or not a number.
    places : sequence of str
        File and line of each row.
    others : mapping of str to str
        File, line and column of each other title.
    """

    values: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    places: Sequence[str] = ()
    others: Mapping[str, str] = field(default_factory=dict)


def titled_columns(path: Path, units: Mapping[str, str], problems: list[Problem]) -> TitledColumns:
    """Read the columns of known titles; others are passed over.

    Parameters
    ----------
    path : Path
        CSV file, see :mod:`.csv_table`. Its first line has titles with units: ``mass (kg)``,
        ``mass_kg``; a title without one is in SI.
    units : mapping of str to str
        SI unit by title.
    problems : list of Problem
        Faults are appended, with line and column.

    Returns
    -------
    TitledColumns
        Those columns that the file has.
    """
    try:
        table = read_csv(path)
    except InputRefused as refusal:
        problems += refusal.problems
        return TitledColumns()
    if not table.rows:
        remedy = f"write a line of titles, as {_example(units)}"
        problems.append(Problem(str(path), "is empty", remedy))
        return TitledColumns()
    found, others = _titles(table, units, problems)
    values = {
        name: np.array(
            [_value(table, i, column, scale, problems) for i in range(1, len(table.rows))]
        )
        for name, (column, scale) in found.items()
    }
    return TitledColumns(values, [table.place(row) for row in table.rows[1:]], others)


def needed(
    path: Path, columns: Mapping[str, object], names: Sequence[str], units: Mapping[str, str]
) -> list[Problem]:
    """Return a problem if a file lacks any of the columns of these names."""
    missing = [name for name in names if name not in columns]
    if not missing:
        return []
    text = f"has no column {', '.join(missing)}"
    return [Problem(str(path), text, f"write the titles as in {_example(units)}")]


def _example(units: Mapping[str, str]) -> str:
    return ",".join(name if unit == "1" else f"{name} ({unit})" for name, unit in units.items())


def _titles(
    table: CsvTable, units: Mapping[str, str], problems: list[Problem]
) -> tuple[dict[str, tuple[int, float]], dict[str, str]]:
    """Return number and size of the unit of each known column, and the places of other titles."""
    found: dict[str, tuple[int, float]] = {}
    others: dict[str, str] = {}
    titles = table.rows[0]
    for column, entry in enumerate(titles.fields):
        parts = _TITLE.fullmatch(entry.text)
        plain = entry.text.strip().lower()
        name = plain if plain in units or parts is None else parts.group(1).lower()
        if name not in units:
            others[entry.text] = table.place(titles, column)
            continue
        if name in found:
            problems.append(Problem(table.place(titles, column), f"{name} is there twice", ""))
        written = parts.group(2) if parts and name != plain else ""
        try:
            found[name] = (column, in_si(f"1 {written}".strip(), units[name]))
        except ValueError as error:
            text = f"{shown(entry.text)}: {error}"
            problems.append(Problem(table.place(titles, column), text, ""))
    return found, others


def _value(table: CsvTable, i: int, column: int, scale: float, problems: list[Problem]) -> float:
    row = table.rows[i]
    if column >= len(row.fields) or not row.fields[column].text:
        return float("nan")
    value = table.number(row.fields[column])
    if value is None or abs(value) > LARGEST:
        text = f"{shown(row.fields[column].text)} is no finite number"
        problems.append(Problem(table.place(row, column), text, "write a number"))
        return float("nan")
    return value * scale
