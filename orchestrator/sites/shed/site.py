"""The form of a project file: rock, cushion, roof, supports, criteria, numerics.

This is the form only; ``preparation.py`` checks the meaning, ``geometry.py`` derives the rest.
A bare number is in SI units; with a unit it is a text, ``"2.5 t"``.
"""

import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from ...core.input_text import shown
from ...core.system.quantities import in_si
from ...input_files.fields import (
    Angle,
    AngularVelocity,
    Area,
    Cohesion,
    Density,
    Duration,
    Length,
    Mass,
    MassPerLength,
    Moment,
    Place,
    Pressure,
    SecondMoment,
    SectionModulus,
    Speed,
    Stiffness,
    field,
)
from ...input_files.form import LARGEST, SMALLEST, Data

MOST_SEED = 2**31 - 1
"""Largest number of a sample."""
SolidFraction = Annotated[float, Field(ge=0.5, le=0.9, strict=True)]
"""Part of a layer that its discs fill, in the plane."""


_PART_OF_SPAN = re.compile(r"(?:span|[lL])\s*/\s*(\d+(?:\.\d+)?)")


def _deflection_limit(value: Any) -> str | float:
    """Return a length (m), or a part of the span as it is written.

    Raises
    ------
    ValueError
        It is neither.
    """
    given = f"(given: {shown(value)})"
    if isinstance(value, str) and (part := _PART_OF_SPAN.fullmatch(value.strip())):
        if not 1.0 <= float(part.group(1)) <= LARGEST:
            raise ValueError(f"must be a part of the span, span/300 for instance {given}")
        return f"span/{part.group(1)}"
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError(f"must be a length or a part of the span, span/300 for instance {given}")
    length = in_si(value, "m") if isinstance(value, str) else value
    if not SMALLEST <= length <= LARGEST:
        raise ValueError(f"must be {SMALLEST:g} to {LARGEST:g} m {given}")
    return float(length)


DeflectionLimit = Annotated[str | float, BeforeValidator(_deflection_limit)]
"""A length (m), or ``span/300``, which may be written ``L/300``."""


class StrikingRock(Data):
    """The rock, and how it arrives at the surface of the cushion."""

    mass: Mass | None = field("mass; or size, or both", usual=(20.0, 5e5), likely=("t",))
    size: Length | None = field(
        "diameter of a sphere, edge of a block", usual=(0.1, 10.0), likely=("cm", "mm")
    )
    density: Density | None = field(
        "density; 2600 kg/m3 unless mass and size are given",
        usual=(1500.0, 8000.0),
        likely=("t/m3", "kN/m3", "g/m3"),
    )
    shape: Literal["sphere", "block"] = field(
        "sphere, or block: computed as the sphere of equal mass and density", "sphere"
    )
    drop_height: Length | None = field(
        "height of the fall onto the surface; or velocity", usual=(0.1, 500.0), likely=("cm", "mm")
    )
    velocity: Speed | None = field(
        "speed at the surface", usual=(0.5, 150.0), likely=("km/h", "mm/s")
    )
    angle: Angle = field(
        "direction of the velocity from the vertical, positive to the right",
        0.0,
        usual=(1e-3, 1.5),
        likely=("deg",),
    )
    spin: AngularVelocity = field("angular velocity, counter-clockwise", 0.0, usual=(1e-3, 100.0))
    place: Place | None = field(
        "x from the left support where it strikes; midspan", likely=("cm", "mm"), usual=(1e-3, 100)
    )


class SlopeAbove(Data):
    """The slope that the rock comes from: the rock of a campaign, in the place of ``rock``."""

    file: str = field("site file of the slope, as `rockshed rockfall` reads it", ...)
    x: Place = field("x of the left support on its profile", ...)
    y: Place = field("y of the roof's top, under the cushion, on its profile", ...)
    percentile: Annotated[float, Field(gt=0.0, lt=100.0, strict=True)] | None = field(
        "percentile, in percent, of the quantity over the rocks that strike the cushion: its rock "
        "is taken; 95",
        usual=(50.0, 99.9),
    )
    quantity: Literal["energy", "speed"] | None = field(
        "energy: kinetic energy at the cushion's surface; or speed there; energy"
    )
    trial: Annotated[int, Field(ge=0, le=MOST_SEED, strict=True)] | None = field(
        "number of a trial whose rock is taken, in the place of a percentile"
    )
    trials: Annotated[int, Field(ge=1, le=MOST_SEED, strict=True)] | None = field(
        "trials of the campaign; those of the site file"
    )
    seed: Annotated[int, Field(ge=0, le=MOST_SEED, strict=True)] | None = field(
        "seed of the campaign; that of the site file"
    )


