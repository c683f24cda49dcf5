"""Rocks that pass the search lines and barriers of a campaign."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.records import (
    BELOW,
    OUTCOME,
    PASSAGE,
    PASSED_LEFT,
    PASSED_RIGHT,
    RESTED,
    STOPPED,
    UNFINISHED,
)

from ..metrics.percentiles import SHARES, Percentile, borne, percentile, proportion, rank
from .campaign import Campaign, TrialRecords

ENDS = {
    RESTED: "at rest",
    PASSED_RIGHT: "beyond the right end",
    PASSED_LEFT: "beyond the left end",
    UNFINISHED: "unfinished",
    BELOW: "started below the surface",
    STOPPED: "stopped by a barrier",
}
"""Ends of a trial in words, by the kernel's number."""


@dataclass(frozen=True)
class PassageQuantity:
    """A quantity that is reported of the passages of a line.

    Attributes
    ----------
    column : int
        In the records of the passages.
    name, unit : str
        Name, and unit in SI.
    shown : str
        Unit in tables and pictures.
    scale : float
        Size of that unit in SI.
    """

    column: int
    name: str
    unit: str
    shown: str
    scale: float

    @property
    def words(self) -> str:
        """Name as a reader sees it."""
        return self.name.replace("_", " ")


QUANTITIES = (
    PassageQuantity(PASSAGE.kinetic, "energy", "J", "kJ", 1e3),
    PassageQuantity(PASSAGE.height, "height", "m", "m", 1.0),
    PassageQuantity(PASSAGE.speed, "speed", "m/s", "m/s", 1.0),
    PassageQuantity(PASSAGE.omega, "angular_speed", "rad/s", "rad/s", 1.0),
)
"""Quantities in the order of the reports.

The height is that of the rock above the cell below it, along its normal; the angular speed has no
sign.
"""


@dataclass(frozen=True)
class LinePassages:
    """Rocks that pass a search line or barrier, each at its first passage.

    Attributes
    ----------
    name : str
        Of the line.
    trials, count : int
        Number of all trials, and of those whose rock passes.
    values : mapping of str to array of float, shape (count,)
        By name of the quantity (SI), in ascending order.
    barrier : mapping of str to int or None
        Numbers of rocks that are ``stopped``, ``overtopped`` and ``broken_through``; None for a
        search line.
    numbers : mapping of str to array of int, shape (count,)
        Trials to which ``values`` belong, by name of the quantity.
    """

    name: str
    trials: int
    count: int
    values: Mapping[str, NDArray[np.float64]]
    barrier: Mapping[str, int] | None = None
    numbers: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)

    @property
    def share(self) -> float:
        """Part of the rocks that pass."""
        return self.count / self.trials

    @property
    def interval(self) -> tuple[float, float]:
        """Confidence interval of the probability that a rock passes."""
        return proportion(self.count, self.trials)

    def percentiles(self, quantity: str) -> list[Percentile]:
        """Return those percentiles of a quantity that the number of rocks that pass bears."""
        values = self.values[quantity]
        return [percentile(values, share) for share in borne(SHARES, self.count)]

    def trial_of(self, quantity: str, share: float) -> int:
        """Return the number of the trial that has a percentile of a quantity."""
        return int(self.numbers[quantity][rank(self.count, share)])


def line_passages(campaign: Campaign, records: TrialRecords) -> list[LinePassages]:
    """Return the passages of every search line and barrier.

    Parameters
    ----------
    campaign : Campaign
        With the lines.
    records : TrialRecords
        Of all its trials.

    Returns
    -------
    list of LinePassages
        In the order of the site.
    """
    return [_of_line(campaign, records, i) for i in range(len(campaign.lines))]


def _of_line(campaign: Campaign, records: TrialRecords, i: int) -> LinePassages:
    passed = records.passages[:, i, PASSAGE.count] > 0.0
    rows = records.passages[passed, i]
    is_barrier = campaign.barriers[i, 0] >= 0.0
    trials = np.flatnonzero(passed)
    return LinePassages(
        name=campaign.names[i],
        trials=campaign.trials,
        count=int(passed.sum()),
        values={q.name: np.sort(np.abs(rows[:, q.column])) for q in QUANTITIES},
        numbers={q.name: trials[_order(rows[:, q.column])] for q in QUANTITIES},
        barrier=_at_barrier(campaign, records, i, passed) if is_barrier else None,
    )


def _order(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the order of values by size; of equal ones the earlier trial comes first."""
    return np.argsort(np.abs(values), kind="stable")


def _at_barrier(
    campaign: Campaign, records: TrialRecords, i: int, passed: NDArray[np.bool_]
) -> dict[str, int]:
    """Count the rocks that are stopped, and of the others those above and below the reach."""
    stopped = records.outcomes[:, OUTCOME.barrier] == i
    away = np.hypot(
        records.passages[:, i, PASSAGE.x] - campaign.lines[i, 0],
        records.passages[:, i, PASSAGE.y] - campaign.lines[i, 1],
    )
    above = passed & ~stopped & (away > campaign.barriers[i, 0])
    broken = passed & ~stopped & ~above
    return {
        "stopped": int(stopped.sum()),
        "overtopped": int(above.sum()),
        "broken_through": int(broken.sum()),
    }
