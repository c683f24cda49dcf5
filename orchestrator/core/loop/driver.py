"""A way of carrying out the exchanges of a run; what differs between ways is a method here."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..results.metric import Metric
from ..results.run_folder import Column
from .exchange import ExchangeLoop, Fault


class Driver:
    """Carries out each exchange once, as its schedule orders: the compiled loop itself.

    The ways in :mod:`rockshed.core.masters` are kinds of it.

    Parameters
    ----------
    loop : ExchangeLoop
        Between the slaves of the run.

    Attributes
    ----------
    loop : ExchangeLoop
        Gives counts of warnings and of early returns, and the time that a step has reached.
    halted_after : int or None
        Number of exchanges that the newest :meth:`advance` has carried out, where a condition of
        the scenario ended it; else None.
    """

    halted_after: int | None = None

    def __init__(self, loop: ExchangeLoop) -> None:
        self.loop = loop

    @property
    def halts(self) -> bool:
        """Whether it ends its exchanges where a condition of the scenario comes true."""
        return type(self) is Driver

    def begin(self) -> None:
        """Act before the first exchange of this process, when all values are there."""

    def portion(self, first: int, count: int, at_once: int) -> int:
        """Return how many exchanges are carried out before the master looks around.

        Parameters
        ----------
        first, count : int
            Number of the first exchange, and of all until something is due.
        at_once : int
            As many as take a moment; it depends on the clock of this computer.
        """
        return min(count, at_once)

    def made(self, exchanges: int) -> int:
        """Return the number of exchanges in so many exchange steps."""
        return exchanges

    def advance(self, first: int, count: int) -> Fault | None:
        """Carry out exchanges until the first operation that fails.

        Snapshots that are due are taken, behind those that wait.

        Parameters
        ----------
        first, count : int
            Number of the first exchange, counted from 0; how many, at least one.

        Returns
        -------
        Fault or None
            The operation that failed.
        """
        fault = self.loop.advance(first, count)
        has_halted = fault is None and self.loop.done < count
        self.halted_after = self.loop.done if has_halted else None
        return fault

    def record(self, exchange: int) -> Fault | None:
        """Take a snapshot of the values after so many exchanges, behind those that wait."""
        return self.loop.record(exchange)

    # ------------------------------------------------------------------ what it has to tell

    @property
    def columns(self) -> list[Column]:
        """Columns of the results that :meth:`values` fills, in order."""
        return []

    def values(self, exchanges: Sequence[int]) -> NDArray[np.float64]:
        """Return a row for each of these numbers of exchanges; they come once, in order."""
        return np.empty((len(exchanges), 0))

    @property
    def warnings(self) -> list[str]:
        """Sentences for the user at the end."""
        return []

    def metrics(self) -> list[Metric]:
        """Return entries of the summary."""
        return []

    def facts(self) -> dict[str, Any]:
        """Return entries of the provenance at the end."""
        return {}

    # ------------------------------------------------------------------ checkpoints

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return what has to be known to go on, arrays by name; of the same shape at any time."""
        return {}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what an earlier process knew, as :meth:`memory` gives it."""
