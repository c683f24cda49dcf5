"""Rock, cushion and roof of a project with all their values, and what is wrong with them."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

from rockshed.components.common.units import standard_gravity

from ...core.errors import InputRefused, Problem
from ...core.system.names import nearest
from ...core.system.quantities import in_si
from ...input_files.form import if_formed, read_toml
from ...input_files.places import Key, Places
from ..pile.design import PileDesign
from ..pile.preparation import prepare as prepare_pile
from .effective_width import ON_A_SLAB, ON_GIRDERS, RULES, Spread
from .geometry import CushionPart, RockPart, RoofPart
from .materials import DEFAULT_MATERIAL, sands, shipped_sands
from .reinforced_concrete import Bars, Concrete, Strip, StripError, strip_corners
from .sections import section
from .site import ConcreteStrip, Roof, ShedProject, StrikingRock
from .steels import DEFAULT_STEEL, Steel, steels
from .yielding import Corners, SteelSection, steel_corners

ROCK_DENSITY = 2600.0
"""Density (kg/m3) of a rock whose own is not given: common rock."""
CONCRETE_DENSITY = 2500.0
"""Density (kg/m3) of reinforced concrete."""
_TOLERANCE = 0.02
"""Part by which two values of one thing may differ."""
MOST_PLASTIC = 2.0
"""Plastic / elastic section modulus at most: of a rhombus; I-sections have 1.15, rectangles 1.5."""
_STEEPEST = math.radians(85.0)
_ENDS = {"fixed": "fixed", "elastic": "elastic"}
"""Ends of the beam by the kind of supports; of all others they are simple."""


def rock_part(project: ShedProject, where: Places, problems: list[Problem]) -> RockPart | None:
    """Return the rock of a project.

    Parameters
    ----------
    project : ShedProject
        The project.
    where : Places
        Of its values.
    problems : list of Problem
        Contradictions, and what is missing, are appended.

    Returns
    -------
    RockPart or None
        None where it is not known.
    """
    rock = project.rock
    if rock is None:
        return None
    body = if_formed(_body, rock, where, problems)
    speed = if_formed(_speed, rock, where, problems)
    angle = if_formed(_angle, rock, where, problems)
    if body is None or speed is None or angle is None:
        return None
    mass, radius, density = body
    return RockPart(
        mass,
        radius,
        density,
        speed * math.sin(angle),
        speed * math.cos(angle),
        rock.spin,
        0.5 * project.roof.span if rock.place is None else rock.place,
    )


def _angle(rock: StrikingRock, where: Places, problems: list[Problem]) -> float | None:
    """Return the angle of the velocity from the vertical (rad)."""
    if abs(rock.angle) <= _STEEPEST:
        return rock.angle
    text = f"angle is {math.degrees(rock.angle):.4g} deg from the vertical: it does not strike"
    remedy = 'give at most 85 deg; a bare number is in rad, "15 deg" is written with its unit'
    problems.append(Problem(where.of(("rock", "angle")), text, remedy))
    return None


def _body(
    rock: StrikingRock, where: Places, problems: list[Problem]
) -> tuple[float, float, float] | None:
    """Return mass (kg), radius (m) and density (kg/m3) of the sphere."""
    if rock.mass is None and rock.size is None:
        problems.append(Problem(where.of(("rock",)), "rock: mass is missing", "or give its size"))
        return None
    volume = _volume(rock)
    if rock.mass is not None and volume is not None:
        density = rock.mass / volume
        if rock.density is not None and abs(density / rock.density - 1.0) > _TOLERANCE:
            text = (
                f"rock: mass {rock.mass:.5g} kg, size {rock.size:.4g} m and density "
                f"{rock.density:.5g} kg/m3 disagree: mass and size make {density:.5g} kg/m3"
            )
            problems.append(Problem(where.of(("rock", "size")), text, "leave one of them out"))
            return None
        mass = rock.mass
    else:
        density = rock.density or ROCK_DENSITY
        mass = density * volume if volume is not None else float(rock.mass or 0.0)
    return mass, (3.0 * mass / density / (4.0 * math.pi)) ** (1.0 / 3.0), density


def _volume(rock: StrikingRock) -> float | None:
    if rock.size is None:
        return None
    return rock.size**3 * (math.pi / 6.0 if rock.shape == "sphere" else 1.0)


def _speed(rock: StrikingRock, where: Places, problems: list[Problem]) -> float | None:
    """Return the speed at the surface (m/s)."""
    if (rock.drop_height is None) == (rock.velocity is None):
        text = "rock: drop_height and velocity are two ways to say one thing"
        if rock.velocity is None:
            text = "rock: neither drop_height nor velocity is given"
        key = ("rock", "velocity") if rock.velocity is not None else ("rock",)
        problems.append(Problem(where.of(key), text, "give one of the two"))
        return None
    if rock.drop_height is not None and rock.angle:
        text = "rock: a rock that falls from a height strikes vertically, and an angle is given"
        problems.append(
            Problem(where.of(("rock", "angle")), text, "give velocity and angle, or drop_height")
        )
    if rock.velocity is not None:
        return rock.velocity
    return math.sqrt(2.0 * standard_gravity * float(rock.drop_height or 0.0))


def roof_part(project: ShedProject, where: Places, problems: list[Problem]) -> RoofPart | None:
    """Return the roof of a project: a girder, or a metre of a slab.

    Parameters
    ----------
    project : ShedProject
        The project.
    where : Places
        Of its values.
    problems : list of Problem
        Unknown sections and steels, contradictions, and what is missing, are appended.

    Returns
    -------
    RoofPart or None
        None where it is not known.
    """
    roof = project.roof
    if roof.concrete is not None:
        return _concrete(project, where, problems)
    spacing = if_formed(_spacing, roof, where, problems)
    steel = if_formed(_steel, roof, where, problems)
    values = if_formed(_section_values, roof, where, problems)
    if steel is None or values is None or spacing is None:
        return None
    flange = values.pop("flange")
    stress = roof.yield_stress or steel.yield_at(flange)
    if stress is None:
        text = f"roof: {roof.steel or DEFAULT_STEEL} has no yield stress for {flange:g} m"
        problems.append(Problem(where.of(("roof", "steel")), text, "give yield_stress"))
        return None
    modulus = roof.elastic_modulus or steel.elastic_modulus
    return RoofPart(
        "girders",
        roof.section or "own section",
        **values,
        density=roof.mass / values["area"] if roof.mass else steel.density,
        elastic_modulus=modulus,
        yield_stress=stress,
        span=roof.span,
        spacing=spacing,
        deck_mass=roof.slab.thickness * roof.slab.density if roof.slab else 0.0,
        supports=_ENDS.get(project.supports.kind, "simple"),
        support_stiffness=project.supports.stiffness or 0.0,
        corners=_steel_corners(roof, values, modulus, stress),
    )


def _spacing(roof: Roof, where: Places, problems: list[Problem]) -> float | None:
    """Return the distance of the girders (m)."""
    if roof.spacing is None:
        text = "roof: spacing is missing"
        problems.append(Problem(where.of(("roof",)), text, "give the distance of the girders"))
    return roof.spacing


def _steel_corners(
    roof: Roof, values: Mapping[str, float], modulus: float, stress: float
) -> Corners | None:
    """Return the moment-curvature line of a girder that yields."""
    if roof.bending == "elastic":
        return None
    names = ("second_moment", "section_modulus", "plastic_modulus")
    second_moment, elastic, plastic = (values[name] for name in names)
    return steel_corners(SteelSection(modulus, second_moment, elastic, plastic, stress))


def _steel(roof: Roof, where: Places, problems: list[Problem]) -> Steel | None:
    name = roof.steel or DEFAULT_STEEL
    if name not in steels():
        text = f"roof: there is no steel {name!r}"
        remedy = f"{nearest(name, steels())}; or give yield_stress alone"
        problems.append(Problem(where.of(("roof", "steel")), text, remedy))
    return steels().get(name)


_OWN = ("area", "second_moment", "height")
"""Values that a section of one's own has."""
_MODULI = ("section_modulus", "plastic_modulus")
"""Values that it may have."""


