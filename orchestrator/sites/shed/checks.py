"""Faults of a shed whose parts do not fit together, each with the field of the project."""

from collections.abc import Iterator

from rockshed.components.common.units import kN, mm, standard_gravity
from rockshed.components.sand_cushion.declarations import SIZES
from rockshed.components.sand_cushion.models import SPREAD

from ...core.errors import Problem
from ...input_files.form import told_if_formed
from ...input_files.places import Key, Places
from .foundation import MOST_SEGMENTS
from .geometry import DISCS_IN_RADIUS, DISCS_IN_THICKNESS, ShedLayout, line_mass
from .site import ShedProject

_FIT = 1e-9
"""Part by which a length may be exceeded by rounding."""
MOST_DISCS = 10_000
"""Sand discs that follow from a project without being asked for, at most; usual are some 600."""
FEWEST_LAYERS = 4.0
"""Disc diameters in the thickness, at least."""


def fit_problems(project: ShedProject, found: ShedLayout, where: Places) -> Iterator[Problem]:
    """Yield what does not fit in a shed.

    Parameters
    ----------
    project : ShedProject
        The project.
    found : ShedLayout
        Its numbers.
    where : Places
        Of the values of the project.

    Yields
    ------
    Problem
        With the field of the project that is at fault.
    """
    yield from _width_problems(project, found, where)
    yield from _criteria_problems(project, where)
    yield from _size_problems(found, where)
    yield from _disc_problems(found, where)
    yield from _number_problems(project, found, where)
    if found.arrival is None:
        yield from _place_problems(found, where)
        yield from _start_problems(found, where)
    yield from _time_problems(found, where)
    yield from _rod_problems(found, where)


def _at(where: Places, key: Key, text: str, remedy: str) -> Problem:
    return Problem(where.of(key), f"{'.'.join(map(str, key))}: {text}", remedy)


def _width_problems(project: ShedProject, found: ShedLayout, where: Places) -> Iterator[Problem]:
    """Yield a cushion that is wider than the roof, and more girders than there are."""
    cushion, roof = found.cushion, found.roof
    if cushion.width > roof.span * (1.0 + _FIT):
        text = f"{cushion.width:g} m is beyond the roof, whose span is {roof.span:g} m"
        yield _at(where, ("cushion", "width"), text, "reduce it, or raise roof.span")
    if project.roof.number is not None and found.girders > project.roof.number * (1.0 + _FIT):
        text = (
            f"{cushion.effective_width:.4g} m take {found.girders:.3g} girders, and the roof has "
            f"{project.roof.number}"
        )
        yield _at(where, ("cushion", "effective_width"), text, "reduce it, or raise roof.number")


def _criteria_problems(project: ShedProject, where: Places) -> Iterator[Problem]:
    """Yield a limit of the stress of concrete that cracks."""
    cracks = project.roof.concrete is not None and project.roof.bending == "yielding"
    if cracks and project.criteria.stress is not None:
        text = "a strip that cracks has no stress M/W"
        yield _at(where, ("criteria", "stress"), text, "limit plastic_moment or deflection")


def _size_problems(found: ShedLayout, where: Places) -> Iterator[Problem]:
    """Yield a rock that is larger than the cushion."""
    if 2.0 * found.rock.radius >= found.cushion.width:
        size = 2.0 * found.rock.radius
        text = f"a rock of {size:.4g} m does not fit on it, {found.cushion.width:g} m wide"
        yield _at(where, ("cushion", "width"), text, "widen it")


def _place_problems(found: ShedLayout, where: Places) -> Iterator[Problem]:
    """Yield a rock that is not above the cushion when it starts or strikes."""
    left = found.box_left
    right = left + found.cushion.width
    radius = found.rock.radius
    if 2.0 * radius >= found.cushion.width:
        return
    for x, key, what in (
        (found.rock.place, ("rock", "place"), "strikes"),
        (found.start_x, ("rock", "angle"), "starts"),
    ):
        if not left + radius < x < right - radius:
            text = (
                f"the rock {what} at x = {x:.4g} m with a radius of {radius:.4g} m, and the "
                f"cushion lies from {left:.4g} to {right:.4g} m"
            )
            yield _at(where, key, text, "move it, or widen the cushion")
            return


def _disc_problems(found: ShedLayout, where: Places) -> Iterator[Problem]:
    """Yield sand discs that are too many or too large."""
    key = ("numerics", "disc_radius")
    most = SIZES["discs"].maximum
    if found.discs > most:
        text = f"{found.disc_radius:g} m makes {found.discs:,} discs, and {most:,} are the most"
        yield _at(where, key, text, "raise it, or reduce cushion.width")
    if found.cushion.thickness < FEWEST_LAYERS * 2.0 * found.disc_radius * (1.0 - _FIT):
        text = (
            f"{found.disc_radius:g} m leaves fewer than {FEWEST_LAYERS:g} layers in the thickness "
            f"of {found.cushion.thickness:g} m"
        )
        yield _at(where, key, text, "reduce it")
    widest = 2.0 * found.disc_radius * (1.0 + SPREAD)
    if widest > found.rock.radius:
        text = f"discs of up to {widest:.4g} m are no sand to a rock of {found.rock.radius:.4g} m"
        yield _at(where, key, text, "reduce it")


