"""What is kept of a run at output times, as the drivers find it: rows of numbers from which the results are computed later."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..system.plan import End, Plan
from .blocks import make_blocks

_MOST_ROWS, _MOST_NUMBERS = 1000, 4_000_000
"""Rows, and numbers in them, that may wait before they are worked on."""


class Snapshots:
    """Rows of numbers: all exchanged outputs, then what is recorded or needed beside them, then the works of all channels.

    rows: one for each ``every`` exchanges. waiting: the exchanges after which those were taken that nobody has worked on yet; they
    stand in the first rows. blocks: calls that get what is not exchanged.
    place: in a row, by the name of the port. taken, given_back: where the works of the channels lie.
    """

    def __init__(self, plan: Plan) -> None:
        exchanged = {end.name for end in plan.outputs}
        wanted = [*plan.recorded, *(bond.work for bond in plan.bonds if bond.work is not None)]
        apart = {end.name: end for end in wanted if end.name not in exchanged}
        self.ends: Sequence[End] = [
            *plan.outputs,
            *sorted(
                apart.values(),
                key=lambda end: (
                    plan.order.index(end.component),
                    end.port.kind,
                    end.port.reference,
                ),
            ),
        ]
        self.exchanged, self.every = len(plan.outputs), plan.timing.output_every
        self.blocks = make_blocks(self.ends[self.exchanged :], self.exchanged)
        self.place = {end.name: i for i, end in enumerate(self.ends)}
        channels = sum(bond.force.size for bond in plan.bonds)
        self.taken = slice(len(self.ends), len(self.ends) + channels)
        self.given_back = slice(self.taken.stop, self.taken.stop + channels)
        self.waiting: list[int] = []
        self.rows = np.zeros(
            (
                max(1, min(_MOST_ROWS, _MOST_NUMBERS // max(1, self.given_back.stop))),
                self.given_back.stop,
            )
        )

    def due(self, first: int, last: int) -> range:
        """The exchanges after ``first`` up to ``last`` after which a row is taken."""
        return range(first - first % self.every + self.every, last + 1, self.every)

    @property
    def room(self) -> int:
        """Exchanges that may be carried out before there are no more rows."""
        return self.every * (len(self.rows) - len(self.waiting))

    def lost(self, row: NDArray[np.float64], component: str) -> int:
        """Place in a row of the first value of a component that is no finite number.

        Raises:
            StopIteration: there is none.
        """
        return next(
            i
            for i, end in enumerate(self.ends)
            if end.component == component and not np.isfinite(row[i])
        )
