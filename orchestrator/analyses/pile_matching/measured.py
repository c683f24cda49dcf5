"""Force and velocity at the head of a pile over time, from a CSV file."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from ...core.errors import InputRefused, Problem, counted
from ...core.input_text import shown
from ...core.system.quantities import in_si
from ...input_files.csv_table import CsvTable, read_csv
from ...input_files.form import LARGEST, first
from ..frame import FloatArray

FEWEST = 50
"""Smallest number of rows of a measured blow."""
_UNITS: Mapping[str, str] = {"time": "s", "force": "N", "velocity": "m/s"}
"""SI units of the columns."""
_FORM = "write for instance `time (ms),force (kN),velocity (m/s)` as the first line"


@dataclass(frozen=True)
class MeasuredBlow:
    """A blow measured at one place of a pile.

    Attributes
    ----------
    name : str
        Of the file.
    time, force, velocity : array of float, shape (rows,)
        Rising times (s), forces (N, compression positive), velocities (m/s, downwards).
    """

    name: str
    time: FloatArray
    force: FloatArray
    velocity: FloatArray

    def mean(self, values: FloatArray, step: float, steps: int) -> FloatArray:
        """Return the means of one of the columns over steps from its first time on.

        Parameters
        ----------
        values : array of float, shape (rows,)
            Force or velocity, a straight line between two rows.
        step : float
            Length of a step (s).
        steps : int
            Number of steps.

        Returns
        -------
        array of float, shape (steps,)
        """
        parts = 0.5 * (values[1:] + values[:-1]) * np.diff(self.time)
        total = np.concatenate([[0.0], np.cumsum(parts)])
        ends = self.time[0] + step * np.arange(steps + 1)
        fine = np.union1d(self.time, ends)
        between = np.interp(fine, self.time, values)
        areas = np.concatenate(
            [[0.0], np.cumsum(0.5 * (between[1:] + between[:-1]) * np.diff(fine))]
        )
        assert np.isclose(areas[-1], total[-1], rtol=1e-6, atol=1e-9 * np.abs(parts).sum())
        means: FloatArray = np.diff(np.interp(ends, fine, areas)) / step
        return means


def read_blow(file: Path) -> MeasuredBlow:
    """Read a measured blow.

    Parameters
    ----------
    file : Path
        CSV file with the columns ``time (unit)``, ``force (unit)`` and ``velocity (unit)``.

    Returns
    -------
    MeasuredBlow
        :data:`FEWEST` rows at least.

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
    rows = np.array([_numbers(table, i, columns, problems) for i in range(1, len(table.rows))])
    if not problems:
        problems += _blow_problems(file, rows, columns)
    if problems:
        raise InputRefused(first(problems))
    by_name = {name: rows[:, place] for place, (name, _) in enumerate(columns)}
    return MeasuredBlow(file.name, by_name["time"], by_name["force"], by_name["velocity"])


def _header(table: CsvTable) -> list[tuple[str, float]]:
    """Return name, and size of the unit in SI, of each column."""
    titles = table.rows[0]
    problems: list[Problem] = []
    columns: list[tuple[str, float]] = []
    for place, field in enumerate(titles.fields, 1):
        where = f"{table.place(titles)}, column {place}"
        parts = re.fullmatch(r"\s*(\w+)\s*[\[(]\s*(.+?)\s*[\])]\s*", field.text)
        name = parts.group(1).lower() if parts else ""
        if parts is None or name not in _UNITS:
            text = f"{shown(field.text)} is not time, force or velocity with a unit"
            problems.append(Problem(where, text, _FORM))
            continue
        try:
            columns.append((name, in_si(f"1 {parts.group(2)}", _UNITS[name])))
        except ValueError as error:
            problems.append(Problem(where, str(error), _FORM))
    if not problems and sorted(name for name, _ in columns) != sorted(_UNITS):
        text = "must have the columns time, force and velocity, each once"
        problems.append(Problem(table.place(titles), text, _FORM))
    if problems:
        raise InputRefused(first(problems))
    return columns


def _numbers(
    table: CsvTable, row: int, columns: list[tuple[str, float]], problems: list[Problem]
) -> list[float]:
    """Return the values of a row in SI; 0 where one is refused."""
    line = table.rows[row]
    if len(line.fields) != len(columns):
        text = f"has {counted(len(line.fields), 'field')} instead of {len(columns)}"
        problems.append(Problem(table.place(line), text, "separate them as in the first line"))
        return [0.0] * len(columns)
    values = []
    for place, (field, (name, unit)) in enumerate(zip(line.fields, columns, strict=True), 1):
        value = table.number(field)
        if value is None or abs(value) > LARGEST:
            where = f"{table.place(line)}, column {place} ({name})"
            text = f"{shown(field.text)} is no finite number"
            problems.append(Problem(where, text, "write a number"))
        values.append((value or 0.0) * unit)
    return values


def _blow_problems(
    file: Path, rows: FloatArray, columns: list[tuple[str, float]]
) -> Iterator[Problem]:
    """Yield what is wrong with a blow as a whole."""
    if len(rows) < FEWEST:
        yield Problem(str(file), f"has {len(rows)} rows", f"give {FEWEST} at least")
        return
    names = [name for name, _ in columns]
    time = rows[:, names.index("time")]
    for number, (before, after) in enumerate(pairwise(time), 3):
        if after <= before:
            text = f"{after:g} s is not later than {before:g} s"
            yield Problem(f"{file}, line {number}, column time", text, "give rising times")
            return
    force, velocity = rows[:, names.index("force")], rows[:, names.index("velocity")]
    if force.max() <= 0.0 or force.max() < -force.min():
        remedy = "give forces positive in compression"
        yield Problem(str(file), "the largest force is no compression", remedy)
    if velocity.max() <= 0.0 or velocity[np.argmax(force)] < 0.0:
        remedy = "give velocities positive downwards, measured where the force is"
        yield Problem(str(file), "the head does not move down when it is struck", remedy)