class CushionLayer(Data):
    """A layer of the cushion, from below."""

    material: str = field("name of its material", ...)
    thickness: Length = field("thickness", ..., usual=(0.05, 10.0), likely=("cm", "mm"))


class Cushion(Data):
    """The cushion of sand on the roof."""

    thickness: Length | None = field(
        "thickness; or layers", usual=(0.05, 10.0), likely=("cm", "mm")
    )
    width: Length | None = field(
        "extent along the span, around midspan; the span", usual=(0.2, 60.0), likely=("cm", "mm")
    )
    material: str | None = field("name of the material; compacted sand")
    layers: list[CushionLayer] = field("layers from below, in the place of thickness", [])
    effective_width: str | float | None = field(
        "width of the roof that takes part, as a rule or as a length",
        unit="m",
        usual=(0.2, 20.0),
        likely=("cm", "mm"),
    )


class SandMaterial(Data):
    """A material of the cushion; with ``like``, only the values that differ from that material."""

    like: str | None = field("material that has the values left out")
    description: str = field("description", "")
    modulus: Pressure | None = field(
        "fictitious modulus E_bar", usual=(2e5, 5e7), likely=("kgf/cm2", "MPa", "kPa")
    )
    density: Density | None = field(
        "density of the layer with its voids", usual=(800.0, 2600.0), likely=("kN/m3", "t/m3")
    )
    solid_fraction: SolidFraction | None = field("part of the layer that its discs fill")
    cohesion: Cohesion | None = field("cohesion", usual=(10.0, 1e5), likely=("kPa", "kgf/cm2"))
    friction_angle: Angle | None = field("angle of friction", usual=(0.1, 1.2), likely=("deg",))
    source: dict[str, str] = field("where each value comes from", {})


class RoofSlab(Data):
    """A slab on the girders: its mass moves with them, its stiffness is left out."""

    thickness: Length = field("thickness", ..., usual=(0.03, 2.0), likely=("cm", "mm"))
    density: Density = field("density", 2500.0, usual=(300.0, 8000.0), likely=("t/m3", "kN/m3"))


class ConcreteStrip(Data):
    """A strip of a reinforced concrete slab, in the place of girders."""

    thickness: Length = field("thickness", ..., usual=(0.1, 3.0), likely=("cm", "mm"))
    cover: Length = field(
        "from the surface to the middle of the bars", ..., usual=(0.01, 0.3), likely=("cm", "mm")
    )
    bar_diameter: Length = field(
        "diameter of the bars below", ..., usual=(5e-3, 0.06), likely=("mm", "cm")
    )
    bar_spacing: Length = field("distance of the bars", ..., usual=(0.04, 1.0), likely=("mm", "cm"))
    top_bar_diameter: Length | None = field(
        "diameter of the bars above; none: hogging is borne up to cracking only",
        usual=(5e-3, 0.06),
        likely=("mm", "cm"),
    )
    top_bar_spacing: Length | None = field(
        "distance of the bars above; that of those below", usual=(0.04, 1.0), likely=("mm", "cm")
    )
    top_cover: Length | None = field(
        "from the upper surface to the middle of the bars above; the cover below",
        usual=(0.01, 0.3),
        likely=("cm", "mm"),
    )
    concrete_strength: Pressure = field(
        "compressive strength of the concrete", ..., usual=(8e6, 2e8), likely=("MPa", "kgf/cm2")
    )
    bar_yield_stress: Pressure = field(
        "yield stress of the bars", ..., usual=(1.5e8, 1e9), likely=("MPa", "kgf/cm2")
    )


