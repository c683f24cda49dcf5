"""A pile as data: hammer, cushion, rod, soil, blows, bearing graph, all in SI units.

This is the form only; ``preparation.py`` checks the meaning. Depths count from the head downwards.
"""

from typing import Annotated

from pydantic import Field

from rockshed.components.common.units import standard_gravity

from ...input_files.fields import (
    Acceleration,
    Area,
    Density,
    Distance,
    Duration,
    Force,
    Length,
    Mass,
    Pressure,
    Resistance,
    SoilDamping,
    Stiffness,
    field,
)
from ...input_files.form import Data

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

    mass: Mass = field("mass of the ram", ..., usual=(10.0, 2e5), likely=("t",))
    drop: Length = field("height of its fall", ..., usual=(0.02, 10.0), likely=("cm", "mm"))
    efficiency: Fraction = 1.0


class HammerCushion(Data):
    """A spring of ``stiffness`` (N/m) between ram and head, without tension.

    It returns the square of ``restitution`` of its energy.
    """

    stiffness: Stiffness = field(
        "stiffness", ..., usual=(1e6, 1e12), likely=("kN/m", "kN/mm", "kgf/cm")
    )
    restitution: Fraction = 1.0


class Section(Data):
    """A length (m) of the rod with one area (m2), Young's modulus (Pa) and density (kg/m3)."""

    length: Length = field("length", ..., usual=(0.05, 200.0), likely=("cm", "mm"))
    area: Area = field("area", ..., usual=(1e-4, 20.0), likely=("cm2", "mm2"))
    modulus: Pressure = field(
        "Young's modulus", ..., usual=(1e9, 5e11), likely=("GPa", "MPa", "kgf/cm2")
    )
    density: Density = field(
        "density", ..., usual=(300.0, 12000.0), likely=("t/m3", "g/cm3", "kN/m3")
    )


class ShaftLayer(Data):
    """Soil along the shaft between two depths (m) below the head.

    resistance: ultimate one of the whole layer (N); quake (m); damping (s/m).
    """

    top: Annotated[Distance, Field(alias="from")]
    bottom: Annotated[Length, Field(alias="to")]
    resistance: Resistance = field(
        "ultimate resistance of the layer", ..., usual=(500.0, 1e9), likely=("kN", "MN", "tf")
    )
    quake: Length = field("quake", QUAKE, usual=(1e-4, 0.1), likely=("mm", "cm"))
    damping: SoilDamping = field("damping", SHAFT_DAMPING, usual=(1e-3, 10.0), likely=("s/ft",))


class ToeSoil(Data):
    """Soil under the toe: ultimate resistance (N), quake (m), damping (s/m)."""

    resistance: Force = field(
        "ultimate resistance", ..., usual=(500.0, 1e9), likely=("kN", "MN", "tf")
    )
    quake: Length = field("quake", QUAKE, usual=(1e-4, 0.1), likely=("mm", "cm"))
    damping: SoilDamping = field("damping", TOE_DAMPING, usual=(1e-3, 10.0), likely=("s/ft",))


class BearingGraph(Data):
    """Ultimate resistances (N) of shaft and toe together, to which the soil is scaled."""

    resistances: list[Force] = field(
        "ultimate resistances of shaft and toe together",
        ...,
        usual=(500.0, 1e9),
        likely=("kN", "MN", "tf"),
        min_length=2,
        max_length=1000,
    )


class PileSite(Data):
    """All that the blows on a pile need.

    time: of a blow (s), from the stroke on, by default 0.1 s or 20 travel times of a wave.
    gauge: depth of the gauge (m). rod: sections from head to toe.
    """

    name: str = ""
    description: str = ""
    blows: Annotated[int, Field(ge=1, le=MOST_BLOWS)] = 1
    segments: Annotated[int, Field(ge=1, le=MOST_SEGMENTS)] = 100
    time: Duration | None = field("time of a blow", usual=(1e-3, 10.0), likely=("ms",))
    gravity: Acceleration = field("acceleration of gravity", standard_gravity)
    gauge: Distance = field("depth of the gauge", 0.0)
    hammer: DropHammer
    cushion: HammerCushion | None = None
    rod: Annotated[list[Section], Field(min_length=1)]
    shaft: list[ShaftLayer] = Field(default_factory=list)
    toe: ToeSoil
    bearing: BearingGraph | None = None
