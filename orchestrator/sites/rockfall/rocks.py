"""Rocks and starts that differ from trial to trial."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.records import ROCK

from ...core.errors import Problem
from ...input_files.chance import RandomQuantity
from ...input_files.places import Key, Places
from ...input_files.spreads import bounds, spread_faults, spread_problems, values_of
from .boulders import LONGEST, Boulder
from .profile import Node, surface
from .site import SlopeSite

_Floats = NDArray[np.float64]
DRAWN = (
    *("radius", "mass", "density", "elongation", "boulder", "place"),
    *("x", "y", "vx", "vy", "omega", "angle"),
)
"""Quantities that have a random number each; the order must stay, for campaigns to repeat."""
ANY_ANGLE = RandomQuantity[float](distribution="uniform", **{"from": 0.0, "to": float(np.pi)})
"""Angle (rad) of the long axis of an ellipse at the start, where none is given."""
_VOLUME = 4.0 / 3.0 * np.pi
"""Volume of a sphere / r3."""
_POSITIVE = ("radius", "mass", "density")


@dataclass(frozen=True)
class RockSampler:
    """Rocks of a campaign as a function of the numbers of the trials.

    Attributes
    ----------
    seed, hypercube : int
        Of the campaign.
    quantities : mapping of str to float or RandomQuantity
        Those of :data:`DRAWN` that are given.
    boulders : array of float, shape (n, 3)
        Mass (kg), radius (m) and elongation of measured ones, one of which each trial has.
    zone : array of float, shape (m, 2)
        Nodes (m) of the line on which the rocks start; empty if they start at x and y.
    moment_of_inertia : float
        As given (kg m2); any where it is not used.
    """

    seed: int
    hypercube: int
    quantities: Mapping[str, float | RandomQuantity[Any]]
    boulders: _Floats
    zone: _Floats
    moment_of_inertia: float

    @property
    def varies(self) -> bool:
        """Whether the rocks are not all the same."""
        drawn = any(isinstance(value, RandomQuantity) for value in self.quantities.values())
        return drawn or len(self.boulders) > 0 or len(self.zone) > 0

    def sample(self, first: int, count: int) -> _Floats:
        """Return the rocks of consecutive trials.

        Parameters
        ----------
        first, count : int
            Number of the first trial, and of trials.

        Returns
        -------
        array of float, shape (count, len(ROCK))
        """
        # a kernel: who reads sites only needs no numba
        from rockshed.components.slope_rockfall.rocks import rock_numbers

        numbers = np.empty((count, len(DRAWN)))
        rock_numbers(self.seed, first, self.hypercube, numbers)
        return self.at(numbers)

    def middle(self) -> _Floats:
        """Return the rock in the middle of all distributions, shape (len(ROCK),)."""
        rock: _Floats = self.at(np.full((1, len(DRAWN)), 0.5))[0]
        return rock

    def at(self, numbers: _Floats) -> _Floats:
        """Return rocks at uniform numbers.

        Parameters
        ----------
        numbers : array of float, shape (n, len(DRAWN))
            From 0 to 1.

        Returns
        -------
        array of float, shape (n, len(ROCK))
        """
        column = {name: numbers[:, i] for i, name in enumerate(DRAWN)}
        rocks = np.zeros((len(numbers), len(ROCK)))
        known = {
            name: values_of(value, column[name]) if isinstance(value, RandomQuantity) else value
            for name, value in self.quantities.items()
        }
        for name in ("x", "y", "vx", "vy", "omega", "angle"):
            rocks[:, getattr(ROCK, name)] = known.get(name, 0.0)
        if len(self.zone):
            rocks[:, ROCK.x], rocks[:, ROCK.y] = _along(self.zone, column["place"])
        mass, radius, elongation = self._bodies(known, column["boulder"])
        rocks[:, ROCK.mass], rocks[:, ROCK.radius] = mass, radius
        rocks[:, ROCK.elongation] = elongation
        rocks[:, ROCK.moment_of_inertia] = self.moment_of_inertia
        return rocks

    def _bodies(self, known: Mapping[str, Any], numbers: _Floats) -> tuple[Any, Any, Any]:
        """Return masses (kg), radii (m) and elongations."""
        if len(self.boulders):
            rows = np.minimum((numbers * len(self.boulders)).astype(int), len(self.boulders) - 1)
            mass, radius, elongation = self.boulders[rows].T
            return mass, radius, elongation
        radius, mass = known.get("radius"), known.get("mass")
        if radius is None:
            radius = np.cbrt(mass / (_VOLUME * known["density"]))
        if mass is None:
            mass = _VOLUME * radius**3 * known["density"]
        return mass, radius, known.get("elongation", 1.0)


def _along(zone: _Floats, numbers: _Floats) -> tuple[_Floats, _Floats]:
    """Return the points of a line at parts of its length."""
    steps = np.hypot(*np.diff(zone, axis=0).T)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    places = numbers * length[-1]
    return np.interp(places, length, zone[:, 0]), np.interp(places, length, zone[:, 1])


def rock_sampler(
    site: SlopeSite, nodes: Sequence[Node], boulders: Sequence[Boulder]
) -> RockSampler:
    """Return the rocks of a site without faults.

    Parameters
    ----------
    site : SlopeSite
        With rock and start.
    nodes : sequence of Node
        Of its profile.
    boulders : sequence of Boulder
        Of its file of measured boulders.

    Returns
    -------
    RockSampler
    """
    return RockSampler(
        site.seed,
        site.hypercube,
        {name: value for name, value, _ in given(site) if value is not None},
        np.array(boulders, float).reshape(-1, 3),
        _zone(site, nodes),
        site.rock.moment_of_inertia or 1.0,
    )


def middle_rock(site: SlopeSite, nodes: Sequence[Node] = ()) -> _Floats | None:
    """Return the rock in the middle of all distributions of a site.

    Parameters
    ----------
    site : SlopeSite
        With rock and start, which may have faults.
    nodes : sequence of Node, optional
        Of its profile; without them the place of a start along the slope is not known.

    Returns
    -------
    array of float, shape (len(ROCK),), or None
        None where no rock has these values, which is told as their fault.
    """
    spreads = (value for _, value, _ in given(site) if isinstance(value, RandomQuantity))
    if any(spread_faults(spread) for spread in spreads):
        return None
    try:
        return rock_sampler(site, nodes, site.rock.boulders or []).middle()
    except (KeyError, TypeError, ValueError):  # of two of radius, mass and density one is missing
        return None


def given(site: SlopeSite) -> Iterator[tuple[str, float | RandomQuantity[Any] | None, Key]]:
    """Yield name, value and place of every quantity of rock and start that may be drawn."""
    rock = site.rock
    start = site.start
    angle: float | RandomQuantity[Any] | None = start.angle
    if angle is None:
        angle = ANY_ANGLE if rock.shape == "ellipse" else 0.0
    for name in ("radius", "mass", "density", "elongation"):
        yield name, getattr(rock, name), ("rock", name)
    yield "x", start.x, ("start", "x")
    yield "y", start.y, ("start", "y")
    yield "vx", start.velocity[0], ("start", "velocity", 0)
    yield "vy", start.velocity[1], ("start", "velocity", 1)
    yield "omega", start.angular_velocity, ("start", "angular_velocity")
    yield "angle", angle, ("start", "angle")


def _zone(site: SlopeSite, nodes: Sequence[Node]) -> _Floats:
    """Return the nodes of the line on which the rocks start; none if they do so at x and y."""
    start = site.start
    if start.line is not None:
        return np.array(start.line, float)
    if start.along is None or len(nodes) < 2:
        return np.empty((0, 2))
    left, right = start.along
    inner = [(node.x, node.y) for node in nodes if left < node.x < right]
    return np.array([(left, surface(nodes, left)), *inner, (right, surface(nodes, right))])


# --- faults ---


def rock_problems(site: SlopeSite, nodes: Sequence[Node], where: Places) -> Iterator[Problem]:
    """Yield what is wrong with rock and start.

    Parameters
    ----------
    site : SlopeSite
        Of the right form.
    nodes : sequence of Node
        Of its profile, as far as they could be read.
    where : Places
        Of the values of the site.

    Yields
    ------
    Problem
        Values that do not go together, distributions that are none, and impossible rocks.
    """
    yield from _size_problems(site, where)
    yield from _shape_problems(site, where)
    yield from _start_problems(site, nodes, where)
    for name, value, key in given(site):
        if isinstance(value, RandomQuantity):
            faults = list(spread_problems(value, key, where))
            yield from faults or _impossible(name, value, key, where)


def _impossible(
    name: str, spread: RandomQuantity[Any], key: Key, where: Places
) -> Iterator[Problem]:
    """Yield a fault where a distribution reaches values that no rock has."""
    low, high = bounds(spread)
    if name in _POSITIVE and low <= 0.0:
        text = f"the distribution reaches {low:.4g}, and no rock has such a {name}"
        remedy = "cut it off with from, or take a lognormal one"
        yield Problem(where.of(key), text, remedy)
    if name == "elongation" and not 1.0 <= low <= high <= LONGEST:
        text = f"the distribution reaches from {low:.4g} to {high:.4g}; allowed is 1 to {LONGEST:g}"
        yield Problem(where.of(key), text, "cut it off with from and to")


def _size_problems(site: SlopeSite, where: Places) -> Iterator[Problem]:
    rock = site.rock
    place = where.of(("rock",))
    sizes = [name for name in _POSITIVE if getattr(rock, name) is not None]
    measured = [name for name in ("file", "boulders") if getattr(rock, name) is not None]
    if measured:
        yield from _boulder_problems(rock.boulders or [], where)
        for name in (*sizes, *(["elongation"] if rock.elongation is not None else [])):
            text = f"{name} and {measured[0]} exclude each other: measured boulders have their own"
            yield Problem(where.of(("rock", name)), text, "leave one of them out")
    elif rock.radius is None and len(sizes) < 2:
        text = "rock.radius: is missing" if sizes else "a rock has a radius and a mass or density"
        yield Problem(place, text, "give two of radius, mass and density, or a file of boulders")
    elif rock.radius is not None and len(sizes) != 2:
        text = "a rock has a mass, or the density of a sphere"
        yield Problem(place, text, "give one of the two")


def _boulder_problems(boulders: Sequence[Boulder], where: Places) -> Iterator[Problem]:
    """Yield measured boulders that are no rocks; those of a file are told with its lines."""
    for i, (_, _, elongation) in enumerate(boulders):
        if not 1.0 <= elongation <= LONGEST:
            text = f"boulder {i + 1} has the elongation {elongation:g}; 1 to {LONGEST:g} is allowed"
            yield Problem(where.of(("rock", "boulders", i)), text, "correct it, or leave it out")


def _shape_problems(site: SlopeSite, where: Places) -> Iterator[Problem]:
    rock = site.rock
    place = where.of(("rock",))
    if (rock.shape == "given") != (rock.moment_of_inertia is not None):
        text = 'a moment_of_inertia and shape = "given" belong together'
        yield Problem(place, text, "give both or none")
    drawn = any(isinstance(getattr(rock, name), RandomQuantity) for name in _POSITIVE)
    if rock.shape == "given" and (drawn or rock.file or rock.boulders):
        text = "one moment_of_inertia does not belong to rocks of several sizes"
        yield Problem(where.of(("rock", "shape")), text, "take sphere, disc or ellipse")
    if rock.elongation is not None and rock.shape != "ellipse":
        text = f"an elongation has no meaning for a {rock.shape}"
        yield Problem(where.of(("rock", "elongation")), text, 'take shape = "ellipse"')
    number = rock.elongation if not isinstance(rock.elongation, RandomQuantity) else None
    if number is not None and not 1.0 <= number <= LONGEST:
        text = f"elongation = {number:g}: allowed is 1 to {LONGEST:g}"
        yield Problem(where.of(("rock", "elongation")), text, "give the longer axis / the shorter")


def _start_problems(site: SlopeSite, nodes: Sequence[Node], where: Places) -> Iterator[Problem]:
    start = site.start
    ways = [name for name in ("x", "line", "along") if getattr(start, name) is not None]
    if len(ways) != 1:
        text = "start.x: is missing" if not ways else f"{' and '.join(ways)} exclude each other"
        remedy = "give x (and y), or line, or along"
        yield Problem(where.of(("start",)), text, remedy)
    if start.y is not None and start.x is None:
        yield Problem(where.of(("start", "y")), "y belongs to an x", "give x, or leave y out")
    if start.along is not None and start.along[0] >= start.along[1]:
        text = f"{start.along[0]:g} m is not left of {start.along[1]:g} m"
        yield Problem(where.of(("start", "along")), text, "exchange them")
    if len(nodes) > 1:
        for key, x in start_range(site):
            if not nodes[0].x <= x <= nodes[-1].x:
                text = f"x = {x:g} m is beside the profile"
                remedy = f"give an x from {nodes[0].x:g} to {nodes[-1].x:g} m"
                yield Problem(where.of(key), text, remedy)


def start_range(site: SlopeSite) -> list[tuple[Key, float]]:
    """Return key and value (m) of the outermost x at which rocks start."""
    start = site.start
    if start.line is not None:
        return [(("start", "line"), point[0]) for point in start.line]
    if start.along is not None:
        return [(("start", "along", i), x) for i, x in enumerate(start.along)]
    if isinstance(start.x, RandomQuantity):
        if spread_faults(start.x):
            return []  # told with its distribution
        return [(("start", "x"), x) for x in bounds(start.x)]
    return [] if start.x is None else [(("start", "x"), start.x)]