def _number_problems(project: ShedProject, found: ShedLayout, where: Places) -> Iterator[Problem]:
    """Yield derived discs that are so many that a value without its unit is likely."""
    if project.numerics.disc_radius is not None or found.discs <= MOST_DISCS:
        return
    by_rock = (
        found.rock.radius / DISCS_IN_RADIUS < 0.5 * found.cushion.thickness / DISCS_IN_THICKNESS
    )
    rock: Key = ("slope", "file")
    if project.rock is not None:
        rock = ("rock", "size" if project.rock.mass is None else "mass")
    text = (
        f"a rock of {found.rock.mass:.4g} kg and {2.0 * found.rock.radius:.3g} m on a cushion of "
        f"{found.cushion.thickness:.3g} m times {found.cushion.width:.3g} m makes {found.discs:,} "
        f"sand discs of {2.0 * found.disc_radius / mm:.3g} mm; {MOST_DISCS:,} are the most that "
        "are taken unasked"
    )
    remedy = "is a unit missing? else give numerics.disc_radius, or a smaller cushion.width"
    yield _at(where, rock if by_rock else ("cushion", "thickness"), text, remedy)


def _start_problems(found: ShedLayout, where: Places) -> Iterator[Problem]:
    """Yield a rock that is slower than the clearance alone makes it."""
    if found.start_velocity_y < 0.0:
        return
    height = found.rock.velocity_y**2 / (2.0 * standard_gravity)
    text = (
        f"the rock starts {found.clearance:.4g} m above the surface, and its speed is that of a "
        f"fall of {height:.4g} m"
    )
    remedy = "give a smaller one or smaller discs (numerics.disc_radius), or a larger drop_height"
    yield _at(where, ("numerics", "clearance"), text, remedy)


def _time_problems(found: ShedLayout, where: Places) -> Iterator[Problem]:
    if found.stop_time <= found.exchange_step:
        text = f"{found.stop_time:g} s is not above the exchange step, {found.exchange_step:g} s"
        yield _at(where, ("numerics", "stop_time"), text, "raise it")


def _rod_problems(found: ShedLayout, where: Places) -> Iterator[Problem]:
    """Yield piles that cannot be computed in steps of this length, or do not bear the roof."""
    rod = found.rod
    if rod is None:
        return
    if rod.segments > MOST_SEGMENTS:
        text = (
            f"the pile has {rod.segments:.6g} segments of an exchange step, and {MOST_SEGMENTS:,} "
            "are most"
        )
        yield _at(where, ("numerics", "elements"), text, "reduce them: the exchange step rises")
    mass = found.roof.span * line_mass(found.cushion, found.roof, found.girders)
    load = rod.weight + 0.5 * standard_gravity * mass
    if load >= rod.toe_resistance:
        text = (
            f"its toe bears {rod.toe_resistance / kN:.4g} kN, and roof, sand and pile weigh "
            f"{load / kN:.4g} kN: at rest the toe carries all of it"
        )
        yield _at(where, ("supports", "file"), text, "give the toe more resistance")


def rock_source_problems(project: ShedProject, where: Places) -> Iterator[Problem]:
    """Yield a project that has no rock, or two of them.

    Parameters
    ----------
    project : ShedProject
        The project.
    where : Places
        Of the values of the project.

    Yields
    ------
    Problem
    """
    if project.slope is None:
        if project.rock is None:
            text = "rock: is missing, or slope, the one that it comes from"
            yield Problem(where.of(()), text, "give one of the two tables")
        return
    if project.rock is not None:
        for key in sorted(project.rock.model_fields_set) or [""]:
            name = f"rock.{key}".rstrip(".")
            text = f"{name}: the rock comes from the slope"
            remedy = "leave [rock] out, or [slope]; its rock is described in the slope's file"
            yield Problem(where.of(("rock", key) if key else ("rock",)), text, remedy)
    for key in ("percentile", "quantity"):
        if project.slope.trial is not None and getattr(project.slope, key) is not None:
            text = "a trial is chosen already by its number"
            yield _at(where, ("slope", key), text, "leave it out, or slope.trial")
    if project.numerics.clearance is not None:
        text = "a rock from a slope starts where the campaign has it"
        yield _at(where, ("numerics", "clearance"), text, "leave it out")


def support_problems(project: ShedProject, where: Places) -> Iterator[Problem]:
    """Yield what is wrong with the supports.

    Parameters
    ----------
    project : ShedProject
        The project.
    where : Places
        Of the values of the project.

    Yields
    ------
    Problem
    """
    for kind, key in (("elastic", "stiffness"), ("piles", "file")):
        yield from told_if_formed(_support_problems, project, kind, key, where)


def _support_problems(
    project: ShedProject, kind: str, key: str, where: Places
) -> Iterator[Problem]:
    """Yield a field that a kind of support needs, and one that belongs to another."""
    supports = project.supports
    given = getattr(supports, key) is not None
    if given and supports.kind != kind:
        text = f"is for {kind} supports, and kind is {supports.kind}"
        yield _at(where, ("supports", key), text, "leave one of both out")
    if not given and supports.kind == kind:
        yield _at(where, ("supports",), f"{key} is missing", f"{kind} supports need it")
