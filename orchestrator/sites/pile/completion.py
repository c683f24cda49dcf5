"""From the file of a pile to its design: tables of hammers and cushions, sections, ground."""

import math
from collections.abc import Iterator

from ...core.errors import Problem
from ...input_files.form import if_formed, told_if_formed
from ...input_files.places import Key, Places
from .design import Friction, PileDesign, RodSection
from .ground import WATER, GroundProfile
from .hammers import ram, spring
from .site import Ground, NamedSoil, PileParts, PileSite, Section, ToeSoil

_NEAR = 1e-9
"""Part by which two lengths may differ that are meant to be equal."""


def completed(site: PileSite, where: Places, problems: list[Problem]) -> PileDesign | None:
    """Return a pile with everything that follows from its file.

    Parameters
    ----------
    site : PileSite
        Of the right form.
    where : Places
        Of its values.
    problems : list of Problem
        What is missing or contradictory is appended, all of it.

    Returns
    -------
    PileDesign or None
        None where a value is missing.
    """
    found: list[Problem] = []
    hammer = if_formed(lambda: ram(site.hammer, where, found))
    cushion = if_formed(lambda: spring(site.cushion, "cushion", where, found))
    pile_cushion = if_formed(lambda: spring(site.pile_cushion, "pile_cushion", where, found))
    given = if_formed(getattr, site, "rod") or ()
    rod = [if_formed(_section, section, i, where, found) for i, section in enumerate(given)]
    found += told_if_formed(_train_problems, site, where)
    known = [section for section in rod if section]
    found += told_if_formed(_length_problems, site, where)
    toe, friction = if_formed(_soil, site, known, where, found) or (None, [])
    problems += found
    if problems or hammer is None or toe is None:
        return None
    parts = {name: getattr(site, name) for name in PileParts.model_fields}
    return PileDesign(
        **parts,
        hammer=hammer,
        cushion=cushion,
        helmet=site.helmet.mass if site.helmet else 0.0,
        pile_cushion=pile_cushion,
        rod=known,
        toe=toe,
        friction=friction,
        ground=site.ground,
        soil=site.soil,
    )


def _train_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    """Yield the parts between ram and head that cannot stand without another."""
    if site.pile_cushion is not None and site.helmet is None:
        text = "a cushion on the head has no helmet above it"
        yield Problem(where.of(("pile_cushion",)), text, "give helmet.mass")
    if site.helmet is not None and site.cushion is None:
        text = "the ram would strike the helmet without a cushion"
        yield Problem(where.of(("helmet",)), text, "give a cushion: its stiffness, or a material")
    if (site.hammer.kind == "diesel" or site.hammer.anvil) and site.cushion is None:
        text = "a diesel hammer has no cushion"
        yield Problem(where.of(("hammer",)), text, "give a cushion: its stiffness, or a material")


def _length_problems(site: PileSite, where: Places) -> Iterator[Problem]:
    """Yield rods and soils of which no blows on rods of several lengths can be made."""
    if site.spt is None:
        return
    if len(site.rod) > 1:
        text = f"the rod has {len(site.rod)} sections, and one is lengthened"
        yield Problem(where.of(("spt",)), text, "give one [[rod]]")
    if site.ground is not None or site.shaft:
        text = "a rod of another length has other soil along its shaft"
        yield Problem(where.of(("spt",)), text, "give the soil as [toe] alone")


def _section(
    given: Section, number: int, where: Places, problems: list[Problem]
) -> RodSection | None:
    """Return a section of the rod with its area, perimeter and outline."""
    shapes = [name for name in ("area", "diameter", "width") if getattr(given, name) is not None]
    place = where.of(("rod", number))
    if len(shapes) != 1:
        named = " and ".join(shapes) if shapes else "no area"
        text = f"rod[{number + 1}] has {named}"
        problems.append(Problem(place, text, "give one of area, diameter (with wall) and width"))
        return None
    if given.wall is not None and (given.diameter is None or 2.0 * given.wall >= given.diameter):
        text = f"a wall of {given.wall:g} m does not fit into the section"
        remedy = "give the diameter of the pipe, more than twice its wall"
        problems.append(Problem(where.of(("rod", number, "wall")), text, remedy))
        return None
    outline, perimeter = _outline(given)
    area = given.area if given.area is not None else _area(given, outline)
    return RodSection(
        length=given.length,
        area=area,
        modulus=given.modulus,
        density=given.density,
        perimeter=given.perimeter or perimeter,
        outline=outline,
    )


