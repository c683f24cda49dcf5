"""Timing on a machine that others use too: all contestants in turn, round after round, compared within each round."""

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

Contestant = Callable[[], float]
"""Does its work once and returns the seconds that it took."""


@dataclass(frozen=True)
class Times:
    """Seconds of each contestant in each round; rounds have the same place in all lists."""

    seconds: Mapping[str, Sequence[float]]

    def median(self, name: str) -> float:
        """Median of a contestant's times (s)."""
        return statistics.median(self.seconds[name])

    def ratio(self, name: str, reference: str) -> float:
        """Median over the rounds of one contestant's time as a multiple of another's in the same round."""
        return statistics.median(a / b for a, b in zip(self.seconds[name], self.seconds[reference]))


def interleave(contestants: Mapping[str, Contestant], rounds: int) -> Times:
    """Let each contestant work once in every round, after one round that does not count."""
    seconds: dict[str, list[float]] = {name: [] for name in contestants}
    for number in range(rounds + 1):
        for name, work in contestants.items():
            took = work()
            if number:
                seconds[name].append(took)
    return Times(seconds)
