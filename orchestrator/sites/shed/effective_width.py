"""Rules for the width of a roof that takes part in an impact, by name.

The model is plane: its sand and its girders are a strip of this width, which carries all of the
load. In three dimensions the load falls off to the sides; ``docs/formulas.md`` holds each rule
beside the spread of a load that was computed with spheres.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

SPHERES = 0.65
"""Widening by thickness on both sides together with which the rock's diameter is the width of the
even load that has, at the axis, the line load of the spheres: 1.50 m for 0.456 m and 0.9 m."""


@dataclass(frozen=True)
class Spread:
    """Quantities that the effective width may depend on.

    Attributes
    ----------
    rock_radius, thickness : float
        Of the rock and of the cushion (m).
    spacing : float
        Of the girders (m); 0 on a slab.
    """

    rock_radius: float
    thickness: float
    spacing: float


@dataclass(frozen=True)
class WidthRule:
    """A rule for the effective width.

    Attributes
    ----------
    summary, source : str
        The rule in words, and where it comes from.
    width : callable
        Returns the width (m); 0 where the rule has no meaning.
    """

    summary: str
    source: str
    width: Callable[[Spread], float]


def _widened(share: float) -> Callable[[Spread], float]:
    """Return the rule: diameter of the rock, wider by a share of the thickness."""
    return lambda spread: 2.0 * spread.rock_radius + share * spread.thickness


RULES: Mapping[str, WidthRule] = {
    "girder spacing": WidthRule(
        "one girder takes the strip of the roof between the middles of its bays",
        "Sonoda et al. 1993, sec. 4 (3): the distance of the girders",
        lambda spread: spread.spacing,
    ),
    "spheres": WidthRule(
        f"rock diameter + {SPHERES} thickness: the line load at the axis of a load in three "
        "dimensions",
        "fitted to one computed impact of 1 t from 10 m on 0.9 m; no measurement",
        _widened(SPHERES),
    ),
    "rock and cushion": WidthRule(
        "rock diameter, and half of the thickness on either side: 1 : 2 through the cushion",
        "load spread of practice, not verified; within those of the computed spheres",
        _widened(1.0),
    ),
    "45 degrees": WidthRule(
        "rock diameter, and the thickness on either side: 1 : 1 through the cushion",
        "load spread of practice, not verified",
        _widened(2.0),
    ),
}
"""Rules by name."""
ON_GIRDERS = "rock and cushion"
"""Rule where none is named and there are girders."""
ON_A_SLAB = "rock and cushion"
"""Rule where none is named and there is a slab."""


def band(spread: Spread) -> tuple[float, float]:
    """Return the smallest and the largest effective width of all rules that have a meaning (m).

    Parameters
    ----------
    spread : Spread
        What they depend on.
    """
    widths = [width for rule in RULES.values() if (width := rule.width(spread)) > 0.0]
    return min(widths, default=math.nan), max(widths, default=math.nan)
