"""Penetration tests on rods of several lengths: transferred energy, and N for 60 % of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ...sites.pile.preparation import PreparedPile
from ..frame import Count
from .blows import FOOT, Blow, strike

REFERENCE = 0.6
"""Part of the rated energy to which N is corrected."""
CUSTOMARY = ((4.0, 0.75), (6.0, 0.85), (10.0, 0.95), (math.inf, 1.0))
"""Rod lengths (m) up to which the factor behind them is customary (Skempton 1986)."""
CUSTOMARY_SOURCE = (
    "Skempton 1986, as tabled in ISRN 2012, 346439, table 1: 0.75 up to 4 m, 0.85 up to 6 m, 0.95 "
    "up to 10 m"
)
"""Source of :data:`CUSTOMARY`."""


def customary(length: float) -> float:
    """Return the customary factor C_R of a rod of a length (m)."""
    return next(factor for end, factor in CUSTOMARY if length <= end)


@dataclass(frozen=True)
class RodBlow:
    """A blow on a rod of one length.

    Attributes
    ----------
    pile : PreparedPile
        With that rod.
    blow : Blow
        Without traces.
    """

    pile: PreparedPile
    blow: Blow

    @property
    def length(self) -> float:
        """Length of the rod (m)."""
        return self.pile.site.length

    @property
    def energy_ratio(self) -> float:
        """Largest work on the head (the integral of F v) over the rated energy."""
        return self.blow.transferred / self.pile.rated_energy

    @property
    def first_wave_ratio(self) -> float:
        """Energy that a rigid ram gives before the wave is back from the toe, over the rated one.

        eta (1 - exp(-4 m/M)), m and M the masses of rod and ram: the force on an endless rod is
        Z V exp(-Z t/M), and the wave is back after 2 L/c = 2 m/Z.
        """
        site = self.pile.site
        fraction = -math.expm1(-4.0 * site.mass / site.hammer.mass)
        return site.hammer.efficiency * fraction

    @property
    def count(self) -> float | None:
        """N, blows for 0.3 m; None where nothing stays."""
        return FOOT / self.blow.set if self.blow.set > 0.0 else None

    @property
    def corrected(self) -> float | None:
        """N for 60 % of the rated energy, N ER / 0.6."""
        return None if self.count is None else self.count * self.energy_ratio / REFERENCE

    @property
    def customary(self) -> float:
        """Customary factor of this length."""
        return customary(self.length)


def rod_blows(pile: PreparedPile, count: Count = lambda done, total: None) -> list[RodBlow]:
    """Compute a blow on a rod of each length of a site.

    Parameters
    ----------
    pile : PreparedPile
        With one section, whose length is replaced; soil at the toe.
    count : Count
        Called with the numbers of rods done and of all.

    Returns
    -------
    list of RodBlow
        By rising length; empty if the site has none. Segments are as long as those of the site.
    """
    wanted = pile.site.spt
    lengths = sorted(set(wanted.lengths)) if wanted else []
    made = []
    for number, length in enumerate(lengths, 1):
        there = _with_length(pile, length)
        blow = strike(there, there.rod(), 0, there.resistance)
        made.append(RodBlow(there, replace(blow, traces={})))
        count(number, len(lengths))
    return made


def _with_length(pile: PreparedPile, length: float) -> PreparedPile:
    """Return a pile of one section with another length (m)."""
    site = pile.site
    segments = max(_FEWEST, round(site.segments * length / site.length))
    rod = [site.rod[0].model_copy(update={"length": length})]
    return replace(pile, site=site.model_copy(update={"rod": rod, "segments": segments}))


_FEWEST = 20


def answer(rods: Sequence[RodBlow]) -> str:
    """Return what the rods say about the customary factors.

    Parameters
    ----------
    rods : sequence of RodBlow
        By rising length, two at least.

    Returns
    -------
    str
        A sentence.
    """
    short, long = rods[0], rods[-1]
    own = short.energy_ratio / long.energy_ratio
    return (
        f"a rod of {short.length:g} m takes {own:.2f} of the energy that one of {long.length:g} m "
        f"takes (all blows of the ram counted), the first wave alone "
        f"{short.first_wave_ratio / long.first_wave_ratio:.2f}; the customary factor is "
        f"{short.customary / long.customary:.2f}"
    )
