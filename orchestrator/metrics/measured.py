"""Measured curves from CSV files, and how far computed ones are off: peak, impulse, duration."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from rockshed.components.common.units import SCREEN_UNITS

from ..core.errors import InputRefused, Problem, counted
from ..core.input_text import shown
from ..core.results.series import Series
from ..core.system.quantities import in_si
from ..input_files.csv_table import CsvTable, read_csv
from ..input_files.form import first
from ..tables import Table, digits
from .values import Samples

LASTING = 0.1
"""Part of its peak above which a curve counts towards its duration: less drowns in a measured
noise."""
_TITLE = re.compile(r"(.*?)\s*[\[(]\s*([^\[\]()]*?)\s*[\])]")
_FORM = "write for instance `time (ms),force (kN)` as the first line"
_SCREEN = {"N": "kN", "N.s": "N s", "s": "ms", "m": "mm", "Pa": "kPa", "N.m": "kN m"}
"""Units of the screen by those of the values."""


@dataclass(frozen=True)
class MeasuredCurve:
    """A measured quantity over time.

    Attributes
    ----------
    name : str
        Title of its column, without the unit.
    unit : str
        SI unit of the values, that of the computed variables that it is compared with.
    time : array of float, shape (n,)
        In s, rising.
    values : array of float, shape (n,)
        In ``unit``.
    """

    name: str
    unit: str
    time: Samples
    values: Samples


@dataclass(frozen=True)
class Deviation:
    """A number of a computed curve beside that of a measured one.

    Attributes
    ----------
    quantity : str
        ``peak``, ``impulse`` or ``duration``.
    unit : str
        SI unit of both.
    computed, measured : float
        The numbers.
    """

    quantity: str
    unit: str
    computed: float
    measured: float

    @property
    def error(self) -> float | None:
        """Return computed / measured - 1; None of a measured zero."""
        return self.computed / self.measured - 1.0 if self.measured else None


@dataclass(frozen=True)
class Agreement:
    """A computed variable beside a measured curve.

    Attributes
    ----------
    run : str
        Name of the run.
    variable : str
        Name of the variable.
    measured : str
        Name of the curve.
    deviations : sequence of Deviation
        Peak, impulse and duration over the time that both have.
    """

    run: str
    variable: str
    measured: str
    deviations: Sequence[Deviation]

    def as_data(self) -> dict[str, Any]:
        """Return the agreement as plain data, in SI."""
        told = {
            entry.quantity: {
                "unit": entry.unit,
                "computed": entry.computed,
                "measured": entry.measured,
                "error": entry.error,
            }
            for entry in self.deviations
        }
        return {"run": self.run, "variable": self.variable, "measured": self.measured, **told}

    def in_words(self) -> str:
        """Return the agreement as a line below a picture."""
        parts = (
            f"{entry.quantity} {_with_unit(entry.computed, entry.unit)} for "
            f"{_with_unit(entry.measured, entry.unit)}{_error(entry, ' ({})')}"
            for entry in self.deviations
        )
        return f"{self.run}: {self.variable} for measured {self.measured}: {', '.join(parts)}"


def read_measured(file: str | Path, units: Iterable[str]) -> list[MeasuredCurve]:
    """Read measured curves.

    Parameters
    ----------
    file : path
        CSV file, see :mod:`rockshed.input_files.csv_table`: a column ``time (ms)`` with rising
        times, and others with a name and a unit: ``force (kN)``.
    units : iterable of str
        SI units of the computed variables; each column has to be in a unit of one of these kinds.

    Returns
    -------
    list of MeasuredCurve
        One at least.

    Raises
    ------
    InputRefused
        Everything that is wrong with the file, by line and column.
    """
    table = read_csv(Path(file))
    if not table.rows:
        raise InputRefused([Problem(str(file), "is empty", _FORM)])
    titles = _titles(table, list(dict.fromkeys(units)))
    numbers = _numbers(table, len(titles))
    at = next(i for i, title in enumerate(titles) if title.is_time)
    _check_times(table, numbers[:, at])
    time = numbers[:, at] * titles[at].factor
    return [
        MeasuredCurve(title.name, title.unit, time, numbers[:, i] * title.factor)
        for i, title in enumerate(titles)
        if i != at
    ]


@dataclass(frozen=True)
class _Title:
    """A column: its name, the SI unit of its values, and the size of its own unit in that."""

    name: str
    unit: str
    factor: float

    @property
    def is_time(self) -> bool:
        """Whether it is the column of times."""
        return self.name.lower() in ("time", "t")


def _titles(table: CsvTable, units: Sequence[str]) -> list[_Title]:
    problems: list[Problem] = []
    found = []
    row = table.rows[0]
    for number, field in enumerate(row.fields):
        parts = _TITLE.fullmatch(field.text)
        name, unit = parts.groups() if parts else (field.text, "")
        wanted = ["s"] if _Title(name, "", 1.0).is_time else units
        try:
            found.append(_Title(name, *_unit_among(unit, wanted)))
        except ValueError as reason:
            where = f"{table.place(row)}, column {number + 1}"
            problems.append(Problem(where, f"{shown(field.text)} {reason}", _FORM))
    times = sum(title.is_time for title in found)
    if not problems and (times != 1 or len(found) < 2):
        fault = "must have one column of times, and others beside it"
        problems.append(Problem(table.place(row), fault, _FORM))
    if problems:
        raise InputRefused(first(problems))
    return found


def _unit_among(unit: str, wanted: Sequence[str]) -> tuple[str, float]:
    """Return that of the SI units which is of the same kind as a unit, and the unit's size in it.

    Raises
    ------
    ValueError
        There is none.
    """
    if not unit:
        raise ValueError("has no unit")
    for known in wanted:
        try:
            return known, in_si(f"1 {unit.replace(' ', '.')}", known)
        except ValueError:
            continue
    raise ValueError(f"has not the unit of what is drawn, which is in {' or '.join(wanted)}")


def _numbers(table: CsvTable, columns: int) -> Samples:
    """Return the numbers of all lines below the titles, shape (lines, columns)."""
    problems: list[Problem] = []
    rows = []
    for row in table.rows[1:]:
        if len(row.fields) != columns:
            fault = f"has {counted(len(row.fields), 'field')} instead of {columns}"
            problems.append(Problem(table.place(row), fault, "separate them as in the first line"))
            continue
        values = [table.number(field) for field in row.fields]
        for number, value in enumerate(values):
            if value is None:
                fault = f"{shown(row.fields[number].text)} is no finite number"
                problems.append(Problem(table.place(row, number), fault, "write a number"))
        rows.append([value or 0.0 for value in values])
    if not problems and len(rows) < 3:
        problems.append(
            Problem(str(table.path), f"has {counted(len(rows), 'point')}", "give at least three")
        )
    if problems:
        raise InputRefused(first(problems))
    return np.array(rows)


def _check_times(table: CsvTable, times: Samples) -> None:
    problems = [
        Problem(table.place(row), f"the time {after:g} is not after {before:g}", "sort the lines")
        for row, (before, after) in zip(table.rows[2:], pairwise(times.tolist()))
        if after <= before
    ]
    if problems:
        raise InputRefused(first(problems))


def agreements(
    runs: Mapping[str, Sequence[Series]], curves: Sequence[MeasuredCurve]
) -> list[Agreement]:
    """Compare computed variables with measured curves.

    Parameters
    ----------
    runs : mapping of str to sequence of Series
        Variables by the name of their run.
    curves : sequence of MeasuredCurve
        What was measured. One that has the name of a variable is compared with that alone, any
        other with all variables of its unit.

    Returns
    -------
    list of Agreement
        One for each pair that has a common time.
    """
    return [
        Agreement(run, variable.name, curve.name, list(_deviations(variable, curve)))
        for run, variables in runs.items()
        for curve in curves
        for variable in _compared(variables, curve)
        if variable.time.size > 1
        and min(variable.time[-1], curve.time[-1]) > max(variable.time[0], curve.time[0])
    ]


def _compared(variables: Sequence[Series], curve: MeasuredCurve) -> list[Series]:
    same = [variable for variable in variables if variable.name == curve.name]
    return same or [variable for variable in variables if variable.unit == curve.unit]


def _deviations(variable: Series, curve: MeasuredCurve) -> Iterator[Deviation]:
    """Yield peak, impulse and duration over the common time.

    The peak is the value farthest from zero, the impulse the integral over the time, the duration
    that from the first to the last value of more than a tenth of the peak.
    """
    begin = max(variable.time[0], curve.time[0])
    end = min(variable.time[-1], curve.time[-1])
    within = np.union1d(variable.time, curve.time)
    time = np.union1d(within[(within >= begin) & (within <= end)], [begin, end])
    both = [
        np.interp(time, variable.time, variable.values),
        np.interp(time, curve.time, curve.values),
    ]
    impulse = "s" if variable.unit == "1" else f"{variable.unit}.s"
    yield Deviation("peak", variable.unit, *map(_peak, both))
    yield Deviation("impulse", impulse, *(float(np.trapezoid(values, time)) for values in both))
    yield Deviation("duration", "s", *(_duration(time, values) for values in both))


def _peak(values: Samples) -> float:
    return float(values[np.abs(values).argmax()])


def _duration(time: Samples, values: Samples) -> float:
    lasting = time[np.abs(values) > LASTING * np.abs(values).max()]
    return float(lasting[-1] - lasting[0]) if lasting.size else 0.0


def table(found: Sequence[Agreement]) -> Table:
    """Return the agreements as a table.

    Parameters
    ----------
    found : sequence of Agreement
        Of :func:`agreements`.
    """
    rows: list[Sequence[str]] = [
        (
            entry.run,
            entry.variable,
            entry.measured,
            one.quantity,
            _with_unit(one.computed, one.unit),
            _with_unit(one.measured, one.unit),
            _error(one, "{}"),
        )
        for entry in found
        for one in entry.deviations
    ]
    columns = ("run", "variable", "measured", "quantity", "computed", "measured value", "error")
    right = ("computed", "measured value", "error")
    return Table(columns, list(rows), right, "Computed and measured")


def _with_unit(value: float, unit: str) -> str:
    """Return a value (SI) in the unit of the screen."""
    shown_in = _SCREEN.get(unit, unit)
    written = "" if shown_in == "1" else f" {shown_in.replace('.', ' ')}"
    return f"{digits(value / SCREEN_UNITS.get(shown_in, 1.0))}{written}"


def _error(entry: Deviation, form: str) -> str:
    return "" if entry.error is None else form.format(f"{100.0 * entry.error:+.0f} %")
