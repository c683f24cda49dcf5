"""A pile as data: hammer, cushions, rod, soil, blows, bearing graph, all in SI units.

This is the form of a file only; ``design.py`` has the pile that follows from it, and
``preparation.py`` checks the meaning. Depths count from the head downwards; those of ground from
its surface.
"""

from typing import Annotated, Literal

from pydantic import Field

from rockshed.components.common.units import standard_gravity

from ...input_files.fields import (
    Acceleration,
    Area,
    Density,
    Distance,
    Duration,
    Energy,
    Force,
    Length,
    Mass,
    Pressure,
    Rate,
    Resistance,
    SoilDamping,
    Stiffness,
    StressGradient,
    field,
)
from ...input_files.form import Data
from ...input_files.form import Positive as PositiveNumber

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


class Anvil(Data):
    """A body between the ram of a diesel hammer and its cushion, struck by steel on steel."""

    mass: Mass = field("mass of the anvil", ..., usual=(10.0, 2e4), likely=("t",))
    stiffness: Stiffness = field(
        "stiffness of the contact of ram and anvil", 1e10, usual=(1e8, 1e12), likely=("kN/m",)
    )
    restitution: Fraction = Field(0.9, description="coefficient of restitution of the contact")


class Gas(Data):
    """Force of the gas between ram and anvil of a diesel hammer over time (s).

    Constant for ``hold`` and falling evenly until ``end``, as in the programs of the Texas
    Transportation Institute; both count from the moment when the ram touches.
    """

    force: Force = field("largest force of the gas", ..., usual=(1e4, 1e8), likely=("kN",))
    hold: Duration = field("time of its full force", 10e-3, usual=(1e-4, 0.1), likely=("ms",))
    end: Duration = field("time at which it is over", 12.5e-3, usual=(1e-4, 0.2), likely=("ms",))


class Hammer(Data):
    """A rigid ram with the energy of its fall, or with a rated energy.

    efficiency: part of that energy with which it strikes.
    """

    model: str | None = Field(None, description="name of a hammer of the table")
    kind: Literal["drop", "hydraulic", "diesel"] | None = Field(
        None, description="drop, hydraulic (air and steam too) or diesel; drop"
    )
    mass: Mass | None = field("mass of the ram", usual=(10.0, 2e5), likely=("t",))
    drop: Length | None = field("height of its fall", usual=(0.02, 10.0), likely=("cm", "mm"))
    energy: Energy | None = field(
        "rated energy, in the place of the height", usual=(10.0, 1e7), likely=("kJ",)
    )
    efficiency: Fraction | None = Field(
        None, description="part of the energy with which it strikes; 1"
    )
    rate: Rate | None = field(
        "blows in a second, as in `50 1/min`", usual=(0.05, 5.0), likely=("1/min",)
    )
    ports: Distance | None = field(
        "last part of the fall, in which a diesel hammer compresses its gas",
        usual=(0.01, 2.0),
        likely=("cm", "mm"),
    )
    anvil: Anvil | None = None
    gas: Gas | None = None


class DrivingCushion(Data):
    """A spring without tension: its ``stiffness``, or a material with area and thickness.

    It returns the square of ``restitution`` of its energy.
    """

    stiffness: Stiffness | None = field(
        "stiffness", usual=(1e6, 1e12), likely=("kN/m", "kN/mm", "kgf/cm")
    )
    material: str | None = Field(None, description="name of a material of the table")
    thickness: Length | None = field("thickness", usual=(5e-3, 1.5), likely=("mm", "cm"))
    area: Area | None = field("area", usual=(1e-3, 10.0), likely=("cm2", "mm2"))
    modulus: Pressure | None = field(
        "Young's modulus, in the place of the material's",
        usual=(1e7, 5e11),
        likely=("MPa", "GPa"),
    )
    restitution: Fraction | None = Field(
        None, description="coefficient of restitution; that of the material, or 1"
    )


class Helmet(Data):
    """The drive cap between the cushions: a rigid body."""

    mass: Mass = field("mass of the helmet", ..., usual=(10.0, 1e5), likely=("t",))


