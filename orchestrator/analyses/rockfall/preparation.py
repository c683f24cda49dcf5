"""From a site to a campaign. Everything that is wrong with the site is collected before it is refused."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError, Instance
from rockshed.components.slope_rockfall.refusals import FOLDED, cell_problems, common_fault

from ...core.errors import InputRefused, Problem
from ...core.system.names import nearest
from ...input_files.form import first, formed, read_toml
from ...input_files.places import Path as Key
from ...input_files.places import Places
from ...input_files.setting import Setting, setter
from ...sites.rockfall import materials as ground
from ...sites.rockfall.profile import Node, read_nodes, surface, with_ground
from ...sites.rockfall.site import Barrier, Line, Profile, Site
from .campaign import Campaign, campaign

COMPONENT = "SlopeRockfall"
MOST_MEMORY = 4 << 30
"""Bytes for the records of all trials."""
SKY = 1000.0
"""Height (m) of a search line that is given by its x alone, and of a barrier's line, above the surface."""
_SPHERE = 4.0 / 3.0 * np.pi
"""Volume of a sphere / r3."""
MODEL = {
    "gravity": "gravity",
    "truncation": "truncation",
    "area_factor": "area_factor",
    "tilt_cap": "tilt_cap",
    "restitution_gravity": "restitution.gravity",
    "tilt_meaning": "tilt.meaning",
}
"""Keys of the section [model], and the parameters of the component that they set."""


@dataclass(frozen=True)
class Prepared:
    """A site that can be computed.

    nodes: with the material of the cell that begins there. materials: those in use. instance: initialised.
    """

    file: Path
    site: Site
    nodes: Sequence[Node]
    materials: Mapping[str, ground.Material]
    instance: Instance
    campaign: Campaign

    @property
    def name(self) -> str:
        """Of the site, or of its file."""
        return self.site.name or self.file.stem


def prepare(file: Path, trials: int | None = None, seed: int | None = None) -> Prepared:
    """Read a site and make it ready; ``trials`` and ``seed`` replace those in the file.

    Raises:
        InputRefused: everything that is wrong with it, with line and column.
    """
    data, where = read_toml(file)
    data = {
        **data,
        **{key: value for key, value in (("trials", trials), ("seed", seed)) if value is not None},
    }
    problems: list[Problem] = []
    site = formed(Site, data, where, problems)
    if site is None:
        _profile_too(data, file, where, problems)
        raise InputRefused(problems)
    known = ground.materials(site.material, where, problems)
    nodes = with_ground(
        read_nodes(site.profile, file.parent, where, known, problems),
        site.ground,
        where,
        known,
        problems,
    )
    problems += [*_rock_problems(site, where), *_line_problems(site, nodes, where)]
    instance = _instance(site, nodes, known, where, problems) if len(nodes) > 1 else None
    if problems or instance is None:
        raise InputRefused(first(problems))
    used = {str(node.material): known[str(node.material)] for node in nodes[:-1]}
    made = Prepared(file, site, nodes, used, instance, _campaign(site, nodes, instance))
    _check_memory(made.campaign)
    return made


def _profile_too(
    data: Mapping[str, Any], file: Path, where: Places, problems: list[Problem]
) -> None:
    """What is wrong with the profile, where the form of something else is wrong."""
    if isinstance(data.get("profile"), dict) and not any(
        "profile" in problem.what for problem in problems
    ):
        known = {*ground.shipped(), *data.get("material", {})}
        read_nodes(Profile.model_validate(data["profile"]), file.parent, where, known, problems)


# --- what the form does not say ---


def _rock_problems(site: Site, where: Places) -> Iterable[Problem]:
    if (site.rock.mass is None) == (site.rock.density is None):
        yield Problem(
            where.of(("rock",)),
            "a rock has a mass, or the density of a sphere",
            "give one of the two",
        )
    if (site.rock.shape == "given") != (site.rock.moment_of_inertia is not None):
        yield Problem(
            where.of(("rock",)),
            'a moment_of_inertia and shape = "given" belong together',
            "give both or none",
        )


