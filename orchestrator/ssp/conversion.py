"""Linear ways of a number: between units, and as a connection or a mapping changes it."""

from dataclasses import dataclass

from ..core.fmu.description import UNIT_TOLERANCE, UnitDefinition
from ..core.system.units import unit_text


@dataclass(frozen=True)
class Way:
    """A number becomes ``factor`` times itself plus ``offset``."""

    factor: float = 1.0
    offset: float = 0.0

    def then(self, other: "Way") -> "Way":
        """Return this way and another one behind it."""
        if other == UNCHANGED:
            return self
        return Way(other.factor * self.factor, other.factor * self.offset + other.offset)

    def of(self, value: float) -> float:
        """Return what becomes of a number."""
        return value if self == UNCHANGED else self.factor * value + self.offset


UNCHANGED = Way()


def between(one: UnitDefinition | None, other: UnitDefinition | None) -> Way:
    """Return the way of a number from one unit to another.

    Parameters
    ----------
    one, other : UnitDefinition or None
        A number without a unit, or in a unit that nobody defines, stays as it is.

    Returns
    -------
    Way
        Where both mean the same, the number stays exactly as it is.

    Raises
    ------
    ValueError
        They are units of different quantities.
    """
    if one is None or other is None or one.base is None or other.base is None:
        return UNCHANGED
    if one.base != other.base:
        raise ValueError(f"{unit_text(one)} cannot be converted into {unit_text(other)}")
    is_same_factor = abs(one.factor - other.factor) <= UNIT_TOLERANCE * abs(one.factor)
    if is_same_factor and one.offset == other.offset:
        return UNCHANGED
    return Way(one.factor / other.factor, (one.offset - other.offset) / other.factor)