def _outline(given: Section) -> tuple[float | None, float | None]:
    """Return area and length of the outline of a section (m2, m); None where they are not known."""
    if given.diameter is not None:
        return 0.25 * math.pi * given.diameter**2, math.pi * given.diameter
    if given.width is not None:
        return given.width**2, 4.0 * given.width
    return None, None


def _area(given: Section, outline: float | None) -> float:
    hollow = 0.0
    if given.diameter is not None and given.wall is not None:
        hollow = 0.25 * math.pi * (given.diameter - 2.0 * given.wall) ** 2
    return (outline or 0.0) - hollow


def _soil(
    site: PileSite, rod: list[RodSection], where: Places, problems: list[Problem]
) -> tuple[ToeSoil | None, list[Friction]]:
    """Return the soil under the toe and the friction along the rod, that of ground in layers."""
    if site.ground is None:
        if site.toe is None:
            text = "there is no soil: neither toe nor ground is given"
            problems.append(Problem(where.of(()), text, "give [toe], or [ground] and its soils"))
        if site.drivability is not None:
            text = "the soil at other penetrations is not known"
            remedy = "give [ground] and its soils in the place of [toe] and [[shaft]]"
            problems.append(Problem(where.of(("drivability",)), text, remedy))
        for name in site.soil:
            text = f"the soil {name} is in no layer: its friction never resists"
            remedy = "name it in ground.layers, or leave it out"
            problems.append(Problem(where.of(("soil", name)), text, remedy))
        return site.toe, []
    for key in [name for name in ("toe", "shaft") if getattr(site, name)]:
        text = f"the soil is given twice, as ground and as {key}"
        problems.append(Problem(where.of((key,)), text, "leave one of the two out"))
    found = told_if_formed(_ground_problems, site, site.ground, where)
    if not found and len(rod) == len(site.rod):
        found += told_if_formed(_pile_problems, site, site.ground, rod, where)
    problems += found
    if problems or len(rod) < len(site.rod):  # what is refused of a section is told already
        return None, []
    profile = GroundProfile(site.ground, site.soil)
    penetration = site.ground.penetration
    area = bearing_area(site.ground, rod) or 0.0
    return profile.toe(penetration, area), profile.friction(penetration, rod)


def bearing_area(ground: Ground, rod: list[RodSection]) -> float | None:
    """Return the area (m2) on which a toe bears; None where it is not known.

    Parameters
    ----------
    ground : Ground
        Which may give it.
    rod : list of RodSection
        Whose last section has it, if it is solid.

    Returns
    -------
    float or None
    """
    if ground.toe_area is not None:
        return ground.toe_area
    last = rod[-1]
    is_solid = last.outline is not None and math.isclose(last.outline, last.area, rel_tol=_NEAR)
    return last.outline if is_solid else None


def _ground_problems(site: PileSite, ground: Ground, where: Places) -> Iterator[Problem]:
    """Yield the faults of layers and soils."""
    above = 0.0
    for i, layer in enumerate(ground.layers):
        key: Key = ("ground", "layers", i)
        if layer.soil not in site.soil:
            text = f"there is no soil {layer.soil!r}"
            known = f"give [soil.{layer.soil!r}], or one of {', '.join(site.soil) or 'none'}"
            yield Problem(where.of((*key, "soil")), text, known)
        if layer.bottom <= above:
            text = f"the layer ends at {layer.bottom:g} m, and the one above at {above:g} m"
            yield Problem(where.of((*key, "to")), text, "let it end deeper")
        above = layer.bottom
    used = {layer.soil for layer in ground.layers}
    for name in site.soil.keys() - used:
        text = f"the soil {name} is in no layer: its friction never resists"
        remedy = "name it in ground.layers, or leave it out"
        yield Problem(where.of(("soil", name)), text, remedy)
    by_stress = any(
        soil.beta is not None or soil.toe_factor is not None for soil in site.soil.values()
    )
    for name, soil in site.soil.items():
        yield from _soil_problems(name, soil, by_stress, ground.water is not None, where)


