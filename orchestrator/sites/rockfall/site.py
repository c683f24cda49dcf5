"""A site as data: rock, start, profile, ground, search lines and barriers. Form only: preparation.py checks the meaning."""

from typing import Annotated, Any, Literal

from pydantic import Field

from ...input_files.form import Data, NotNegative, Number, Positive

Distribution = Literal["truncated_normal", "uniform", "lognormal", "triangular"]

MOST_TRIALS = 2**31 - 1


class Rock(Data):
    """Mass, or density of a sphere; shape says what the moment of inertia follows from."""

    radius: Positive
    density: Positive | None = None
    mass: Positive | None = None
    shape: Literal["sphere", "disc", "given"] = "sphere"
    moment_of_inertia: Positive | None = None


class Start(Data):
    """Of the rock's centre (m, m/s, rad/s); without y it starts in contact with the slope."""

    x: Number
    y: Number | None = None
    velocity: tuple[Number, Number] = (0.0, 0.0)
    angular_velocity: Number = 0.0


class Profile(Data):
    """Nodes ``[x, y]`` or ``[x, y, material]`` from left to right, or a file with them (CSV, DXF).

    layers: those of a DXF file that are read; all by default. end: x (m) at which a trial ends, by default that of the last node.
    """

    points: list[Any] | None = None
    file: str | None = None
    layers: list[str] | None = None
    end: Number | None = None


class Ground(Data):
    """The material between two x (m); without them, of the whole profile."""

    material: str
    left: Annotated[Number | None, Field(alias="from")] = None
    right: Annotated[Number | None, Field(alias="to")] = None


class Scatter(Data):
    """Mean and standard deviation."""

    mean: Number
    deviation: NotNegative = 0.0


class Material(Data):
    """What a cell is made of; with ``like``, only what differs from that material. Names and units: those of SlopeRockfall."""

    like: str | None = None
    description: str = ""
    strength: Number | None = None
    stiffness: Number | None = None
    hardening: Number | None = None
    friction: Number | None = None
    resistance: Number | None = None
    tilt: Scatter | None = None
    roughness: Scatter | None = None
    source: dict[str, str] = Field(default_factory=dict)


class LimitSpeed(Scatter):
    """V_lim (m/s)."""

    distribution: Distribution = "truncated_normal"


class Distributions(Data):
    """Of R_o and K_s."""

    roughness: Distribution = "truncated_normal"
    tilt: Distribution = "truncated_normal"


class Line(Data):
    """A search line between two points, or upwards from the surface at x."""

    name: Annotated[str, Field(min_length=1)]
    points: tuple[tuple[Number, Number], tuple[Number, Number]] | None = None
    x: Number | None = None


class Barrier(Data):
    """Upright on the surface. It holds a rock of at most ``capacity`` (J) whose centre passes below height - free_border (m)."""

    name: Annotated[str, Field(min_length=1)]
    x: Number
    height: Positive
    capacity: NotNegative
    free_border: NotNegative | None = None


class Site(Data):
    """All that a campaign is made of. hypercube: trials of a Latin hypercube, 0: independent trials. model: other parameters of
    SlopeRockfall by name. stations: places along the profile at which envelopes are kept.
    """

    name: str = ""
    description: str = ""
    trials: Annotated[int, Field(ge=1, le=MOST_TRIALS)] = 10_000
    seed: Annotated[int, Field(ge=0, le=MOST_TRIALS)] = 1
    hypercube: Annotated[int, Field(ge=0, le=MOST_TRIALS)] = 0
    rock: Rock
    start: Start
    profile: Profile
    ground: list[Ground] = Field(default_factory=list)
    material: dict[str, Material] = Field(default_factory=dict)
    limit_speed: LimitSpeed
    distribution: Distributions = Distributions()
    model: dict[str, bool | float | str] = Field(default_factory=dict)
    line: list[Line] = Field(default_factory=list)
    barrier: list[Barrier] = Field(default_factory=list)
    stations: Annotated[int, Field(ge=2, le=100_000)] = 201
