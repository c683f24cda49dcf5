"""A slope as data: rock, start, profile, ground, search lines and barriers, all in SI units.

This is the form only; ``preparation.py`` checks the meaning.
"""

from typing import Annotated, Any, Literal

from pydantic import Field

from ...input_files.chance import Chance
from ...input_files.fields import (
    Angle,
    AngularVelocity,
    Density,
    Distance,
    Energy,
    Length,
    Mass,
    Place,
    Velocity,
    field,
)
from ...input_files.form import Data, NotNegative, Number, Positive

Distribution = Literal["truncated_normal", "uniform", "lognormal", "triangular"]

MOST_TRIALS = 2**31 - 1
"""Largest number of trials, and of a seed."""


class Rock(Data):
    """A rock with two of radius (m), mass (kg) and density (kg/m3), or measured boulders.

    These come from a ``file`` (CSV), or ``boulders`` lists mass, radius and elongation of each.

    ``shape`` says what the moment of inertia (kg m2) follows from, and an ellipse how the rock
    touches the ground: its semi-axes are r sqrt(elongation) and r / sqrt(elongation). Each quantity
    is a number or a distribution.
    """

    radius: Chance[Length] | None = field("radius", usual=(0.01, 10.0), likely=("cm", "mm"))
    density: Chance[Density] | None = field(
        "density", usual=(1000.0, 9000.0), likely=("t/m3", "kN/m3", "g/m3")
    )
    mass: Chance[Mass] | None = field("mass", usual=(0.01, 2e6), likely=("t",))
    file: str | None = None
    boulders: Annotated[list[tuple[Positive, Positive, Positive]], Field(min_length=1)] | None = (
        None
    )
    shape: Literal["sphere", "disc", "given", "ellipse"] = "sphere"
    elongation: Chance[Positive] | None = None
    moment_of_inertia: Positive | None = None


class RockStart(Data):
    """State of the rock's centre at the start (m, m/s, rad/s), numbers or distributions.

    Without y the rock starts in contact with the slope. Instead of x and y: ``line``, anywhere on
    the straight line between two points, or ``along``, on the slope between two x, evenly along its
    length. ``angle`` is that of the long axis of an ellipse, by default any.
    """

    x: Chance[Place] | None = None
    y: Chance[Place] | None = None
    line: tuple[tuple[Place, Place], tuple[Place, Place]] | None = None
    along: tuple[Place, Place] | None = None
    velocity: tuple[Chance[Velocity], Chance[Velocity]] = field(
        "velocity", (0.0, 0.0), usual=(1e-3, 150.0), likely=("mm/s", "km/h")
    )
    angular_velocity: Chance[AngularVelocity] = field("angular velocity", 0.0, usual=(1e-3, 200.0))
    angle: Chance[Angle] | None = None


class Profile(Data):
    """Nodes ``[x, y]`` or ``[x, y, material]`` from left to right (m), or a file with them.

    Files are CSV or DXF. layers: those of a DXF file that are read, all by default. end: x (m) at
    which a trial ends, by default that of the last node.
    """

    points: list[Any] | None = None
    file: str | None = None
    layers: list[str] | None = None
    end: Number | None = None


class GroundRange(Data):
    """The material between two x (m); without them, of the whole profile."""

    material: str
    left: Annotated[Number | None, Field(alias="from")] = None
    right: Annotated[Number | None, Field(alias="to")] = None


class Scatter(Data):
    """Mean and standard deviation of a random quantity."""

    mean: Number
    deviation: NotNegative = 0.0


class Material(Data):
    """Ground of a cell; with ``like``, only the values that differ from that material.

    Names and units are those of the component SlopeRockfall. Impacts follow DRSP with strength,
    stiffness and hardening, or coefficients of restitution where those are given instead.
    """

    like: str | None = None
    description: str = ""
    strength: Number | None = None
    stiffness: Number | None = None
    hardening: Number | None = None
    friction: Number | None = None
    resistance: Number | None = None
    tilt: Scatter | None = None
    roughness: Scatter | None = None
    undulation: NotNegative | None = None
    normal_restitution: NotNegative | None = None
    tangential_restitution: NotNegative | None = None
    scaling_speed: NotNegative | None = None
    source: dict[str, str] = Field(default_factory=dict)


class LimitSpeed(Scatter):
    """Limit speed V_lim (m/s) and its distribution."""

    distribution: Distribution = "truncated_normal"


class Distributions(Data):
    """Distributions of the roughness R_o and of the tilt K_s."""

    roughness: Distribution = "truncated_normal"
    tilt: Distribution = "truncated_normal"


class Line(Data):
    """A search line between two points (m), or upwards from the surface at x (m)."""

    name: Annotated[str, Field(min_length=1)]
    points: tuple[tuple[Number, Number], tuple[Number, Number]] | None = None
    x: Number | None = None


class Barrier(Data):
    """A barrier upright on the surface at x (m).

    It holds a rock of at most ``capacity`` (J) whose centre passes below height - free_border (m).
    """

    name: Annotated[str, Field(min_length=1)]
    x: Place
    height: Length = field("height", ..., usual=(0.1, 60.0), likely=("cm", "mm"))
    capacity: Energy = field("capacity", ..., usual=(5e3, 5e7), likely=("kJ", "MJ"))
    free_border: Distance | None = field("free border", usual=(1e-3, 10.0), likely=("cm", "mm"))


class SlopeSite(Data):
    """All that the trials on a slope need.

    hypercube: trials of a Latin hypercube, 0 for independent trials. model: other parameters of
    SlopeRockfall by name. stations: number of places along the profile at which envelopes are kept.
    """

    name: str = ""
    description: str = ""
    trials: Annotated[int, Field(ge=1, le=MOST_TRIALS)] = 10_000
    seed: Annotated[int, Field(ge=0, le=MOST_TRIALS)] = 1
    hypercube: Annotated[int, Field(ge=0, le=MOST_TRIALS)] = 0
    rock: Rock
    start: RockStart
    profile: Profile
    ground: list[GroundRange] = Field(default_factory=list)
    material: dict[str, Material] = Field(default_factory=dict)
    limit_speed: LimitSpeed
    distribution: Distributions = Distributions()
    model: dict[str, bool | float | str] = Field(default_factory=dict)
    line: list[Line] = Field(default_factory=list)
    barrier: list[Barrier] = Field(default_factory=list)
    stations: Annotated[int, Field(ge=2, le=100_000)] = 201