def _soil_problems(
    name: str, soil: NamedSoil, by_stress: bool, is_wet: bool, where: Places
) -> Iterator[Problem]:
    """Yield the faults of one soil."""
    key: Key = ("soil", name)
    linear = soil.friction is not None or soil.friction_growth is not None
    if soil.beta is not None and linear:
        text = f"the friction of {name} is given twice, by beta and in Pa"
        yield Problem(where.of((*key, "beta")), text, "leave one of the two out")
    if soil.beta is None and not linear:
        for part in ("friction_limit", "driving"):
            if part in soil.model_fields_set:
                text = f"{part} belongs to a friction that {name} does not have: it never resists"
                remedy = "give friction, friction_growth or beta, or leave it out"
                yield Problem(where.of((*key, part)), text, remedy)
    if soil.toe is not None and soil.toe_factor is not None:
        text = f"the resistance under a toe in {name} is given twice, by toe and toe_factor"
        yield Problem(where.of((*key, "toe")), text, "leave one of the two out")
    if by_stress and soil.density is None:
        text = f"{name} has no density, and beta or toe_factor need the stress in the ground"
        yield Problem(where.of(key), text, "give its density")
    if by_stress and is_wet and soil.density is not None and soil.density <= WATER:
        text = f"{name} would float: {soil.density:g} kg/m3 with its water"
        yield Problem(where.of((*key, "density")), text, f"give more than {WATER:g} kg/m3")


def _pile_problems(
    site: PileSite, ground: Ground, rod: list[RodSection], where: Places
) -> Iterator[Problem]:
    """Yield penetrations that rod and ground do not allow, and missing perimeters and areas."""
    length = sum(section.length for section in rod)
    asked: list[tuple[float, Key]] = [(ground.penetration, ("ground", "penetration"))]
    if site.drivability is not None:
        depths = enumerate(site.drivability.penetrations)
        asked += [(depth, ("drivability", "penetrations", i)) for i, depth in depths]
    profile = GroundProfile(ground, site.soil)
    deepest = ground.layers[-1].bottom
    for depth, key in asked:
        if depth > length * (1.0 + _NEAR):
            text = f"the toe at {depth:g} m takes a longer rod than {length:g} m"
            yield Problem(where.of(key), text, "lengthen the rod, or give less")
        elif depth > deepest * (1.0 + _NEAR):
            text = f"the ground is known down to {deepest:g} m only, and the toe is at {depth:g} m"
            yield Problem(where.of(key), text, "add a layer, or give less")
        else:
            name, soil = profile.soil_at(depth)
            if soil.toe is None and soil.toe_factor is None:
                text = f"the toe at {depth:g} m stands in {name}, which has no resistance under it"
                yield Problem(where.of(key), text, f"give soil.{name}.toe or toe_factor")
    if bearing_area(ground, rod) is None:
        text = f"the area on which the toe bears is not known: {_areas(rod[-1])}"
        yield Problem(where.of(("ground",)), text, "give ground.toe_area")
    if next(profile.pieces(), None) is None:
        return
    deepest_asked = max(depth for depth, _ in asked)
    end = length
    for i in reversed(range(len(rod))):
        if end > length - deepest_asked and rod[i].perimeter is None:
            text = f"rod[{i + 1}] stands in ground with friction and has no perimeter"
            yield Problem(where.of(("rod", i)), text, "give perimeter, or diameter or width")
        end -= rod[i].length


def _areas(section: RodSection) -> str:
    """Return in words the areas that a toe may bear on."""
    if section.outline is None:
        return f"the steel or concrete of its section has {section.area:.4g} m2"
    return f"an open pipe has {section.area:.4g} m2, a closed one {section.outline:.4g} m2"
