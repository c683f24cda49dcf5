"""Values over time: the one mechanism behind every table of inputs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputRefused, Problem

TIME = "time"
"""Title of the column of times."""


@dataclass(frozen=True)
class Signals:
    """Values over time.

    Attributes
    ----------
    time : ndarray of float64, shape (n,)
        Times (s), ascending. The same time twice is a jump: the later row holds from then on.
    columns : mapping of str to ndarray of float64, shape (n,)
        Values by the name of the input, in its unit; of booleans 0 and 1.
    """

    time: NDArray[np.float64]
    columns: Mapping[str, NDArray[np.float64]]

    def at(self, time: float, name: str, held: bool) -> float:
        """Return a value at a time.

        Parameters
        ----------
        time : float
            Time (s). Before the first row and after the last one the values are theirs.
        name : str
            Of the input.
        held : bool
            Whether the value of a row holds until the next one; otherwise values are interpolated
            linearly between two rows.

        Returns
        -------
        float
            The value.
        """
        return float(self.over(np.array([time]), name, held)[0])

    def over(self, times: NDArray[np.float64], name: str, held: bool) -> NDArray[np.float64]:
        """Return a value at many times, see :meth:`at`.

        Parameters
        ----------
        times : ndarray of float64, shape (n,)
            Times (s).
        name, held
            As :meth:`at` has them.

        Returns
        -------
        ndarray of float64, shape (n,)
        """
        values = self.columns[name]
        now = times + 8.0 * np.spacing(np.abs(times))  # a computed time may lie before a row
        row = np.searchsorted(self.time, now, side="right") - 1
        found = values[np.maximum(row, 0)]
        between = (row >= 0) & (row < len(self.time) - 1)
        if held or not between.any():
            return found
        first = row[between]
        begin, end = self.time[first], self.time[first + 1]
        left = np.clip((end - times[between]) / (end - begin), 0.0, 1.0)
        found[between] = left * values[first] + (1.0 - left) * values[first + 1]
        return found


def signals_of(table: Mapping[str, Sequence[float]], where: str) -> Signals:
    """Make values over time of columns.

    Parameters
    ----------
    table : mapping of str to sequence of float
        ``time`` (s), and a column of the same length for each input.
    where : str
        Stands before the name of a column in a problem.

    Returns
    -------
    Signals
        At least one row.

    Raises
    ------
    InputRefused
        Everything that is wrong with the columns.
    """
    columns = {name: np.asarray(values, dtype=np.float64) for name, values in table.items()}
    time = columns.pop(TIME, None)
    if time is None or not time.size:
        raise InputRefused([Problem(where, "has no times", "give a column named time (s)")])
    problems = [
        Problem(
            f"{where} {name}", f"has {values.size} values for {time.size} times", "give one each"
        )
        for name, values in columns.items()
        if values.shape != time.shape
    ]
    if not np.isfinite([time, *columns.values()] if not problems else [0.0]).all():
        problems.append(Problem(where, "has values that are no finite numbers", "correct them"))
    if np.any(np.diff(time) < 0.0):
        problems.append(Problem(f"{where} time", "goes backwards", "sort the values by time"))
    if problems:
        raise InputRefused(problems)
    return Signals(time, columns)