class Roof(Data):
    """The roof: girders side by side, or a strip of a slab."""

    span: Length = field("distance of the supports", ..., usual=(0.5, 60.0), likely=("cm", "mm"))
    section: str | None = field("name of the girders' rolled section; or its own values")
    area: Area | None = field("section area", usual=(1e-4, 1.0), likely=("cm2", "mm2"))
    second_moment: SecondMoment | None = field(
        "second moment of area", usual=(1e-8, 1.0), likely=("cm4", "mm4")
    )
    section_modulus: SectionModulus | None = field(
        "elastic section modulus; 2 I / height", usual=(1e-6, 1.0), likely=("cm3", "mm3")
    )
    plastic_modulus: SectionModulus | None = field(
        "plastic section modulus; the elastic one", usual=(1e-6, 1.0), likely=("cm3", "mm3")
    )
    height: Length | None = field("height of the section", usual=(0.05, 5.0), likely=("cm", "mm"))
    mass: MassPerLength | None = field(
        "mass of a girder by length; area times density", usual=(1.0, 1e4), likely=("t/m",)
    )
    steel: str | None = field("grade of the steel; SS400")
    yield_stress: Pressure | None = field(
        "yield stress; that of the grade", usual=(1e8, 1.5e9), likely=("MPa", "kgf/cm2")
    )
    elastic_modulus: Pressure | None = field(
        "Young's modulus; that of the grade", usual=(5e9, 3e11), likely=("GPa", "MPa", "kgf/cm2")
    )
    spacing: Length | None = field(
        "distance of the girders", usual=(0.2, 20.0), likely=("cm", "mm")
    )
    number: Annotated[int, Field(ge=1, le=10_000, strict=True)] | None = field(
        "number of girders; as many as take part"
    )
    bending: Literal["yielding", "elastic"] = field(
        "yielding: with the moment-curvature line of the section; or elastic, whatever the stress",
        "yielding",
    )
    slab: RoofSlab | None = field("slab on the girders")
    concrete: ConcreteStrip | None = field("reinforced concrete, in the place of girders")


class Supports(Data):
    """The supports of the roof, the same at both ends."""

    kind: Literal["hinged", "fixed", "elastic", "piles"] = field(
        "hinged, fixed, elastic (stiffness) or piles (file)", "hinged"
    )
    stiffness: Stiffness | None = field(
        "of the spring under each end of each girder, or of each metre of a slab",
        usual=(1e5, 1e11),
        likely=("kN/m", "kN/mm"),
    )
    file: str | None = field(
        "file of a pile, as `rockshed pile` reads it; one under each end of each girder"
    )


class Criteria(Data):
    """Limits that the results are compared with."""

    stress: Pressure | None = field(
        "of the bending stress; the yield stress", usual=(1e6, 1.5e9), likely=("MPa", "kgf/cm2")
    )
    plastic_moment: Moment | None = field(
        "of the moment of the girders that take part, of concrete in sagging; yield stress times "
        "plastic modulus, of concrete the moment at which it crushes",
        usual=(1e2, 1e9),
        likely=("kN.m",),
    )
    deflection: DeflectionLimit | None = field(
        'of the deflection at midspan, as a length or as a part of the span: "span/300"',
        unit="m",
        usual=(1e-4, 2.0),
        likely=("mm", "cm"),
    )
    pile_set: Length | None = field("of the set of a pile", usual=(1e-5, 1.0), likely=("mm", "cm"))
    penetration: Length | None = field(
        "of the penetration; the thickness", usual=(1e-2, 10.0), likely=("cm", "mm")
    )

    def deflection_of(self, span: float) -> float | None:
        """Return the limit of the deflection (m) of a roof with this span (m), if there is one."""
        if isinstance(self.deflection, str):
            return span / float(self.deflection.partition("/")[2])
        return self.deflection


class Numerics(Data):
    """How it is computed; what is left out follows from the rest."""

    disc_radius: Length | None = field(
        "mean radius of the sand discs", usual=(1e-3, 0.5), likely=("cm", "mm")
    )
    elements: Annotated[int, Field(ge=3, le=2000, strict=True)] | None = field(
        "number of beam elements, best an odd one"
    )
    clearance: Length | None = field(
        "way of the rock before it strikes", usual=(1e-3, 10.0), likely=("cm", "mm")
    )
    stop_time: Duration | None = field("end of the run", usual=(1e-3, 60.0), likely=("ms",))
    exchange_step: Duration | None = field(
        "time between two exchanges", usual=(1e-7, 1e-2), likely=("ms",)
    )
    coupling: Literal["impulse", "implicit"] = field(
        "scheme of exchange; implicit repeats each exchange until all values fit together",
        "impulse",
    )
    output_interval: Duration | None = field(
        "time between two rows of the results", usual=(1e-6, 1.0), likely=("ms",)
    )
    seed: Annotated[int, Field(ge=0, le=MOST_SEED, strict=True)] = field(
        "number of the packing of the sand", 1
    )


class ShedProject(Data):
    """A rock shed, from the rock to what it stands on."""

    name: str = field("name of the results", "")
    description: str = field("description; made of the values", "")
    rock: StrikingRock | None = field("the rock; or slope")
    slope: SlopeAbove | None = field("the slope that it comes from; or rock")
    cushion: Cushion = field("the cushion", ...)
    material: dict[str, SandMaterial] = field("own materials by name", {})
    roof: Roof = field("the roof", ...)
    supports: Supports = field("the supports", Supports())
    criteria: Criteria = field("limits", Criteria())
    numerics: Numerics = field("how it is computed", Numerics())
