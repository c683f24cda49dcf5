"""Rows of numbers that the loop takes at output times, and that results are computed from later."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..fmu.types import TYPES
from ..system.plan import End, Plan, with_whole_arrays
from .blocks import make_blocks

_MOST_ROWS = 1000
"""Rows that may wait before they are worked on."""
_MOST_NUMBERS = 4_000_000
"""Numbers in the rows that may wait."""


class Snapshots:
    """Rows of numbers: exchanged outputs, what is recorded besides, works of all channels.

    Parameters
    ----------
    plan : Plan
        Says what is exchanged, recorded and coupled.

    Attributes
    ----------
    ends : sequence of End
        Ports whose values begin a row: first the exchanged outputs.
    exchanged : int
        Number of exchanged outputs.
    every : int
        Number of exchanges for one row.
    blocks : dict of str to list of Block
        Calls that get what is not exchanged.
    place : dict of str to int
        In a row, by the name of the port.
    taken, given_back : slice
        Places of the works of the channels.
    waiting : list of int
        Exchanges after which rows were taken that nobody has worked on yet: the first rows.
    rows : array of float, shape (rows, values)
        The values.
    """

    def __init__(self, plan: Plan) -> None:
        self.ends: Sequence[End] = [*plan.outputs, *_apart(plan)]
        self.exchanged = len(plan.outputs)
        self.every = plan.timing.output_every
        self.blocks = make_blocks(self.ends[self.exchanged :], self.exchanged)
        self.place = {end.name: i for i, end in enumerate(self.ends)}
        channels = sum(bond.force.size for bond in plan.channels)
        self.taken = slice(len(self.ends), len(self.ends) + channels)
        self.given_back = slice(self.taken.stop, self.taken.stop + channels)
        self.waiting: list[int] = []
        width = self.given_back.stop
        self.rows = np.zeros((max(1, min(_MOST_ROWS, _MOST_NUMBERS // max(1, width))), width))

    def due(self, first: int, last: int) -> range:
        """Return the exchanges after ``first`` up to ``last`` after which a row is taken."""
        return range(first - first % self.every + self.every, last + 1, self.every)

    @property
    def room(self) -> int:
        """Number of exchanges that may be carried out before there are no more rows."""
        return self.every * (len(self.rows) - len(self.waiting))

    def lost(self, row: NDArray[np.float64], component: str) -> int:
        """Return the place in a row of the first value of a component that is no finite number.

        Raises
        ------
        StopIteration
            All values of the component are finite.
        """
        return next(
            i
            for i, end in enumerate(self.ends)
            if end.component == component and not np.isfinite(row[i])
        )

    def unfit(self, row: NDArray[np.float64], component: str) -> int:
        """Return the place in a row of the first value that a component cannot show exactly.

        Raises
        ------
        StopIteration
            All values of the component are such as their types hold.
        """
        return next(
            i
            for i, end in enumerate(self.ends)
            if end.component == component
            and not TYPES[end.port.type].low <= row[i] <= TYPES[end.port.type].high
        )


def _apart(plan: Plan) -> list[End]:
    """Return what is recorded or needed for the accounts, and not exchanged, in order of calls."""
    exchanged = {end.name for end in plan.outputs}
    works = (bond.work for bond in plan.bonds if bond.work is not None)
    wanted = [*plan.recorded, *works, *plan.balances]
    apart = [end for end in wanted if end.name not in exchanged]
    turns = {name: turn for turn, name in enumerate(plan.order)}
    return sorted(
        with_whole_arrays(plan.descriptions, apart),
        key=lambda end: (
            turns[end.component],
            end.port.type,
            end.port.reference,
            end.port.array,
            end.port.element,
        ),
    )
