"""From a slope as data to the component SlopeRockfall.

Everything that is wrong with a site is collected before it is refused.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError, Instance
from rockshed.components.slope_rockfall.faults import FOLDED
from rockshed.components.slope_rockfall.records import ROCK

from ...core.errors import InputRefused, Problem
from ...input_files.fields import doubts, explained
from ...input_files.form import first, formed, if_formed
from ...input_files.places import Key, Places
from ...input_files.setting import Setting, setter
from ..source import SiteLike, SiteSource, site_source
from . import materials as ground
from .boulders import read_boulders
from .checks import MODEL, site_problems
from .profile import Node, unfolded, with_ground
from .reading import read_nodes
from .rocks import RockSampler, middle_rock, rock_sampler
from .site import Material, SlopeSite
from .start_check import start_faults

COMPONENT = "SlopeRockfall"


@dataclass(frozen=True)
class PreparedSlope:
    """A slope that can be computed.

    Attributes
    ----------
    source : SiteSource
        Where the site was read.
    site : SlopeSite
        Its data.
    nodes : sequence of Node
        Of the profile, with the material of the cell that begins there.
    materials : mapping of str to Material
        Those in use, complete.
    instance : Instance
        Of the component, initialised.
    rocks : RockSampler
        Rocks and starts of the trials; the instance has the one in the middle.
    warnings : tuple of str
        Values beyond what is usual.
    notes : tuple of str
        What the profile has been changed into.
    """

    source: SiteSource
    site: SlopeSite
    nodes: Sequence[Node]
    materials: Mapping[str, Material]
    instance: Instance
    rocks: RockSampler
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the site, or of its file."""
        return self.source.name

    @property
    def files(self) -> list[Path]:
        """Files that it was read from, absolute: its own, and those of profile and boulders."""
        rock = self.source.content["rock"]  # in the site, the boulders of its file are in its place
        boulders = rock.get("file") if isinstance(rock, Mapping) else rock.file
        named = [self.source.folder / name for name in (self.site.profile.file, boulders) if name]
        return [file.absolute() for file in (self.source.file, *named) if file]


def prepare(site: SiteLike, trials: int | None = None, seed: int | None = None) -> PreparedSlope:
    """Read and check a slope, and initialise its component.

    Parameters
    ----------
    site : path, mapping or SlopeSite
        Site file (TOML), or its content.
    trials, seed : int, optional
        Replace those of the site.

    Returns
    -------
    PreparedSlope
        Site, profile and initialised component.

    Raises
    ------
    InputRefused
        Everything that is wrong with the site, with line and column.
    """
    source = site_source(site, trials=trials, seed=seed)
    where = source.places
    problems: list[Problem] = []
    data = formed(SlopeSite, source.content, where, problems)
    is_formed = not problems
    notes: list[str] = []
    known = if_formed(lambda: ground.materials(data.material, where, problems)) or {}
    data = if_formed(_with_boulders, data, source, problems) or data
    nodes = if_formed(_nodes, data, source, problems, notes) or []
    problems += site_problems(data, nodes, where)
    instance = None
    if is_formed and len(nodes) > 1:
        instance = _instance(data, nodes, known, where, problems)
    doubted = tuple(doubts(data, where))
    if problems or instance is None:
        raise InputRefused(first(explained(problems, doubted)))
    used = {str(node.material): known[str(node.material)] for node in nodes[:-1]}
    rocks = rock_sampler(data, nodes, data.rock.boulders or [])
    if rocks.varies:
        problems += start_faults(rocks, nodes, data, where)
    if problems:
        raise InputRefused(first(problems))
    return PreparedSlope(source, data, nodes, used, instance, rocks, doubted, tuple(notes))


def _with_boulders(site: SlopeSite, source: SiteSource, problems: list[Problem]) -> SlopeSite:
    """Return a site with the boulders of its file in it."""
    if site.rock.file is None:
        return site
    path = source.folder / site.rock.file
    if not os.path.isfile(path):
        place = source.places.of(("rock", "file"))
        problems.append(Problem(place, f"there is no file {path}", "correct the path"))
        return site
    boulders = read_boulders(path, site.rock.shape == "ellipse", problems)
    rock = site.rock.model_copy(update={"file": None, "boulders": boulders})
    return site.model_copy(update={"rock": rock})


def _nodes(
    data: SlopeSite, source: SiteSource, problems: list[Problem], notes: list[str]
) -> list[Node]:
    """Return the nodes of the profile, with the materials of the cells that begin there."""
    known = {*ground.shipped(), *data.material}
    read = read_nodes(data.profile, source.folder, source.places, known, problems)
    nodes = unfolded(read, problems, notes)
    return if_formed(with_ground, nodes, data.ground, source.places, known, problems) or nodes