def _section_values(roof: Roof, where: Places, problems: list[Problem]) -> dict[str, float] | None:
    """Return area, moments, height and flange thickness (m) of a girder."""
    if roof.section is not None:
        found = section(roof.section, where.of(("roof", "section")), problems)
        own = [key for key in (*_OWN, "section_modulus", "plastic_modulus") if getattr(roof, key)]
        if own:
            text = f"roof: section {roof.section!r} has its own {', '.join(own)}"
            remedy = "leave them out, or the section"
            problems.append(Problem(where.of(("roof", own[0])), text, remedy))
        if found is None:
            return None
        names = (*_OWN, "section_modulus", "plastic_modulus", "flange")
        return {name: getattr(found, name) for name in names}
    if missing := [key for key in _OWN if getattr(roof, key) is None]:
        text = f"roof: section is missing, or {', '.join(missing)} of one of your own"
        problems.append(Problem(where.of(("roof",)), text, 'section = "H-400x400x13x21" for one'))
        return None
    largest = 2.0 * float(roof.second_moment or 0.0) / float(roof.height or 1.0)
    modulus = roof.section_modulus or largest
    plastic = roof.plastic_modulus or modulus
    wrong = [*_modulus_problems(modulus, largest, plastic, where)]
    problems += wrong
    if wrong:
        return None
    return {
        **{name: float(getattr(roof, name)) for name in _OWN},
        "section_modulus": modulus,
        "plastic_modulus": plastic,
        "flange": 0.0,
    }


