"""Values at the end of a window that somebody needs before they are there."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fmu.slave import REAL
from ..loop.tables import FloatTable
from ..system.plan import Plan
from .window import Window


class Unknowns:
    """Values that components take before the components behind them have shown them.

    Parameters
    ----------
    plan : Plan
        Of the run.
    window : Window
        That is iterated.

    Attributes
    ----------
    is_guessed : array of bool, shape (outputs,)
        Outputs that are taken so.
    rows, columns : array of int
        Where the real ones among them stand in the values of a window.
    """

    def __init__(self, plan: Plan, window: Window) -> None:
        turns = {name: turn for turn, name in enumerate(plan.order)}
        self.is_guessed = np.zeros(len(plan.outputs), np.bool_)
        for name, sources in window.taken:
            for source in sources:
                if turns[name] <= turns[plan.outputs[source].component]:
                    self.is_guessed[source] = True
        is_real = np.array([end.port.kind == REAL for end in plan.outputs], np.bool_)
        self.rows, self.columns = np.nonzero(window.nodes & self.is_guessed & is_real)

    def of_values(self, values: NDArray[np.float64]) -> FloatTable:
        """Return the unknowns among the values of a window."""
        return np.asarray(values[self.rows, self.columns])

    def enter(self, values: NDArray[np.float64], guess: FloatTable) -> None:
        """Write the unknowns among the values of a window."""
        values[self.rows, self.columns] = guess


class FirstGuess:
    """First guess of a window: each value stays, or goes on as in the window before.

    What has been nearer there counts, for each value.

    Parameters
    ----------
    size : int
        Number of outputs.
    """

    def __init__(self, size: int) -> None:
        self._change = np.zeros(size)
        self._goes_on = np.zeros(size)

    def predict(self, window: Window) -> None:
        """Fill the values of a window from those at its beginning."""
        change = self._goes_on * self._change
        for row in range(1, window.period + 1):
            window.values[row] = window.values[0] + change * (row / window.period)

    def learn(self, window: Window) -> None:
        """Look how a window has gone."""
        change = window.values[-1] - window.values[0]
        self._goes_on[:] = np.abs(change - self._change) < np.abs(change)
        self._change[:] = change

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return what is known of the window before, arrays by name."""
        return {"change": self._change, "goes_on": self._goes_on}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what :meth:`memory` gave."""
        self._change = memory["change"].copy()
        self._goes_on = memory["goes_on"].copy()