def _instance(
    site: SlopeSite,
    nodes: Sequence[Node],
    known: Mapping[str, Material],
    where: Places,
    problems: list[Problem],
) -> Instance | None:
    """Return the component over this profile, initialised; None where it refuses its values."""
    before = len(problems)
    try:
        instance = component(COMPONENT).instance(cells=len(nodes) - 1)
    except ComponentError as error:
        problems += [Problem(where.of(("profile",)), text) for text in error.problems]
        return None
    setting = setter(instance, where, problems)
    for name, value, key in _settings(site, nodes):
        setting(name, value, key)
    for name in sorted({str(node.material) for node in nodes[:-1]} & known.keys()):
        _set_material(instance, name, known[name], nodes, setting)
    _set_profile(instance, nodes)
    problems += _slope_problems(instance, nodes, where)
    if len(problems) > before:
        return None
    try:
        instance.initialise()
    except ComponentError as error:
        remedy = "in the file: start.y, or none to start on the slope"
        problems += [Problem(where.of(("start",)), text, remedy) for text in error.problems]
    return instance


def _set_profile(instance: Instance, nodes: Sequence[Node]) -> None:
    instance["profile.x"] = nodes[0].x
    instance["profile.y"] = nodes[0].y
    instance["end.x"][:] = [node.x for node in nodes[1:]]
    instance["end.y"][:] = [node.y for node in nodes[1:]]


def _slope_problems(instance: Instance, nodes: Sequence[Node], where: Places) -> Iterator[Problem]:
    """Yield the faults of single cells, and of the values that all trials share."""
    # kernels: a run that draws no slope needs no numba
    from rockshed.components.slope_rockfall.refusals import cell_problems, common_fault

    for cell, fault, text in cell_problems(instance):
        yield Problem(nodes[cell + 1 if fault == FOLDED else cell].where, text)
    if fault := common_fault(instance.w):
        yield Problem(where.of(("limit_speed",)), instance.message(fault))


def _settings(site: SlopeSite, nodes: Sequence[Node]) -> Iterator[tuple[str, Any, Key]]:
    """Yield name, value and place of every scalar parameter that the site sets."""
    yield from _rock_settings(site, nodes)
    yield "seed", site.seed, ("seed",)
    yield "hypercube", site.hypercube, ("hypercube",)
    limit = site.limit_speed
    yield "limit_speed.mean", limit.mean, ("limit_speed", "mean")
    yield "limit_speed.deviation", limit.deviation, ("limit_speed", "deviation")
    yield "limit_speed.distribution", limit.distribution, ("limit_speed", "distribution")
    yield "roughness.distribution", site.distribution.roughness, ("distribution", "roughness")
    yield "tilt.distribution", site.distribution.tilt, ("distribution", "tilt")
    for name, value in site.model.items():
        if name in MODEL:
            yield MODEL[name], value, ("model", name)


def _rock_settings(site: SlopeSite, nodes: Sequence[Node]) -> Iterator[tuple[str, Any, Key]]:
    """Yield name, value and place of the parameters of rock and start; the middle ones if drawn."""
    rock = site.rock
    start = site.start
    middle = middle_rock(site, nodes)
    if middle is None:
        return
    yield "radius", middle[ROCK.radius], ("rock", "radius")
    yield "shape", rock.shape, ("rock", "shape")
    given = "density" if rock.mass is None and rock.density is not None else "mass"
    yield "mass", middle[ROCK.mass], ("rock", given)
    if rock.shape == "ellipse":
        yield "elongation", middle[ROCK.elongation], ("rock", "elongation")
    if rock.moment_of_inertia is not None:
        yield "moment_of_inertia", rock.moment_of_inertia, ("rock", "moment_of_inertia")
    yield "position0.x", middle[ROCK.x], ("start", "x")
    yield "on_slope", start.y is None and start.line is None, ("start",)
    yield "position0.y", middle[ROCK.y], ("start", "y")
    yield "velocity0.x", middle[ROCK.vx], ("start", "velocity", 0)
    yield "velocity0.y", middle[ROCK.vy], ("start", "velocity", 1)
    yield "angular_velocity0", middle[ROCK.omega], ("start", "angular_velocity")
    yield "angle0", middle[ROCK.angle], ("start", "angle")


def _set_material(
    instance: Instance, name: str, material: Material, nodes: Sequence[Node], setting: Setting
) -> None:
    """Set the parameters of all cells of a material; a value out of range is told once."""
    cells = np.array([node.material == name for node in nodes[:-1]])
    for parameter, value in ground.parameters(material).items():
        quantity = parameter.removesuffix("_deviation")
        key: Key = ("material", name, quantity, *(("deviation",) if quantity != parameter else ()))
        if setting(parameter, value, key):
            instance[parameter][cells] = value
