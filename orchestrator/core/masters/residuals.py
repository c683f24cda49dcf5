"""How far values are from fitting together: connection by connection, iteration by iteration."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..loop.tables import FloatTable
from ..system.plan import Plan
from .guesses import Unknowns
from .window import Window

KEPT = 6
"""Windows that are kept in full: the last ones, and as many of those with the most iterations."""
_DIGITS = 4
"""Digits of a residual that is told."""


class Interfaces:
    """Outputs that feed inputs, put together where they are elements of an array.

    Parameters
    ----------
    plan : Plan
        Of the run.

    Attributes
    ----------
    places : array of int
        Of all outputs that feed inputs.
    group : array of int
        Number of the interface to which each belongs.
    names : list of (str, str)
        Source and targets of each interface.
    tolerances, absolutes : array of float
        Of each output, the smallest that one of its connections asks for.
    """

    def __init__(self, plan: Plan) -> None:
        assert plan.iteration is not None
        fed: dict[int, list[int]] = {}
        for place, _, _ in plan.fed:
            fed.setdefault(int(plan.source[place]), []).append(place)
        self.places = np.array(sorted(fed), np.int64)
        targets: dict[str, dict[str, None]] = {}
        for place in self.places:
            known = targets.setdefault(_array(plan.outputs[place].name), {})
            known |= dict.fromkeys(_array(plan.inputs[i].name) for i in fed[int(place)])
        numbers = {key: number for number, key in enumerate(targets)}
        self.names = [(key, ", ".join(listed)) for key, listed in targets.items()]
        keys = (_array(plan.outputs[place].name) for place in self.places)
        self.group = np.array([numbers[key] for key in keys], np.int64)
        given = [fed[int(place)] for place in self.places]
        self.tolerances = np.array([plan.iteration.tolerances[g].min() for g in given])
        self.absolutes = np.array([plan.iteration.absolutes[g].min() for g in given])

    def largest(self, amounts: FloatTable) -> FloatTable:
        """Return the largest of some amounts, one for each output, of each interface."""
        found = np.zeros(len(self.names))
        np.maximum.at(found, self.group, amounts)
        return found


def _array(name: str) -> str:
    """Return the name of a variable without the number of an element."""
    return name.partition("[")[0]


class Residuals:
    """Differences between values that were given and those that came back.

    Parameters
    ----------
    plan : Plan
        Of the run.
    window : Window
        That is iterated.
    unknowns : Unknowns
        Values that are guessed.

    Attributes
    ----------
    interfaces : Interfaces
        Of the run.
    """

    def __init__(self, plan: Plan, window: Window, unknowns: Unknowns) -> None:
        self.interfaces = Interfaces(plan)
        self._window = window
        self._is_guessed = unknowns.is_guessed[self.interfaces.places]
        self._unknowns = unknowns
        self._amounts = np.zeros(len(self.interfaces.names))
        self._guess: FloatTable | None = None

    def begin(self) -> None:
        """Forget the guess before: another window begins."""
        self._guess = None

    def find(self, given: NDArray[np.float64]) -> FloatTable:
        """Return the largest difference of each interface, as multiple of its tolerance.

        Of a value that was guessed it is the residual itself. One that was taken from a component
        before in the same iteration fits; of it, it is the change that is still to be expected, if
        that falls as the residual does.

        Parameters
        ----------
        given : array of float, shape (period + 1, outputs)
            Values of the window before this iteration.
        """
        interfaces = self.interfaces
        differences = np.abs(self._window.values - given)
        differences[~self._window.nodes] = 0.0
        largest = differences.max(axis=0)[interfaces.places]
        largest[~self._is_guessed] *= self._still(given)
        tolerated = interfaces.tolerances * self._present()[interfaces.group]
        tolerated += interfaces.absolutes
        shares = np.zeros(largest.size)
        np.divide(largest, tolerated, out=shares, where=largest > 0.0)
        return interfaces.largest(shares)

    def _still(self, given: NDArray[np.float64]) -> float:
        """Return the residual as part of the change of the guess that has led to it."""
        guess = self._unknowns.of_values(given)
        residual = np.abs(self._unknowns.of_values(self._window.values) - guess)
        before = self._guess
        self._guess = guess
        if not residual.any():
            return 0.0
        scale = self.scale()
        change = 0.0 if before is None else float(np.max(np.abs(guess - before) / scale))
        part = float(np.max(residual / scale))
        return 1.0 if change <= part else part / change

    def _present(self) -> FloatTable:
        """Return the largest amount of each interface until now."""
        values = np.abs(self._window.values).max(axis=0)
        return np.maximum(self._amounts, self.interfaces.largest(values[self.interfaces.places]))

    def scale(self) -> FloatTable:
        """Return the amount of each value that is guessed, above 0."""
        amounts = np.ones(self._window.values.shape[1])
        amounts[self.interfaces.places] = self._present()[self.interfaces.group]
        amounts[amounts <= 0.0] = 1.0
        return np.asarray(amounts[self._unknowns.columns])

    def learn(self) -> None:
        """Take over the amounts of a window whose values fit together."""
        self._amounts = self._present()

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return what is known from earlier windows, arrays by name."""
        return {"amounts": self._amounts}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what :meth:`memory` gave."""
        self._amounts = memory["amounts"].copy()


class History:
    """Iterations and residuals of a run.

    Parameters
    ----------
    interfaces : int
        How many there are.
    most : int
        Iterations of a window, at most.

    Attributes
    ----------
    counts : array of int64
        Number of windows that took 0, 1, 2, ... iterations.
    of_window : list of array of float
        Residual of each interface after each iteration of the present window, as multiple of its
        tolerance.
    """

    def __init__(self, interfaces: int, most: int) -> None:
        self.counts = np.zeros(most + 1, np.int64)
        self.of_window: list[FloatTable] = []
        self._windows = np.full((2 * KEPT, 2), -1, np.int64)  # exchange, iterations
        self._residuals = np.full((2 * KEPT, most, interfaces), np.nan)

    def end(self, exchange: int) -> int:
        """Count the window, which began after so many exchanges; return its iterations."""
        number = len(self.of_window)
        self.counts[number] += 1
        worst = KEPT + int(np.argmin(self._windows[KEPT:, 1]))
        self._keep(int(np.argmin(self._windows[:KEPT, 0])), exchange)
        if number > self._windows[worst, 1]:
            self._keep(worst, exchange)
        return number

    def _keep(self, row: int, exchange: int) -> None:
        number = len(self.of_window)
        self._windows[row] = exchange, number
        self._residuals[row] = np.nan
        self._residuals[row, :number] = self.of_window

    def told(self, seconds: Callable[[int], float]) -> list[dict[str, Any]]:
        """Return the windows that are kept, by rising time.

        Parameters
        ----------
        seconds : callable
            Returns the time (s) after so many exchanges.
        """
        rows = {int(self._windows[row, 0]): row for row in range(2 * KEPT)}
        return [
            {
                "time": seconds(exchange),
                "iterations": int(self._windows[row, 1]),
                "residuals": [
                    [float(f"{residual:.{_DIGITS}g}") for residual in residuals]
                    for residuals in self._residuals[row, : self._windows[row, 1]]
                ],
            }
            for exchange, row in sorted(rows.items())
            if exchange >= 0
        ]

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return everything as arrays by name."""
        return {
            "counts": self.counts,
            "windows": self._windows,
            "histories": self._residuals.ravel(),
        }

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what :meth:`memory` gave."""
        self.counts = memory["counts"].copy()
        self._windows = memory["windows"].copy()
        self._residuals = memory["histories"].reshape(self._residuals.shape).copy()
