"""The values of a run at one time, to which it goes back together with its FMUs."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..loop.buses import Buses
from ..loop.exchange import ExchangeLoop


class MarkedValues:
    """Keeps what exchanges change besides the FMUs, and puts it back.

    Parameters
    ----------
    buses : Buses
        Of the run.
    loop : ExchangeLoop
        Whose counts go back too.
    """

    def __init__(self, buses: Buses, loop: ExchangeLoop) -> None:
        self._texts = buses.texts
        self._tables: list[NDArray[Any]] = [
            *(buses.inputs, buses.outputs, buses.channels, buses.watched),
            *(buses.extrapolated, buses.discrete, buses.jumps),
            *(loop.warned_table, loop.returned_table),
        ]
        self._copies = [np.empty_like(table) for table in self._tables]
        self._newest: dict[str, str] = {}
        self._changes: dict[str, int] = {}

    def mark(self) -> None:
        """Keep the values of the present time, to go back to."""
        for table, copy in zip(self._tables, self._copies, strict=True):
            copy[...] = table
        self._newest = dict(self._texts.newest)
        self._changes = {name: len(all_) for name, all_ in self._texts.changes.items()}

    def roll_back(self) -> None:
        """Go back to the values that were kept."""
        for table, copy in zip(self._tables, self._copies, strict=True):
            table[...] = copy
        self._texts.newest = dict(self._newest)
        for name, number in self._changes.items():
            del self._texts.changes[name][number:]
