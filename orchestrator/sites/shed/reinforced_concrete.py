"""Moment-curvature line of a reinforced concrete strip: cracking, yield of the steel, ultimate.

Plane sections stay plane. Concrete in compression follows the parabola-rectangle of the codes
(EN 1992-1-1, 3.1.7, with exponent 2), in tension it carries nothing once it has cracked; steel is
elastic-perfectly plastic. Between the three points the line is straight, which leaves out tension
stiffening. Sagging opens the lower face, hogging the upper one; the bars of either may be 0.

A cracked strip unloads towards the origin until its bars yield, as cracks close (origin-oriented
part), and each face cracks by itself; past that, bars slip with the slope of the cracked strip.
Between cracking and yield the slope in hogging is that in sagging.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from .yielding import Corners

PEAK_STRAIN = 0.002
"""Strain at which the parabola ends (EN 1992-1-1, table 3.1, up to C50)."""
ULTIMATE_STRAIN = 0.0035
"""Strain at which concrete crushes (EN 1992-1-1, table 3.1, up to C50)."""
BLOCK_FACTOR = 0.85
"""Strength in the section over that of a cylinder: under a lasting load, as codes take it."""


_OVER_REINFORCED = "the concrete crushes before the steel yields: give less steel or more height"
_TOO_WEAK = "the bars bear next to nothing beside the concrete: it breaks when it cracks"


class StripError(ValueError):
    """A strip has no line of cracking, yield and ultimate: it breaks without a warning."""


class BrittleError(StripError):
    """The bars bear less than what cracks the concrete."""


@dataclass(frozen=True)
class Concrete:
    """Concrete of a strip.

    Attributes
    ----------
    strength : float
        Cylinder strength in compression (Pa).
    tensile_strength : float
        In bending (Pa).
    elastic_modulus : float
        Of the uncracked strip (Pa).
    """

    strength: float
    tensile_strength: float
    elastic_modulus: float


@dataclass(frozen=True)
class Bars:
    """Reinforcing bars of one material.

    Attributes
    ----------
    yield_stress : float
        In Pa.
    elastic_modulus : float
        In Pa.
    """

    yield_stress: float
    elastic_modulus: float = 2.0e11

    @property
    def yield_strain(self) -> float:
        """Strain at which they yield."""
        return self.yield_stress / self.elastic_modulus

    def stress(self, strain: float) -> float:
        """Return the stress (Pa) at a strain."""
        return max(-self.yield_stress, min(self.yield_stress, self.elastic_modulus * strain))


@dataclass(frozen=True)
class Strip:
    """A strip of a slab.

    Attributes
    ----------
    width, height : float
        Of the section (m).
    steel_area : float
        Of the bars near the lower face (m2).
    depth : float
        From the upper face to the middle of these bars (m).
    upper_area : float
        Of bars near the upper face (m2).
    upper_depth : float
        From the upper face to the middle of these (m).
    """

    width: float
    height: float
    steel_area: float
    depth: float
    upper_area: float = 0.0
    upper_depth: float = 0.0

    @property
    def second_moment(self) -> float:
        """Second moment of area of the gross section (m4)."""
        return self.width * self.height**3 / 12.0

    def turned(self) -> "Strip":
        """Return the strip upside down."""
        return Strip(
            self.width,
            self.height,
            self.upper_area,
            self.height - self.upper_depth,
            self.steel_area,
            self.height - self.depth,
        )


def strip_corners(strip: Strip, concrete: Concrete, bars: Bars) -> Corners:
    """Return cracking, yield and ultimate of a strip as the corners of its line, on both faces.

    Without bars above, or with fewer than bear what cracks it, hogging is borne up to cracking
    only.

    Parameters
    ----------
    strip : Strip
        The section.
    concrete : Concrete
        Its concrete.
    bars : Bars
        Its steel.

    Returns
    -------
    Corners
        Three, without hardening past the ultimate one, where the concrete crushes: past it the
        line means nothing more.

    Raises
    ------
    StripError
        The concrete crushes before the steel yields, or the steel cannot bear what cracks the
        concrete.
    """
    below = _face_corners(strip, concrete, bars)
    above = Corners((below.moments[0],) * len(below.moments), (below.curvatures[0],))
    if strip.upper_area > 0.0:
        try:
            above = _face_corners(strip.turned(), concrete, bars)
        except BrittleError:
            pass  # as without them
        except StripError as error:
            raise StripError(f"in hogging, {error}") from error
    return replace(
        below,
        hogging_moments=above.moments,
        hogging_curvature=above.curvatures[-1],
        cracks=True,
    )


def _face_corners(strip: Strip, concrete: Concrete, bars: Bars) -> Corners:
    """Return cracking, yield and ultimate of a strip that bends open below."""
    elastic = concrete.elastic_modulus * strip.second_moment
    cracking = concrete.tensile_strength * strip.second_moment / (0.5 * strip.height)
    section = _Section(strip, concrete, bars)
    yielding = section.at_yield()
    ultimate = section.at_ultimate()
    if ultimate[1] <= yielding[1]:
        raise StripError(_OVER_REINFORCED)
    if yielding[0] <= cracking:
        raise BrittleError(
            f"the steel yields at {yielding[0] / 1e3:.4g} kN m and the concrete cracks at "
            f"{cracking / 1e3:.4g} kN m only: the strip breaks when it cracks; give more steel"
        )
    moments = (cracking, yielding[0], max(ultimate[0], yielding[0]))
    return Corners(moments, (cracking / elastic, yielding[1], ultimate[1]))


@dataclass(frozen=True)
class _Section:
    """A cracked section under bending without a normal force."""

    strip: Strip
    concrete: Concrete
    bars: Bars

    def at_yield(self) -> tuple[float, float]:
        """Return moment (N m) and curvature (1/m) when the lower bars begin to yield."""
        strip, strain = self.strip, self.bars.yield_strain
        deepest = (1.0 - 1e-9) * strip.depth
        axis = _root(
            lambda x: self._balance(x, strain * x / (strip.depth - x)),
            1e-9 * strip.depth,
            deepest,
        )
        curvature = strain / (strip.depth - axis)
        return self._moment(axis, curvature * axis), curvature

    def at_ultimate(self) -> tuple[float, float]:
        """Return moment (N m) and curvature (1/m) when the concrete crushes."""
        axis = _root(
            lambda x: self._balance(x, ULTIMATE_STRAIN), 1e-9 * self.strip.depth, self.strip.height
        )
        return self._moment(axis, ULTIMATE_STRAIN), ULTIMATE_STRAIN / axis

    def _block(self, axis: float, top: float) -> tuple[float, float]:
        """Return the force (N) of the concrete and its moment about the neutral axis (N m).

        ``axis`` is the depth of that axis (m), ``top`` the strain of the upper face.
        """
        ratio = top / PEAK_STRAIN
        if ratio <= 1.0:
            force, moment = ratio - ratio**2 / 3.0, 2.0 * ratio / 3.0 - ratio**2 / 4.0
        else:
            force, moment = 1.0 - 1.0 / (3.0 * ratio), 0.5 - 1.0 / (12.0 * ratio**2)
        scale = self.strip.width * BLOCK_FACTOR * self.concrete.strength * axis
        return force * scale, moment * scale * axis

    def _steel(self, axis: float, top: float) -> list[tuple[float, float]]:
        """Return force (N, tension) and depth (m) of the lower and the upper bars."""
        strip, curvature = self.strip, top / axis
        return [
            (area * self.bars.stress(curvature * (depth - axis)), depth)
            for area, depth in (
                (strip.steel_area, strip.depth),
                (strip.upper_area, strip.upper_depth),
            )
        ]

    def _balance(self, axis: float, top: float) -> float:
        """Return the force (N) by which compression exceeds tension."""
        return self._block(axis, top)[0] - sum(force for force, _ in self._steel(axis, top))

    def _moment(self, axis: float, top: float) -> float:
        """Return the moment (N m) of all forces about the neutral axis."""
        steel = sum(force * (depth - axis) for force, depth in self._steel(axis, top))
        return self._block(axis, top)[1] + steel


def _root(balance: Callable[[float], float], low: float, high: float) -> float:
    """Return where a balance is zero between two depths (m).

    Raises
    ------
    StripError
        All of the concrete cannot make the bars yield, or next to none of it would.
    """
    from scipy.optimize import brentq  # takes 0.2 s to import

    if not balance(high) > 0.0:
        raise StripError(_OVER_REINFORCED)
    if not balance(low) < 0.0:
        raise BrittleError(_TOO_WEAK)
    return float(brentq(balance, low, high, xtol=1e-12))