def _modulus_problems(
    modulus: float, largest: float, plastic: float, where: Places
) -> Iterator[Problem]:
    """Yield section moduli (m3) that no section has."""
    if modulus > largest * (1.0 + _TOLERANCE):
        text = (
            f"roof.section_modulus: {modulus:.4g} m3 is above 2 I / height, {largest:.4g} m3: no "
            "section has more"
        )
        place = where.of(("roof", "section_modulus"))
        yield Problem(place, text, "correct it, second_moment or height")
    shape = plastic / modulus
    if not 1.0 - _TOLERANCE <= shape <= MOST_PLASTIC:
        text = (
            f"roof.plastic_modulus: {plastic:.4g} m3 is {shape:.3g} times the elastic one, and "
            f"sections have 1 to {MOST_PLASTIC:g} times it"
        )
        place = where.of(("roof", "plastic_modulus"))
        yield Problem(place, text, "correct it, or leave it out")


def _concrete(project: ShedProject, where: Places, problems: list[Problem]) -> RoofPart | None:
    """Return a metre of a slab."""
    roof = project.roof
    girder = ("section", "steel", "spacing", "number", "slab", "yield_stress", "mass", *_MODULI)
    if given := [key for key in (*girder, *_OWN) if if_formed(getattr, roof, key) is not None]:
        text = f"roof: {', '.join(given)} belong to girders, and a slab of concrete is given"
        problems.append(Problem(where.of(("roof", given[0])), text, "leave one of both out"))
    corners = if_formed(_concrete_corners, roof, where, problems)
    if corners is None or roof.concrete is None:
        return None
    strip = roof.concrete
    return RoofPart(
        "concrete",
        f"concrete slab of {strip.thickness:g} m",
        area=strip.thickness,
        second_moment=strip.thickness**3 / 12.0,
        section_modulus=strip.thickness**2 / 6.0,
        plastic_modulus=corners.moments[-1] / strip.bar_yield_stress,
        height=strip.thickness,
        density=CONCRETE_DENSITY,
        elastic_modulus=_concrete_modulus(roof),
        yield_stress=strip.bar_yield_stress,
        span=roof.span,
        spacing=1.0,
        supports=_ENDS.get(project.supports.kind, "simple"),
        support_stiffness=project.supports.stiffness or 0.0,
        corners=None if roof.bending == "elastic" else corners,
        hogging_capacity=corners.hogging_moments[-1],
        cracking_moment=corners.moments[0],
    )


def _concrete_modulus(roof: Roof) -> float:
    """Return Young's modulus of the concrete (Pa), after EN 1992-1-1, table 3.1."""
    strength = roof.concrete.concrete_strength if roof.concrete else 0.0
    return roof.elastic_modulus or 22e9 * ((strength + 8e6) / 10e6) ** 0.3


