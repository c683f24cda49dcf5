"""Drivability: blows, stresses and time over the penetration of a pile."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ...sites.pile.preparation import PreparedPile
from ..frame import Count
from .blows import Blow, drive


@dataclass(frozen=True)
class Stage:
    """A pile at one penetration.

    Attributes
    ----------
    pile : PreparedPile
        With the soil at that depth.
    blow : Blow or None
        The last of its blows, without traces; None where the pile sinks under its own weight and
        the hammer's.
    driven : float or None
        Blows from the first penetration down to this one; None where they would have no end.
    """

    pile: PreparedPile
    blow: Blow | None
    driven: float | None = 0.0

    @property
    def penetration(self) -> float:
        """Depth of the toe below the ground surface (m)."""
        assert self.pile.site.ground is not None
        return self.pile.site.ground.penetration

    @property
    def density(self) -> float | None:
        """Blows in a metre; 0 where the pile sinks by itself, None where nothing stays."""
        if self.blow is None:
            return 0.0
        return 1.0 / self.blow.set if self.blow.set > 0.0 else None

    @property
    def count(self) -> float | None:
        """Blows for the way ``drivability.per``; None where it is not driven on."""
        wanted = self.pile.site.drivability
        density = self.density
        assert wanted is not None
        if density is None or density * wanted.per >= wanted.refusal:
            return None
        return density * wanted.per

    @property
    def time(self) -> float | None:
        """Time (s) of the blows from the first penetration on, at the rate of the hammer."""
        rate = self.pile.site.hammer.rate
        return None if rate is None or self.driven is None else self.driven / rate


def drivability(pile: PreparedPile, count: Count = lambda done, total: None) -> list[Stage]:
    """Compute the blows at each penetration of a site.

    Between two penetrations the blows in a metre go evenly from one value to the other.

    Parameters
    ----------
    pile : PreparedPile
        In ground in layers.
    count : Count
        Called with the numbers of penetrations done and of all.

    Returns
    -------
    list of Stage
        By rising penetration; empty if the site has none.
    """
    wanted = pile.site.drivability
    depths = sorted(set(wanted.penetrations)) if wanted else []
    stages = []
    for number, depth in enumerate(depths, 1):
        there = pile.at(depth)
        sinks = there.resistance <= there.weight
        blow = None if sinks else replace(drive(there)[-1], traces={})
        stages.append(Stage(there, blow))
        count(number, len(depths))
    return list(_counted(stages))


def _counted(stages: Sequence[Stage]) -> Iterator[Stage]:
    """Yield stages with the blows from the first one on."""
    total: float | None = 0.0
    yield from stages[:1]
    for above, below in pairwise(stages):
        if total is not None and above.count is not None and below.count is not None:
            mean = 0.5 * ((above.density or 0.0) + (below.density or 0.0))
            total += mean * (below.penetration - above.penetration)
        else:
            total = None
        yield replace(below, driven=total)
