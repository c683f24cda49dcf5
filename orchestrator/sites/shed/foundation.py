"""Piles of a pile file under the supports of a shed: rods with their soil.

A pile stands under each end of each girder; those of the girders that take part act together.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.units import standard_gravity
from rockshed.components.pile_rod.declarations import SIZES

from ...input_files.places import Places
from ..pile.design import PileDesign
from ..pile.preparation import PreparedPile, wave_speed
from ..source import SiteSource

STIFF_END = 5.0
"""Impedance of a rod / (stiffness of the roof's end times exchange step), at least.

The limit of the rod is 1, and near it an exchange makes energy.
"""
MOST_SEGMENTS = SIZES["segments"].maximum
"""Largest number of segments of a rod."""


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


def impedance(pile: PileDesign) -> float:
    """Return the impedance EA/c at the head of a pile (N s/m).

    Parameters
    ----------
    pile : PileDesign
        The pile.
    """
    head = pile.rod[0]
    return head.area * math.sqrt(head.modulus * head.density)


def pile_rod(pile: PileDesign, piles: float, exchange: float) -> SupportRod:
    """Return piles that act together as one rod.

    The waves are given a speed with which the rod is a whole number of segments long: it changes
    by less than half a segment in its length.

    Parameters
    ----------
    pile : PileDesign
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
    laid = pile.model_copy(update={"segments": min(segments, MOST_SEGMENTS)})  # more are refused
    soil = PreparedPile(source, laid).soil()
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
