"""Piles of a pile file, or springs, under the supports of a shed: rods with their soil.

A pile stands under each end of each girder; those of the girders that take part act together. An
elastic support is a short stiff rod on a spring that yields nowhere and only pushes.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.units import standard_gravity

from ...input_files.places import Places
from ..pile.preparation import PreparedPile, wave_speed
from ..pile.site import PileSite
from ..source import SiteSource

STIFF_END = 5.0
"""Impedance of a rod / (stiffness of the roof's end times exchange step), at least.

The limit of the rod is 1, and near it an exchange makes energy.
"""
_SPRING_SEGMENTS = 4
"""Segments of the rod of an elastic support."""
_SPRING_SPEED, _SPRING_DENSITY = 5000.0, 7850.0
"""Wave speed (m/s) and density (kg/m3) of that rod."""
_FREE_OF_YIELDING = 1e4
"""Ultimate resistance of an elastic support / its load at rest."""
SPRING_EXCHANGE = 1e-5
"""Exchange step on elastic supports (s): their rods are light."""


@dataclass(frozen=True)
class FoundationPart:
    """The support under one end of a girder.

    Attributes
    ----------
    stiffness : float or None
        Of an elastic support, for all girders that take part (N/m).
    pile : PileSite or None
        The pile.
    """

    stiffness: float | None = None
    pile: PileSite | None = None


@dataclass(frozen=True)
class SupportRod:
    """A rod under one end of the roof, with the soil at its shaft and toe.

    Attributes
    ----------
    length, area, modulus, density : tuple of float
        Of its sections, from the head (m, m2, Pa, kg/m3).
    segments : int
        Pieces of one exchange step of travel time.
    shaft_resistance, shaft_quake, shaft_damping : tuple of float
        Of each segment (N, m, s/m).
    toe_resistance, toe_quake, toe_damping : float
        Of the toe (N, m, s/m).
    weight : float
        Of the rod (N), which the toe carries at rest.
    """

    length: tuple[float, ...]
    area: tuple[float, ...]
    modulus: tuple[float, ...]
    density: tuple[float, ...]
    segments: int
    shaft_resistance: tuple[float, ...]
    shaft_quake: tuple[float, ...]
    shaft_damping: tuple[float, ...]
    toe_resistance: float
    toe_quake: float
    toe_damping: float
    weight: float


def impedance(pile: PileSite) -> float:
    """Return the impedance EA/c at the head of a pile (N s/m).

    Parameters
    ----------
    pile : PileSite
        The pile.
    """
    head = pile.rod[0]
    return head.area * math.sqrt(head.modulus * head.density)


def pile_rod(pile: PileSite, piles: float, exchange: float) -> SupportRod:
    """Return piles that act together as one rod.

    The waves are given a speed with which the rod is a whole number of segments long: it changes
    by less than half a segment in its length.

    Parameters
    ----------
    pile : PileSite
        One of them.
    piles : float
        Their number, a fraction too.
    exchange : float
        Exchange step (s), the travel time of a segment.

    Returns
    -------
    SupportRod
    """
    travel = sum(section.length / wave_speed(section) for section in pile.rod)
    segments = max(2, round(travel / exchange))
    scale = (travel / (segments * exchange)) ** 2
    source = SiteSource({}, Places("pile"))
    soil = PreparedPile(source, pile.model_copy(update={"segments": segments})).soil()
    resistance = piles * soil["shaft.resistance"]
    resistance[-2] += resistance[-1]  # the toe's port of waves needs a last segment without
    resistance[-1] = 0.0
    mass = sum(section.length * section.area * section.density for section in pile.rod)
    return SupportRod(
        tuple(section.length for section in pile.rod),
        tuple(piles * section.area for section in pile.rod),
        tuple(scale * section.modulus for section in pile.rod),
        tuple(section.density for section in pile.rod),
        segments,
        _numbers(resistance),
        _numbers(soil["shaft.quake"]),
        _numbers(soil["shaft.damping"]),
        piles * pile.toe.resistance,
        pile.toe.quake,
        pile.toe.damping,
        piles * mass * standard_gravity,
    )


def _numbers(values: NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def spring_rod(stiffness: float, load: float, end_stiffness: float, exchange: float) -> SupportRod:
    """Return an elastic support as a rod on a spring.

    Rod and spring in a row have the stiffness.

    Parameters
    ----------
    stiffness : float
        Of the support (N/m).
    load : float
        At rest (N).
    end_stiffness : float
        Of the end of the roof (N/m), which the impedance of the rod has to match.
    exchange : float
        Exchange step (s).

    Returns
    -------
    SupportRod
    """
    length = _SPRING_SEGMENTS * exchange * _SPRING_SPEED
    least = STIFF_END * end_stiffness * exchange
    own = 10.0 * stiffness * _SPRING_SEGMENTS * exchange  # ten times as stiff as the support
    area = max(least, own) / (_SPRING_DENSITY * _SPRING_SPEED)
    modulus = _SPRING_DENSITY * _SPRING_SPEED**2
    spring = 1.0 / (1.0 / stiffness - length / (modulus * area))
    resistance = _FREE_OF_YIELDING * load
    idle = (0.0,) * _SPRING_SEGMENTS
    return SupportRod(
        (length,),
        (area,),
        (modulus,),
        (_SPRING_DENSITY,),
        _SPRING_SEGMENTS,
        idle,
        (1.0,) * _SPRING_SEGMENTS,
        idle,
        resistance,
        resistance / spring,
        0.0,
        0.0,
    )
