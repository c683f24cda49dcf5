"""From a slope as data to the component SlopeRockfall.

Everything that is wrong with a site is collected before it is refused.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError, Instance
from rockshed.components.slope_rockfall.faults import FOLDED

from ...core.errors import InputRefused, Problem
from ...input_files.fields import doubts, explained
from ...input_files.form import first, formed
from ...input_files.places import Key, Places
from ...input_files.setting import Setting, setter
from ..source import SiteLike, SiteSource, site_source
from . import materials as ground
from .checks import MODEL, site_problems
from .profile import Node, unfolded, with_ground
from .reading import read_nodes
from .site import Material, Profile, SlopeSite

COMPONENT = "SlopeRockfall"
_UNIT_SPHERE = 4.0 / 3.0 * np.pi
"""Volume of a sphere / r3."""


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
    warnings : tuple of str
        Values beyond what is usual.
    """

    source: SiteSource
    site: SlopeSite
    nodes: Sequence[Node]
    materials: Mapping[str, Material]
    instance: Instance
    warnings: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the site, or of its file."""
        return self.source.name


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
    if data is None:
        _check_profile_alone(source, problems)
        raise InputRefused(first(problems))
    known = ground.materials(data.material, where, problems)
    nodes = unfolded(read_nodes(data.profile, source.folder, where, known, problems), problems)
    nodes = with_ground(nodes, data.ground, where, known, problems)
    problems += site_problems(data, nodes, where)
    instance = _instance(data, nodes, known, where, problems) if len(nodes) > 1 else None
    doubted = tuple(doubts(data, where))
    if problems or instance is None:
        raise InputRefused(first(explained(problems, doubted)))
    used = {str(node.material): known[str(node.material)] for node in nodes[:-1]}
    return PreparedSlope(source, data, nodes, used, instance, doubted)


def _check_profile_alone(source: SiteSource, problems: list[Problem]) -> None:
    """Append the faults of the profile, where the form of something else is wrong."""
    profile = source.content.get("profile")
    own = source.content.get("material", {})
    if isinstance(profile, dict) and isinstance(own, dict):
        shape = formed(Profile, profile, source.places, [])  # its faults have been told
        if shape is not None:
            known = {*ground.shipped(), *own}
            nodes = read_nodes(shape, source.folder, source.places, known, problems)
            unfolded(nodes, problems)


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
    for name, value, key in _settings(site):
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


def _settings(site: SlopeSite) -> Iterator[tuple[str, Any, Key]]:
    """Yield name, value and place of every scalar parameter that the site sets."""
    yield from _rock_settings(site)
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


def _rock_settings(site: SlopeSite) -> Iterator[tuple[str, Any, Key]]:
    """Yield name, value and place of the parameters of rock and start."""
    rock = site.rock
    start = site.start
    yield "radius", rock.radius, ("rock", "radius")
    yield "shape", rock.shape, ("rock", "shape")
    if rock.mass is not None:
        yield "mass", rock.mass, ("rock", "mass")
    elif rock.density is not None:
        yield "mass", _UNIT_SPHERE * rock.radius**3 * rock.density, ("rock", "density")
    if rock.moment_of_inertia is not None:
        yield "moment_of_inertia", rock.moment_of_inertia, ("rock", "moment_of_inertia")
    yield "position0.x", start.x, ("start", "x")
    yield "on_slope", start.y is None, ("start",)
    yield "position0.y", start.y or 0.0, ("start", "y")
    yield "velocity0.x", start.velocity[0], ("start", "velocity", 0)
    yield "velocity0.y", start.velocity[1], ("start", "velocity", 1)
    yield "angular_velocity0", start.angular_velocity, ("start", "angular_velocity")


def _set_material(
    instance: Instance, name: str, material: Material, nodes: Sequence[Node], setting: Setting
) -> None:
    """Set the parameters of all cells of a material; a value out of range is told once."""
    cells = np.array([node.material == name for node in nodes[:-1]])
    for parameter, value in ground.parameters(material).items():
        quantity, _, deviation = parameter.partition("_")
        key: Key = ("material", name, quantity, *(("deviation",) if deviation else ()))
        if setting(parameter, value, key):
            instance[parameter][cells] = value