class Section(Data):
    """A length (m) of the rod with one section, modulus (Pa) and density (kg/m3).

    The section is an area, a diameter (with a wall: a pipe) or the width of a square.
    """

    length: Length = field("length", ..., usual=(0.05, 200.0), likely=("cm", "mm"))
    area: Area | None = field("area", usual=(1e-4, 20.0), likely=("cm2", "mm2"))
    diameter: Length | None = field("outer diameter", usual=(0.02, 5.0), likely=("mm", "cm"))
    wall: Length | None = field("wall of a pipe", usual=(2e-3, 0.5), likely=("mm", "cm"))
    width: Length | None = field("width of a square", usual=(0.05, 3.0), likely=("mm", "cm"))
    perimeter: Length | None = field(
        "perimeter on which friction acts; that of diameter or width", usual=(0.05, 20.0)
    )
    modulus: Pressure = field(
        "Young's modulus", ..., usual=(1e9, 5e11), likely=("GPa", "MPa", "kgf/cm2")
    )
    density: Density = field(
        "density", ..., usual=(300.0, 12000.0), likely=("t/m3", "g/cm3", "kN/m3")
    )


class ShaftLayer(Data):
    """NamedSoil along the shaft between two depths (m) below the head.

    resistance: ultimate one of the whole layer (N); quake (m); damping (s/m).
    """

    top: Annotated[
        Distance, Field(alias="from", description="depth of its upper end below the head")
    ]
    bottom: Annotated[Length, Field(alias="to", description="depth of its lower end")]
    resistance: Resistance = field(
        "ultimate resistance of the layer", ..., usual=(500.0, 1e9), likely=("kN", "MN", "tf")
    )
    quake: Length = field("quake", QUAKE, usual=(1e-4, 0.1), likely=("mm", "cm"))
    damping: SoilDamping = field("damping", SHAFT_DAMPING, usual=(1e-3, 10.0), likely=("s/ft",))


class ToeSoil(Data):
    """NamedSoil under the toe: ultimate resistance (N), quake (m), damping (s/m)."""

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
    last_blow: bool = Field(
        True, description="whether the last of the blows is computed too, where there are several"
    )
    refusal: PositiveNumber = Field(
        1000.0, description="blows per 0.3 m from which a set is said to be none"
    )


class NamedSoil(Data):
    """A soil by name: unit friction and toe resistance, each constant, growing, or by stress.

    Friction is ``friction`` + ``friction_growth`` times the depth below the layer's top, or
    ``beta`` times the vertical effective stress; at most ``friction_limit``. The resistance under
    a toe is ``toe``, or ``toe_factor`` times that stress; at most ``toe_limit``.
    """

    density: Density | None = field(
        "density with its water", usual=(800.0, 3000.0), likely=("kN/m3", "t/m3")
    )
    friction: Pressure | None = field(
        "unit friction at the layer's top", usual=(500.0, 1e6), likely=("kPa",)
    )
    friction_growth: StressGradient | None = field(
        "growth of the friction with the depth, as in `2 kPa/m`",
        usual=(10.0, 1e5),
        likely=("kN/m3",),
    )
    beta: PositiveNumber | None = Field(None, description="friction / vertical effective stress")
    friction_limit: Pressure | None = field(
        "largest unit friction", usual=(500.0, 1e6), likely=("kPa",)
    )
    driving: Fraction = Field(
        1.0, description="part of the friction that acts while the pile is driven"
    )
    toe: Pressure | None = field(
        "unit resistance under a toe", usual=(1e4, 1e8), likely=("kPa", "MPa")
    )
    toe_factor: PositiveNumber | None = Field(
        None, description="that resistance / vertical effective stress, N_q"
    )
    toe_limit: Pressure | None = field(
        "largest unit resistance under a toe", usual=(1e4, 1e8), likely=("kPa", "MPa")
    )
    quake: Length = field("quake of the shaft", QUAKE, usual=(1e-4, 0.1), likely=("mm", "cm"))
    damping: SoilDamping = field(
        "damping of the shaft", SHAFT_DAMPING, usual=(1e-3, 10.0), likely=("s/ft",)
    )
    toe_quake: Length = field("quake of the toe", QUAKE, usual=(1e-4, 0.1), likely=("mm", "cm"))
    toe_damping: SoilDamping = field(
        "damping of the toe", TOE_DAMPING, usual=(1e-3, 10.0), likely=("s/ft",)
    )