def _line_problems(site: Site, nodes: Sequence[Node], where: Places) -> Iterable[Problem]:
    for name in site.model.keys() - MODEL.keys():
        yield Problem(
            where.of(("model", name)), f"model.{name}: there is no such key", nearest(name, MODEL)
        )
    names = [*(line.name for line in site.line), *(barrier.name for barrier in site.barrier)]
    keys = [
        *(("line", i, "name") for i in range(len(site.line))),
        *(("barrier", i, "name") for i in range(len(site.barrier))),
    ]
    for name, key in zip(names, keys, strict=True):
        if names.count(name) > 1:
            yield Problem(
                where.of(key),
                f"several lines or barriers are called {name!r}",
                "give each a name of its own",
            )
    for i, line in enumerate(site.line):
        if (line.points is None) == (line.x is None):
            yield Problem(
                where.of(("line", i)),
                "a search line has two points, or an x from which it goes up",
                "give one of them",
            )
        elif line.points is not None and line.points[0] == line.points[1]:
            yield Problem(
                where.of(("line", i, "points")), "both points are the same", "give two points"
            )
    for i, barrier in enumerate(site.barrier):
        if _reach(barrier, site) <= 0.0:
            yield Problem(
                where.of(("barrier", i)),
                f"height = {barrier.height:g} m is not above its free border, "
                f"{_free_border(barrier, site):g} m: it would hold no rock",
                "raise height, or set free_border (by default the rock's radius)",
            )
    if len(nodes) > 1:
        yield from _outside(site, nodes, where)


def _outside(site: Site, nodes: Sequence[Node], where: Places) -> Iterable[Problem]:
    """What lies beside the profile."""
    left, right = nodes[0].x, nodes[-1].x
    places: list[tuple[Key, float]] = [(("start", "x"), site.start.x)]
    places += [(("barrier", i, "x"), barrier.x) for i, barrier in enumerate(site.barrier)]
    places += [(("line", i, "x"), line.x) for i, line in enumerate(site.line) if line.x is not None]
    places += [(("profile", "end"), site.profile.end)] if site.profile.end is not None else []
    for key, x in places:
        if not left <= x <= right:
            yield Problem(
                where.of(key),
                f"x = {x:g} m is beside the profile",
                f"give an x from {left:g} to {right:g} m",
            )
    if site.profile.end is not None and site.profile.end <= site.start.x <= right:
        yield Problem(
            where.of(("profile", "end")),
            f"the trial ends at {site.profile.end:g} m, and the rock starts at {site.start.x:g} m",
            "let it end farther to the right",
        )


def _free_border(barrier: Barrier, site: Site) -> float:
    """Height (m) below the upper edge in which the rock's centre is not held: by default the radius."""
    return site.rock.radius if barrier.free_border is None else barrier.free_border


def _reach(barrier: Barrier, site: Site) -> float:
    return barrier.height - _free_border(barrier, site)


# --- the component ---


def _instance(
    site: Site,
    nodes: Sequence[Node],
    known: Mapping[str, ground.Material],
    where: Places,
    problems: list[Problem],
) -> Instance | None:
    """The component over this profile, initialised; None, and the reasons in ``problems``, if it refuses."""
    before = len(problems)
    try:
        made = component(COMPONENT).instance(cells=len(nodes) - 1)
    except ComponentError as error:
        problems += [Problem(where.of(("profile",)), text) for text in error.problems]
        return None
    setting = setter(made, where, problems)
    for name, value, key in _settings(site):
        setting(name, value, key)
    for name in sorted({str(node.material) for node in nodes[:-1]} & known.keys()):
        _set_material(made, name, known[name], nodes, setting)
    made["profile.x"], made["profile.y"] = nodes[0].x, nodes[0].y
    made["end.x"][:], made["end.y"][:] = (
        [node.x for node in nodes[1:]],
        [node.y for node in nodes[1:]],
    )
    problems += [
        Problem(nodes[cell + 1 if fault == FOLDED else cell].where, text)
        for cell, fault, text in cell_problems(made)
    ]
    if fault := common_fault(made.w):
        problems.append(Problem(where.of(("limit_speed",)), made.message(fault)))
    if len(problems) > before:
        return None
    try:
        made.initialise()
    except ComponentError as error:
        problems += [
            Problem(
                where.of(("start",)), text, "in the file: start.y, or none to start on the slope"
            )
            for text in error.problems
        ]
    return made


