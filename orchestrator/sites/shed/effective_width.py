"""Rules for the width of a roof that takes part in an impact, by name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass


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
        Returns the width (m).
    """

    summary: str
    source: str
    width: Callable[[Spread], float]


RULES: Mapping[str, WidthRule] = {
    "girder spacing": WidthRule(
        "one girder takes the strip of the roof between the middles of its bays",
        "Sonoda et al. 1993, sec. 4 (3): the distance of the girders",
        lambda spread: spread.spacing,
    ),
    "rock and cushion": WidthRule(
        "rock diameter, and half of the thickness on either side: 1 : 2 through the cushion",
        "load spread of practice, not verified",
        lambda spread: 2.0 * spread.rock_radius + spread.thickness,
    ),
}
"""Rules by name."""
ON_GIRDERS = "girder spacing"
"""Rule where none is named and there are girders."""
ON_A_SLAB = "rock and cushion"
"""Rule where none is named and there is a slab."""
