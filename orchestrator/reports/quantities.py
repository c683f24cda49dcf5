"""Quantities of a project as a report names them: words, and the unit beside the number."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from rockshed.components.common.units import SCREEN_UNITS, cm2, cm3, cm4

from ..tables import digits

_SIZES = {**SCREEN_UNITS, "cm2": cm2, "cm3": cm3, "cm4": cm4, "GPa": 1e9, "mm/s": 1e-3}
"""Sizes in SI of the units that are not SI units themselves."""
_DIGITS = 4


@dataclass(frozen=True)
class ShownQuantity:
    """How a quantity is shown.

    Attributes
    ----------
    words : str
        Its name.
    unit : str
        In which it is shown; empty for a number, a name or a list of numbers without one.
    left_out_at_zero : bool
        Whether there is no such thing where it is 0.
    """

    words: str
    unit: str = ""
    left_out_at_zero: bool = False

    def has(self, value: object) -> bool:
        """Tell whether there is such a thing.

        Parameters
        ----------
        value : object
            Its value.
        """
        return value not in (None, "", [], ()) and not (self.left_out_at_zero and value == 0.0)

    def text(self, value: object) -> str:
        """Return a value in SI as it stands before its unit.

        Parameters
        ----------
        value : object
            Number, list of numbers or text.

        Returns
        -------
        str
            Numbers with four digits; whole ones all of theirs.
        """
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, int):
            return str(value)
        if isinstance(value, float):
            return digits(value / _SIZES.get(self.unit, 1.0), _DIGITS)
        if isinstance(value, Sequence) and not isinstance(value, str):
            return "; ".join(map(self.text, value))
        return str(value)


_Q = ShownQuantity
_GENERAL: Mapping[str, ShownQuantity] = {
    "mass": _Q("mass", "kg"),
    "radius": _Q("radius", "m"),
    "density": _Q("density", "kg/m3"),
    "speed": _Q("speed at the surface", "m/s"),
    "velocity_x": _Q("velocity at the surface, to the right", "m/s"),
    "velocity_y": _Q("velocity at the surface, downwards", "m/s"),
    "spin": _Q("angular velocity, counter-clockwise", "rad/s"),
    "place": _Q("x where it strikes", "m"),
    "drop_height": _Q("height of the fall", "m"),
    "thickness": _Q("thickness", "m"),
    "width": _Q("extent along the span", "m"),
    "effective_width": _Q("effective width", "m"),
    "rule": _Q("rule of the effective width"),
    "modulus": _Q("fictitious modulus E_bar", "MPa"),
    "solid_fraction": _Q("solid fraction in the plane"),
    "cohesion": _Q("cohesion", "kPa"),
    "friction_angle": _Q("angle of friction", "deg"),
    "section": _Q("section"),
    "area": _Q("area of a girder", "cm2"),
    "second_moment": _Q("second moment of area of a girder", "cm4"),
    "section_modulus": _Q("elastic section modulus of a girder", "cm3"),
    "plastic_modulus": _Q("plastic section modulus of a girder", "cm3"),
    "height": _Q("height of the section", "m"),
    "elastic_modulus": _Q("Young's modulus", "GPa"),
    "yield_stress": _Q("yield stress", "MPa"),
    "span": _Q("span", "m"),
    "spacing": _Q("distance of the girders", "m"),
    "deck_mass": _Q("mass of the slab on the girders, by area", "kg/m2", True),
    "girders": _Q("girders that take part"),
    "supports": _Q("supports of the beam"),
    "moments": _Q("bending moments of a girder at yield and plastic moment", "kN m"),
    "curvatures": _Q("curvatures there", "1/m"),
    "hardening_ratio": _Q("slope past the last corner / elastic slope"),
    "hogging_moments": _Q("the same with tension above", "kN m", True),
    "hogging_curvature": _Q("curvature at the last of these, in hogging", "1/m", True),
    "cracks": _Q("unloads towards the origin until the bars yield", "", True),
    "hogging_capacity": _Q("bending moment that a strip of 1 m bears in hogging", "kN m", True),
    "cracking_moment": _Q("bending moment that cracks a strip of 1 m", "kN m", True),
    "disc_radius": _Q("mean radius of the sand discs", "mm"),
    "discs": _Q("sand discs"),
    "elements": _Q("beam elements"),
    "box_left": _Q("x of the cushion's left end", "m"),
    "axis_y": _Q("y of the beam's axis; the roof's top is 0", "m"),
    "element": _Q("length of a beam element", "m"),
    "clearance": _Q("rock above the surface at the start", "m"),
    "start_x": _Q("x of the rock's centre at the start", "m"),
    "start_y": _Q("y of the rock's centre at the start", "m"),
    "start_velocity_y": _Q("velocity of the rock at the start, upwards", "m/s"),
    "exchange_step": _Q("exchange step", "ms"),
    "sand_step": _Q("internal step of the sand and the rock", "ms"),
    "beam_step": _Q("internal step of the beam", "ms"),
    "beam_damping": _Q("damping of the beam's stiffness", "ms"),
    "stop_time": _Q("end of the run", "ms"),
    "output_interval": _Q("time between two rows", "ms"),
    "state_interval": _Q("time between two recorded states", "ms"),
    "seed": _Q("number of the packing"),
    "stiffness": _Q("stiffness of a support", "kN/m"),
    "support_stiffness": _Q("stiffness of a support, by girder", "kN/m", True),
    "length": _Q("lengths of its sections", "m"),
    "segments": _Q("segments"),
    "weight": _Q("weight", "kN"),
    "shaft_resistance": _Q("resistance of the shaft, by segment", "kN"),
    "shaft_quake": _Q("quake of the shaft, by segment", "mm"),
    "shaft_damping": _Q("damping of the shaft, by segment", "s/m"),
    "toe_resistance": _Q("resistance of the toe", "kN"),
    "toe_quake": _Q("quake of the toe", "mm"),
    "toe_damping": _Q("damping of the toe", "s/m"),
}
"""By the last part of their names."""
_OF_RODS: Mapping[str, ShownQuantity] = {
    "area": _Q("areas of its sections", "cm2"),
    "modulus": _Q("Young's moduli of its sections", "GPa"),
    "density": _Q("densities of its sections", "kg/m3"),
}
_OF_SLABS: Mapping[str, ShownQuantity | None] = {
    "area": _Q("area of a strip of 1 m", "cm2"),
    "second_moment": _Q("second moment of area of a strip of 1 m, uncracked", "cm4"),
    "section_modulus": _Q("section modulus of a strip of 1 m, uncracked", "cm3"),
    "plastic_modulus": None,
    "elastic_modulus": _Q("Young's modulus of the concrete", "GPa"),
    "yield_stress": _Q("yield stress of the bars", "MPa"),
    "spacing": None,
    "deck_mass": None,
    "support_stiffness": _Q("stiffness of a support, by strip of 1 m", "kN/m", True),
    "girders": _Q("strips of 1 m that take part"),
    "moments": _Q("bending moments of a strip of 1 m at cracking, yield, crushing", "kN m"),
}
"""Those of a slab of concrete in the place of girders; None for what it does not have."""
_CRITERIA: Mapping[str, ShownQuantity] = {
    "stress": _Q("bending stress", "MPa"),
    "plastic moment": _Q("bending moment of all that takes part", "kN m"),
    "sagging moment": _Q("sagging moment of the whole strip", "kN m"),
    "hogging moment": _Q("hogging moment of the whole strip", "kN m"),
    "curvature": _Q("curvature / that at which the concrete crushes, or breaks without bars"),
    "deflection": _Q("deflection at midspan", "mm"),
    "pile set": _Q("set of a pile", "mm"),
    "penetration": _Q("penetration", "m"),
}


def quantity(name: str, roof: str) -> ShownQuantity | None:
    """Return how a quantity of a project is shown.

    Parameters
    ----------
    name : str
        With dots: ``roof.corners.moments``.
    roof : str
        Kind of the roof: ``girders`` or ``concrete``.

    Returns
    -------
    ShownQuantity or None
        With the parts of its name before it; None where a roof of this kind does not have it. Of
        an unknown name the name itself, its value in SI units.
    """
    before, _, last = name.rpartition(".")
    found: ShownQuantity | None = _GENERAL.get(last, ShownQuantity(last.replace("_", " ")))
    if before.partition(".")[0] == "rod":
        found = _OF_RODS.get(last, found)
    elif roof == "concrete":
        found = _OF_SLABS.get(last, found)
    if found is None:
        return None
    words = ": ".join(filter(None, [before.replace("_", " "), found.words]))
    return replace(found, words=words)


def criterion(name: str, unit: str) -> ShownQuantity:
    """Return how the limit of a criterion is shown.

    Parameters
    ----------
    name : str
        Of the criterion.
    unit : str
        SI unit of its limit, for one that is not known.
    """
    return _CRITERIA.get(name, ShownQuantity(name, "" if unit == "1" else unit.replace(".", " ")))