def _settings(site: Site) -> Iterable[tuple[str, Any, Key]]:
    """Name and value of every scalar parameter that the site gives, and where it stands."""
    rock, start = site.rock, site.start
    yield "radius", rock.radius, ("rock", "radius")
    yield "shape", rock.shape, ("rock", "shape")
    if rock.mass is not None or rock.density is not None:
        mass = rock.mass or _SPHERE * rock.radius**3 * float(rock.density or 0.0)
        yield "mass", mass, ("rock", "mass" if rock.mass else "density")
    if rock.moment_of_inertia is not None:
        yield "moment_of_inertia", rock.moment_of_inertia, ("rock", "moment_of_inertia")
    yield "position0.x", start.x, ("start", "x")
    yield "on_slope", start.y is None, ("start",)
    yield "position0.y", start.y or 0.0, ("start", "y")
    yield "velocity0.x", start.velocity[0], ("start", "velocity", 0)
    yield "velocity0.y", start.velocity[1], ("start", "velocity", 1)
    yield "angular_velocity0", start.angular_velocity, ("start", "angular_velocity")
    yield "seed", site.seed, ("seed",)
    yield "hypercube", site.hypercube, ("hypercube",)
    yield "limit_speed.mean", site.limit_speed.mean, ("limit_speed", "mean")
    yield "limit_speed.deviation", site.limit_speed.deviation, ("limit_speed", "deviation")
    yield "limit_speed.distribution", site.limit_speed.distribution, ("limit_speed", "distribution")
    yield "roughness.distribution", site.distribution.roughness, ("distribution", "roughness")
    yield "tilt.distribution", site.distribution.tilt, ("distribution", "tilt")
    for name, value in site.model.items():
        if name in MODEL:
            yield MODEL[name], value, ("model", name)


def _set_material(
    made: Instance, name: str, material: ground.Material, nodes: Sequence[Node], setting: Setting
) -> None:
    """The parameters of all cells of a material; values out of range are told once."""
    cells = np.array([node.material == name for node in nodes[:-1]])
    for parameter, value in ground.parameters(material).items():
        quantity, _, deviation = parameter.partition("_")
        key: Key = ("material", name, quantity, *(("deviation",) if deviation else ()))
        if setting(parameter, value, key):
            made[parameter][cells] = value


# --- the campaign ---


def _campaign(site: Site, nodes: Sequence[Node], instance: Instance) -> Campaign:
    entries: list[Line | Barrier] = [*site.line, *site.barrier]
    lines = np.array([_ends(entry, nodes) for entry in entries], np.float64).reshape(-1, 4)
    barriers = np.array(
        [
            (_reach(entry, site), entry.capacity) if isinstance(entry, Barrier) else (-1.0, 0.0)
            for entry in entries
        ],
        np.float64,
    )
    right = nodes[-1].x if site.profile.end is None else site.profile.end
    return campaign(
        instance,
        site.seed,
        site.trials,
        nodes[0].x,
        right,
        lines,
        barriers.reshape(-1, 2),
        np.linspace(nodes[0].x, right, site.stations),
        [entry.name for entry in entries],
    )


def _ends(entry: Line | Barrier, nodes: Sequence[Node]) -> tuple[float, float, float, float]:
    """The two points (m) of a search line; those of a barrier begin at its foot."""
    if isinstance(entry, Line) and entry.points is not None:
        (x1, y1), (x2, y2) = entry.points
        return x1, y1, x2, y2
    x = float(entry.x or 0.0)
    foot = surface(list(nodes), x)
    return x, foot, x, foot + SKY


def _check_memory(given: Campaign) -> None:
    needed = given.trials * given.bytes_per_trial
    if needed > MOST_MEMORY:
        most = MOST_MEMORY // given.bytes_per_trial
        raise InputRefused(
            [
                Problem(
                    "trials",
                    f"the records of {given.trials} trials need {needed / 2**30:.1f} GiB; allowed are "
                    f"{MOST_MEMORY / 2**30:.0f}",
                    f"at most {most} trials, or fewer stations or lines",
                )
            ]
        )
