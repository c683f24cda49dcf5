"""Stimuli, references and parameters of an experiment: tables and sets of values."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import InputRefused
from ...ssp.documents import SSC, SSV, read_document
from ..subject.variables import Declared
from .manifest import Untrue, content_of


@dataclass(frozen=True)
class TableSeries:
    """Values of a variable in time: a row for each time, a column for each element."""

    times: NDArray[np.float64]
    values: list[tuple[Any, ...]]

    def at(self, time: float, interpolated: bool) -> tuple[Any, ...]:
        """Return the values at a time: held, or on a straight line between two rows.

        Before the first row and after the last one values are theirs, at a jump those after it.
        """
        after = int(np.searchsorted(self.times, time, side="right"))
        before = max(0, after - 1)
        left = self.values[before]
        if not interpolated or after in (0, len(self.times)) or self.times[before] == time:
            return left
        share = (time - self.times[before]) / (self.times[after] - self.times[before])
        right = self.values[after]
        return tuple(a + share * (b - a) for a, b in zip(left, right, strict=True))


def read_table(file: Path, variables: dict[str, Declared]) -> dict[str, TableSeries]:
    """Return the series of a CSV file whose first column is the time (s).

    A cell of an array has all elements, with spaces between.

    Raises
    ------
    Untrue
        It is no such table, or names what the FMU has not.
    """
    try:
        lines = list(csv.reader(content_of(file).decode("utf-8-sig").splitlines()))
    except (UnicodeDecodeError, csv.Error) as error:
        raise Untrue(f"{file.name} is no table: {error}") from error
    names = [name.strip() for name in lines[0]] if lines else []
    body = [line for line in lines[1:] if line]
    if len(names) < 2 or not body:
        raise Untrue(f"{file.name} has no columns beside the time, or no rows")
    if unknown := [name for name in names[1:] if name not in variables]:
        raise Untrue(f"{file.name} has the column {unknown[0]}, which is no variable of the FMU")
    for number, line in enumerate(body, 2):
        if len(line) != len(names):
            raise Untrue(f"{file.name}, line {number}: {len(line)} cells for {len(names)} columns")
    times = np.array([_number(line[0], file, n) for n, line in enumerate(body, 2)])
    if not np.isfinite(times).all() or (np.diff(times) < 0.0).any():
        raise Untrue(f"{file.name}: its times do not ascend")
    return {
        name: TableSeries(times, [_cell(line[c], variables[name], file) for line in body])
        for c, name in enumerate(names)
        if c > 0
    }


def _number(text: str, file: Path, line: int) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise Untrue(f"{file.name}, line {line}: {text!r} is no time") from error


def _cell(text: str, variable: Declared, file: Path) -> tuple[Any, ...]:
    """Return the values of a cell, one for each element."""
    words = [text] if variable.kind in ("String", "Binary") else text.split()
    try:
        values = tuple(value_of(word, variable) for word in words)
    except ValueError as error:
        raise Untrue(f"{file.name}: {text!r} is no value of {variable.name}") from error
    if len(values) != variable.size:
        raise Untrue(
            f"{file.name}: {variable.name} has {variable.size} elements, the table {len(values)}"
        )
    return values


def value_of(word: str, variable: Declared) -> Any:
    """Return the value that a word means.

    Raises
    ------
    ValueError
        It means none.
    """
    if variable.kind == "String":
        return word
    if variable.kind == "Binary":
        return bytes.fromhex(word)
    if variable.kind == "Boolean":
        return {"true": True, "false": False}.get(word) if word.isalpha() else bool(float(word))
    return float(word) if variable.is_real else int(word)


def read_parameters(
    file: Path, variables: dict[str, Declared], items: dict[str, dict[str, int]]
) -> dict[str, tuple[Any, ...]]:
    """Return the values of a parameter set (SSV) by the name of the variable.

    Parameters
    ----------
    file : Path
        The set.
    variables : dict of str to Declared
        Of the FMU, by name.
    items : dict of str to dict
        Numbers of the items of enumerations, by variable.

    Raises
    ------
    Untrue
        It is none, or sets what cannot be set, or is beyond the range of a variable.
    """
    try:
        root = read_document(content_of(file), file.name, f"{{{SSV}}}ParameterSet")
    except InputRefused as refused:
        raise Untrue("; ".join(str(problem) for problem in refused.problems)) from refused
    found = {}
    for element in root.iter(f"{{{SSV}}}Parameter"):
        name = element.get("name", "")
        if name not in variables:
            raise Untrue(f"{file.name} sets {name}, which is no variable of the FMU")
        value = next(child for child in element if child.tag != f"{{{SSC}}}Dimension")
        words = value.get("value", "")
        found[name] = _in_range(file, variables[name], words, items.get(name, {}))
    return found


def _in_range(file: Path, variable: Declared, words: str, items: dict[str, int]) -> tuple[Any, ...]:
    text = str(items.get(words, words))
    values = _cell(text, variable, file)
    least = -math.inf if variable.lowest is None else variable.lowest
    most = math.inf if variable.highest is None else variable.highest
    for value in values:
        if isinstance(value, int | float) and not least <= value <= most:
            raise Untrue(
                f"{file.name} sets {variable.name} = {value:g}, beyond its range of {least:g} to "
                f"{most:g}"
            )
    return values
