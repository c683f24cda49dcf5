"""A pile as data: hammer, cushion, rod, soil, blows, bearing graph, all in SI units.

This is the form only; ``preparation.py`` checks the meaning. Depths count from the head downwards.
"""

from typing import Annotated

from pydantic import Field

from rockshed.components.common.units import standard_gravity

from ...input_files.form import Data, NotNegative, Positive

MOST_SEGMENTS = 5000
"""Largest number of segments of the rod."""
MOST_BLOWS = 1000
"""Largest number of blows."""
QUAKE = 2.5e-3
"""Displacement (m) at which soil yields where none is set: Smith 1960, 0.1 inch."""
SHAFT_DAMPING, TOE_DAMPING = 0.16, 0.5
"""Damping of the soil (s/m) where none is set: Smith 1960, 0.05 and 0.15 s/ft."""

Fraction = Annotated[float, Field(gt=0.0, le=1.0, strict=True)]
"""A number above 0 and up to 1."""


class DropHammer(Data):
    """A rigid ram of ``mass`` (kg) that falls by ``drop`` (m).

    efficiency: part of the energy of the fall with which it strikes.
    """

    mass: Positive
    drop: Positive
    efficiency: Fraction = 1.0


class HammerCushion(Data):
    """A spring of ``stiffness`` (N/m) between ram and head, without tension.

    It returns the square of ``restitution`` of its energy.
    """

    stiffness: Positive
    restitution: Fraction = 1.0


class Section(Data):
    """A length (m) of the rod with one area (m2), Young's modulus (Pa) and density (kg/m3)."""

    length: Positive
    area: Positive
    modulus: Positive
    density: Positive


class ShaftLayer(Data):
    """Soil along the shaft between two depths (m) below the head.

    resistance: ultimate one of the whole layer (N); quake (m); damping (s/m).
    """

    top: Annotated[NotNegative, Field(alias="from")]
    bottom: Annotated[Positive, Field(alias="to")]
    resistance: NotNegative
    quake: Positive = QUAKE
    damping: NotNegative = SHAFT_DAMPING


class ToeSoil(Data):
    """Soil under the toe: ultimate resistance (N), quake (m), damping (s/m)."""

    resistance: Positive
    quake: Positive = QUAKE
    damping: NotNegative = TOE_DAMPING


class BearingGraph(Data):
    """Ultimate resistances (N) of shaft and toe together, to which the soil is scaled."""

    resistances: Annotated[list[Positive], Field(min_length=2, max_length=1000)]


class PileSite(Data):
    """All that the blows on a pile need.

    time: of a blow (s), from the stroke on, by default 0.1 s or 20 travel times of a wave.
    gauge: depth of the gauge (m). rod: sections from head to toe.
    """

    name: str = ""
    description: str = ""
    blows: Annotated[int, Field(ge=1, le=MOST_BLOWS)] = 1
    segments: Annotated[int, Field(ge=1, le=MOST_SEGMENTS)] = 100
    time: Positive | None = None
    gravity: NotNegative = standard_gravity
    gauge: NotNegative = 0.0
    hammer: DropHammer
    cushion: HammerCushion | None = None
    rod: Annotated[list[Section], Field(min_length=1)]
    shaft: list[ShaftLayer] = Field(default_factory=list)
    toe: ToeSoil
    bearing: BearingGraph | None = None