class GroundLayer(Data):
    """A layer of a soil, from the end of the one above (or the surface) down to ``to`` (m)."""

    soil: str = Field(description="name of its soil")
    bottom: Length = field(
        "depth of its lower end below the ground surface",
        ...,
        usual=(0.1, 300.0),
        likely=("cm", "mm"),
        alias="to",
    )


class Ground(Data):
    """Ground in layers, in which the toe stands ``penetration`` (m) below its surface."""

    penetration: Length = field(
        "depth of the toe below the ground surface", ..., usual=(0.3, 200.0), likely=("cm", "mm")
    )
    water: Distance | None = field("depth of the water table; none: dry")
    toe_area: Area | None = field(
        "area on which the toe bears; that of a solid section", usual=(1e-3, 20.0)
    )
    layers: Annotated[list[GroundLayer], Field(min_length=1, max_length=100)]


class Drivability(Data):
    """Penetrations (m) at which a blow is computed, and how blows are counted."""

    penetrations: list[Length] = field(
        "depths of the toe below the ground surface",
        ...,
        usual=(0.3, 200.0),
        likely=("cm", "mm"),
        min_length=2,
        max_length=200,
    )
    per: Length = field("way for which blows are counted", 0.25, usual=(0.01, 1.0))
    refusal: PositiveNumber = Field(
        250.0, description="blows for that way from which the pile is said not to go on"
    )


class RodLengths(Data):
    """Lengths (m) of the rod of a penetration test, for each of which a blow is computed."""

    lengths: list[Length] = field(
        "lengths of the rod of a penetration test",
        ...,
        usual=(0.5, 100.0),
        likely=("cm", "mm"),
        min_length=2,
        max_length=100,
    )


class Limits(Data):
    """Stresses (Pa) that the pile may bear while it is driven."""

    compression: Pressure | None = field(
        "largest compression", usual=(1e6, 1e9), likely=("MPa", "ksi")
    )
    tension: Pressure | None = field("largest tension", usual=(1e5, 1e9), likely=("MPa", "ksi"))


class PileParts(Data):
    """The part of a pile that its file and its computation share.

    time: of a blow (s), from the stroke on, by default 0.1 s or 20 travel times of a wave.
    gauge: depth of the gauge (m).
    """

    name: str = Field("", description="name of the results; that of the file")
    description: str = Field("", description="a line for people")
    blows: Annotated[int, Field(ge=1, le=MOST_BLOWS, description="number of blows")] = 1
    segments: Annotated[
        int, Field(ge=1, le=MOST_SEGMENTS, description="parts of equal travel time")
    ] = 100
    time: Duration | None = field("time of a blow", usual=(1e-3, 10.0), likely=("ms",))
    gravity: Acceleration = field("acceleration of gravity", standard_gravity)
    gauge: Distance = field("depth of the gauge", 0.0)
    shaft: list[ShaftLayer] = Field(default_factory=list)
    bearing: BearingGraph | None = None
    drivability: Drivability | None = None
    limits: Limits = Field(default_factory=Limits)
    spt: RodLengths | None = None


class PileSite(PileParts):
    """All that the blows on a pile need, as its file has it. rod: sections from head to toe.

    The soil is given by depths below the head (``shaft``, ``toe``), or as ground in layers.
    """

    hammer: Hammer
    cushion: DrivingCushion | None = None
    helmet: Helmet | None = None
    pile_cushion: DrivingCushion | None = None
    rod: Annotated[list[Section], Field(min_length=1)]
    toe: ToeSoil | None = None
    ground: Ground | None = None
    soil: dict[str, NamedSoil] = Field(default_factory=dict)
