"""A pile as data: hammer, cushion, rod, soil, blows, bearing graph. Form only: preparation.py checks the meaning. SI units."""

from typing import Annotated

from pydantic import Field

from ...input_files.form import Data, NotNegative, Positive

MOST_SEGMENTS = 5000
MOST_BLOWS = 1000


class Hammer(Data):
    """A rigid ram; drop: height of fall (m). efficiency: part of the energy of the fall that it strikes with."""

    mass: Positive
    drop: Positive
    efficiency: Annotated[float, Field(gt=0.0, le=1.0, strict=True)] = 1.0


class Cushion(Data):
    """Between ram and head: no tension; it gives back the square of ``restitution`` of its energy. stiffness: N/m."""

    stiffness: Positive
    restitution: Annotated[float, Field(gt=0.0, le=1.0, strict=True)] = 1.0


class Section(Data):
    """A length (m) of the rod with one area (m2), Young's modulus (Pa) and density (kg/m3), from head to toe."""

    length: Positive
    area: Positive
    modulus: Positive
    density: Positive


class Shaft(Data):
    """Soil along the shaft between two depths (m) below the head: its whole ultimate resistance (N), quake (m), damping (s/m)."""

    top: Annotated[NotNegative, Field(alias="from")]
    bottom: Annotated[Positive, Field(alias="to")]
    resistance: NotNegative
    quake: Positive = 2.5e-3
    damping: NotNegative = 0.16


class Toe(Data):
    """Soil under the toe: ultimate resistance (N), quake (m), damping (s/m)."""

    resistance: Positive
    quake: Positive = 2.5e-3
    damping: NotNegative = 0.5


class Bearing(Data):
    """The bearing graph: ultimate resistances (N) of shaft and toe together. The soil of the file is scaled to them."""

    resistances: Annotated[list[Positive], Field(min_length=2, max_length=1000)]


class PileSite(Data):
    """All that is computed.

    time: of a blow (s), from the stroke on; by default 0.1 s or 20 travel times of a wave. gauge: depth of the gauge (m).
    """

    name: str = ""
    description: str = ""
    blows: Annotated[int, Field(ge=1, le=MOST_BLOWS)] = 1
    segments: Annotated[int, Field(ge=1, le=MOST_SEGMENTS)] = 100
    time: Positive | None = None
    gravity: NotNegative = 9.80665
    gauge: NotNegative = 0.0
    hammer: Hammer
    cushion: Cushion | None = None
    rod: Annotated[list[Section], Field(min_length=1)]
    shaft: list[Shaft] = Field(default_factory=list)
    toe: Toe
    bearing: Bearing | None = None