def _concrete_corners(roof: Roof, where: Places, problems: list[Problem]) -> Corners | None:
    """Return cracking, yield and ultimate of a metre of a slab.

    Tensile strength after EN 1992-1-1, table 3.1: 0.3 f_ck^(2/3), in MPa.
    """
    strip = roof.concrete
    if strip is None:
        return None
    if strip.cover >= 0.5 * strip.thickness:
        text = "roof.concrete: cover is half of the thickness or more: the bars are not below"
        problems.append(Problem(where.of(("roof", "concrete", "cover")), text, "reduce it"))
        return None
    if not (upper := _upper_bars(strip, where, problems)):
        return None
    steel = _bar_area(strip.bar_diameter, strip.bar_spacing)
    tensile = 0.3e6 * (strip.concrete_strength / 1e6) ** (2.0 / 3.0)
    try:
        return strip_corners(
            Strip(1.0, strip.thickness, steel, strip.thickness - strip.cover, *upper),
            Concrete(strip.concrete_strength, tensile, _concrete_modulus(roof)),
            Bars(strip.bar_yield_stress),
        )
    except StripError as error:
        text = f"roof.concrete: {error}"
        remedy = "change diameter or spacing of the bars, or thickness"
        problems.append(Problem(where.of(("roof", "concrete")), text, remedy))
        return None


def _bar_area(diameter: float, spacing: float) -> float:
    """Return the area of bars in a metre (m2)."""
    return 0.25 * math.pi * diameter**2 / spacing


def _upper_bars(
    strip: ConcreteStrip, where: Places, problems: list[Problem]
) -> tuple[float, float] | None:
    """Return area (m2) and depth (m) of the bars above in a metre, 0 without any; None if wrong."""
    if strip.top_bar_diameter is None:
        for key in ("top_bar_spacing", "top_cover"):
            if getattr(strip, key) is not None:
                text = f"roof.concrete: {key} is given, and there are no bars above"
                place = where.of(("roof", "concrete", key))
                problems.append(Problem(place, text, "give top_bar_diameter, or leave it out"))
                return None
        return 0.0, 0.0
    depth = strip.top_cover or strip.cover
    if depth >= 0.5 * strip.thickness:
        text = "roof.concrete: top_cover is half of the thickness or more: the bars are not above"
        problems.append(Problem(where.of(("roof", "concrete", "top_cover")), text, "reduce it"))
        return None
    return _bar_area(strip.top_bar_diameter, strip.top_bar_spacing or strip.bar_spacing), depth


def pile_part(
    project: ShedProject, folder: Path, where: Places, problems: list[Problem]
) -> PileDesign | None:
    """Return the pile that stands under each end of each girder.

    Parameters
    ----------
    project : ShedProject
        The project.
    folder : Path
        From which the file of a pile counts.
    where : Places
        Of its values.
    problems : list of Problem
        What is wrong with a pile is appended.

    Returns
    -------
    PileDesign or None
        None where there are no piles, or the file is refused.
    """
    supports = project.supports
    if supports.kind != "piles" or supports.file is None:
        return None
    file = folder / supports.file
    try:
        read_toml(file)
    except InputRefused as refusal:
        remedy = "name a file that `rockshed pile` takes"
        place = where.of(("supports", "file"))
        problems += [Problem(place, f"supports.file: {each}", remedy) for each in refusal.problems]
        return None
    try:
        return prepare_pile(file).site
    except InputRefused as refusal:
        problems += refusal.problems
        return None


def cushion_part(
    project: ShedProject, rock: RockPart | None, where: Places, problems: list[Problem]
) -> CushionPart | None:
    """Return the cushion of a project.

    Parameters
    ----------
    project : ShedProject
        The project.
    rock : RockPart or None
        Its rock, where it is known.
    where : Places
        Of its values.
    problems : list of Problem
        Unknown materials and rules, contradictions, and what is missing, are appended.

    Returns
    -------
    CushionPart or None
        None where it is not known.
    """
    thickness = if_formed(thickness_of, project, where, problems)
    known = if_formed(lambda: sands(project.material, where, problems)) or {}
    name = if_formed(_material, project, where, problems)
    radius = rock.radius if rock else 0.0
    effective = if_formed(_effective_width, project, radius, thickness or 0.0, where, problems)
    if thickness is None or name not in known or effective is None or rock is None:
        return None
    width = project.cushion.width or project.roof.span
    return CushionPart(thickness, width, *effective, str(name), known[str(name)])


