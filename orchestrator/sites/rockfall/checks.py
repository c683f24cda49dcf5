"""Faults of a slope that its form does not show."""

from collections.abc import Iterator, Sequence

from rockshed.components.slope_rockfall.records import ROCK

from ...core.errors import Problem
from ...core.input_text import shown
from ...core.results.metric import identifier
from ...core.system.names import nearest
from ...input_files.form import if_formed, told_if_formed
from ...input_files.places import Key, Places
from .profile import Node
from .rocks import middle_rock, rock_problems, start_range
from .site import Barrier, Line, SlopeSite

MODEL = {
    "gravity": "gravity",
    "truncation": "truncation",
    "area_factor": "area_factor",
    "tilt_cap": "tilt_cap",
    "restitution_gravity": "restitution.gravity",
    "tilt_meaning": "tilt.meaning",
}
"""Keys of the section [model], and the parameters of the component that they set."""


RESERVED = "largest"
"""Name that no line can have: columns of the table of the trials begin with it."""


def site_problems(site: SlopeSite, nodes: Sequence[Node], where: Places) -> Iterator[Problem]:
    """Yield what is wrong with a slope, as far as its form is right.

    Parameters
    ----------
    site : SlopeSite
        Data of the slope.
    nodes : sequence of Node
        Of its profile, as far as they could be read.
    where : Places
        Of the values of the site.

    Yields
    ------
    Problem
        Faults of rock, model, search lines, barriers, and places that are off the profile.
    """
    yield from told_if_formed(rock_problems, site, nodes, where)
    for check in (_model_problems, _name_problems):
        yield from told_if_formed(check, site, where)
    for i, line in enumerate(if_formed(getattr, site, "line") or ()):
        yield from told_if_formed(_line_problems, line, ("line", i), where)
    for i, barrier in enumerate(if_formed(getattr, site, "barrier") or ()):
        yield from told_if_formed(_barrier_problems, site, i, barrier, where)
    if len(nodes) > 1:
        yield from told_if_formed(_range_problems, site, nodes, where)


def _barrier_problems(
    site: SlopeSite, i: int, barrier: Barrier, where: Places
) -> Iterator[Problem]:
    if reach(barrier, site) <= 0.0:
        text = (
            f"height = {barrier.height:g} m is not above its free border, "
            f"{free_border(barrier, site):g} m: it would hold no rock"
        )
        remedy = "raise height, or set free_border (by default the rock's radius)"
        yield Problem(where.of(("barrier", i)), text, remedy)


def _model_problems(site: SlopeSite, where: Places) -> Iterator[Problem]:
    for name in (name for name in site.model if name not in MODEL):
        text = f"model.{name}: there is no such key"
        yield Problem(where.of(("model", name)), text, nearest(name, MODEL))


def _name_problems(site: SlopeSite, where: Places) -> Iterator[Problem]:
    names: list[tuple[str, Key]] = [
        *((line.name, ("line", i, "name")) for i, line in enumerate(site.line)),
        *((barrier.name, ("barrier", i, "name")) for i, barrier in enumerate(site.barrier)),
    ]
    for name, key in names:
        if name == RESERVED:
            text = f"{name!r} is the name of columns of the results"
            yield Problem(where.of(key), text, "call it something else")
        alike = [other for other, _ in names if identifier(other) == identifier(name)]
        if len(alike) > 1:
            text = f"several lines or barriers are called {shown(name)}"
            if len(set(alike)) > 1:
                text = f"{', '.join(map(shown, alike))} are one name in the results"
            yield Problem(where.of(key), text, "give each a name of its own")


def _line_problems(line: Line, key: Key, where: Places) -> Iterator[Problem]:
    if (line.points is None) == (line.x is None):
        text = "a search line has two points, or an x from which it goes up"
        yield Problem(where.of(key), text, "give one of them")
    elif line.points is not None and line.points[0] == line.points[1]:
        place = where.of((*key, "points"))
        yield Problem(place, "both points are the same", "give two points")


def _range_problems(site: SlopeSite, nodes: Sequence[Node], where: Places) -> Iterator[Problem]:
    """Yield the places that are off the profile."""
    left = nodes[0].x
    right = nodes[-1].x
    end = site.profile.end
    for key, x in _places_along(site):
        if not left <= x <= right:
            text = f"x = {x:g} m is beside the profile"
            yield Problem(where.of(key), text, f"give an x from {left:g} to {right:g} m")
    starts = max((x for _, x in start_range(site)), default=left)
    if end is not None and end <= starts <= right:
        text = f"the trial ends at {end:g} m, and the rock starts at {starts:g} m"
        yield Problem(where.of(("profile", "end")), text, "let it end farther to the right")


def _places_along(site: SlopeSite) -> Iterator[tuple[Key, float]]:
    """Yield key and value of every x (m) that must lie on the profile."""
    for i, barrier in enumerate(site.barrier):
        yield ("barrier", i, "x"), barrier.x
    for i, line in enumerate(site.line):
        if line.x is not None:
            yield ("line", i, "x"), line.x
    if site.profile.end is not None:
        yield ("profile", "end"), site.profile.end


def free_border(barrier: Barrier, site: SlopeSite) -> float:
    """Return the height below a barrier's upper edge in which it does not hold a rock.

    Parameters
    ----------
    barrier : Barrier
        Of the site.
    site : SlopeSite
        With the rock, whose radius, or the middle one, is the default.

    Returns
    -------
    float
        Height (m), for the rock's centre.
    """
    return radius_of(site) if barrier.free_border is None else barrier.free_border


def radius_of(site: SlopeSite) -> float:
    """Return the radius (m) of the rock, or that in the middle of its distribution.

    Parameters
    ----------
    site : SlopeSite
        With the rock; of one with faults, a number is returned nevertheless.

    Returns
    -------
    float
        Radius (m).
    """
    middle = middle_rock(site)
    return 0.0 if middle is None else float(middle[ROCK.radius])


def reach(barrier: Barrier, site: SlopeSite) -> float:
    """Return the height up to which a barrier holds a rock.

    Parameters
    ----------
    barrier : Barrier
        Of the site.
    site : SlopeSite
        With the rock.

    Returns
    -------
    float
        Height (m) of the rock's centre above the barrier's foot.
    """
    return barrier.height - free_border(barrier, site)
