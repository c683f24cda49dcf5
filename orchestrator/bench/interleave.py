"""Timing on a machine that others use too.

All contestants work in turn, round after round, and are compared within each round.
"""

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

Contestant = Callable[[], float]
"""Does its work once and returns the seconds that it took."""


@dataclass(frozen=True)
class Times:
    """Seconds of each contestant in each round.

    Rounds have the same place in all lists.
    """

    seconds: Mapping[str, Sequence[float]]

    def median(self, name: str) -> float:
        """Return the median of a contestant's times (s)."""
        return statistics.median(self.seconds[name])

    def ratio(self, name: str, reference: str) -> float:
        """Return the median over the rounds of one time as a multiple of another in its round."""
        return statistics.median(a / b for a, b in zip(self.seconds[name], self.seconds[reference]))

    def ratio_of_least(self, name: str, reference: str) -> float:
        """Return the least time of one as a multiple of the least one of another.

        For work of some milliseconds that nothing can make shorter: what else the processor does
        can only add to it.
        """
        return min(self.seconds[name]) / min(self.seconds[reference])


def interleave(contestants: Mapping[str, Contestant], rounds: int) -> Times:
    """Let each contestant work once in every round, after one round that does not count.

    Parameters
    ----------
    contestants : mapping of str to Contestant
        Who takes turns.
    rounds : int
        How many count.

    Returns
    -------
    Times
    """
    seconds: dict[str, list[float]] = {name: [] for name in contestants}
    for number in range(rounds + 1):
        for name, work in contestants.items():
            took = work()
            if number:
                seconds[name].append(took)
    return Times(seconds)