def thickness_of(project: ShedProject, where: Places, problems: list[Problem]) -> float | None:
    """Return the thickness of a cushion, of its layers too (m).

    Parameters
    ----------
    project : ShedProject
        The project.
    where : Places
        Of its values.
    problems : list of Problem
        What is missing, and contradictions, are appended.

    Returns
    -------
    float or None
        None where it is not known.
    """
    cushion = project.cushion
    if not cushion.layers:
        if cushion.thickness is None:
            text = "cushion: thickness is missing"
            problems.append(Problem(where.of(("cushion",)), text, "give it, or layers"))
        return cushion.thickness
    total = sum(layer.thickness for layer in cushion.layers)
    if cushion.thickness and abs(total / cushion.thickness - 1.0) > _TOLERANCE:
        text = f"cushion: the layers make {total:g} m, and thickness is {cushion.thickness:g} m"
        problems.append(Problem(where.of(("cushion", "thickness")), text, "leave it out"))
    return total


def _material(project: ShedProject, where: Places, problems: list[Problem]) -> str | None:
    """Return the name of the one material of a cushion."""
    cushion = project.cushion
    known = [*shipped_sands(), *project.material]
    named: list[tuple[str, Key]] = [
        (name, ("cushion", "layers", i))
        for i, layer in enumerate(cushion.layers)
        if (name := if_formed(getattr, layer, "material")) is not None
    ]
    if not cushion.layers:
        named = [(cushion.material or DEFAULT_MATERIAL, ("cushion", "material"))]
    elif cushion.material is not None:
        text = "cushion: the layers have materials, and material is given too"
        problems.append(Problem(where.of(("cushion", "material")), text, "leave one of them out"))
    for name, key in named:
        if name not in known:
            text = f"cushion: there is no material {name!r}"
            remedy = f"{nearest(name, known)}; or describe it as [material.{name!r}]"
            problems.append(Problem(where.of(key), text, remedy))
    names = list(dict.fromkeys(name for name, _ in named))
    if len(names) > 1:
        text = (
            f"cushion: {' on '.join(reversed(names))} cannot be computed: all of the sand has one "
            "set of parameters"
        )
        remedy = (
            "compute it once with each material alone, which bounds the result, or describe one "
            "material with the values of the layer that the rock reaches"
        )
        problems.append(Problem(where.of(("cushion", "layers")), text, remedy))
    return next((name for name in names if name in known), None)


def _effective_width(
    project: ShedProject, radius: float, thickness: float, where: Places, problems: list[Problem]
) -> tuple[float, str] | None:
    """Return the effective width (m) and its rule, which needs radius and thickness (m)."""
    given = project.cushion.effective_width
    place = where.of(("cushion", "effective_width"))
    if given is None:
        given = ON_A_SLAB if project.roof.concrete else ON_GIRDERS
    if isinstance(given, str) and given in RULES:
        width = RULES[given].width(Spread(radius, thickness, project.roof.spacing or 0.0))
        if width <= 0.0 and project.roof.concrete:
            text = f"cushion: the rule {given!r} is for girders, and the roof is a slab"
            problems.append(Problem(place, text, f"take {ON_A_SLAB!r}, or give a length"))
        return (width, given) if width > 0.0 else None
    try:
        width = in_si(given, "m") if isinstance(given, str) else float(given)
    except ValueError as error:
        text = f"cushion: effective_width is neither a rule nor a length: {error}"
        problems.append(Problem(place, text, f"rules: {nearest(str(given), RULES)}"))
        return None
    if width <= 0.0:
        problems.append(Problem(place, "cushion: effective_width must be above 0", "raise it"))
        return None
    return width, "given"
