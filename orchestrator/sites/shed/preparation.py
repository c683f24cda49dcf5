"""From a project file to a shed whose every number is known.

Everything that is wrong with a project is collected before it is refused.
"""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from ...core.errors import InputRefused, Problem
from ...core.system.names import nearest
from ...input_files.fields import ANY, EACH, doubts, explained, fields
from ...input_files.form import first, formed, if_formed, told_if_formed
from ..source import SiteLike, SiteSource, site_source
from .checks import fit_problems, rock_source_problems, support_problems
from .geometry import CushionPart, RockPart, RoofArrival, RoofPart, ShedLayout, centred, layout
from .materials import doubts_of_stiffness
from .parts import cushion_part, pile_part, rock_part, roof_part, thickness_of
from .site import ShedProject


@dataclass(frozen=True)
class Cushioned:
    """Where the cushion lies in the frame of the shed.

    Attributes
    ----------
    left, right, thickness : float
        Its ends along the span, and its upper side above the roof's top (m).
    """

    left: float
    right: float
    thickness: float


@dataclass(frozen=True)
class SlopeRock:
    """The rock that a campaign on a slope gives to a shed.

    Attributes
    ----------
    rock : RockPart
        As it strikes the cushion.
    arrival : RoofArrival
        As it is handed over.
    origin : Any
        The campaign, and what was chosen of it.
    warnings : tuple of str
        Of the slope's own file.
    """

    rock: RockPart
    arrival: RoofArrival
    origin: Any
    warnings: tuple[str, ...]


RockOfSlope = Callable[[ShedProject, SiteSource, Cushioned, list[Problem]], SlopeRock | None]
"""Carries out the campaign of a project's slope, and takes its rock; None where it has faults,
which are appended."""


@dataclass(frozen=True)
class PreparedShed:
    """A shed that can be computed.

    Attributes
    ----------
    source : SiteSource
        The project as it is written, with what replaces it.
    project : ShedProject
        Its data.
    layout : ShedLayout
        Its numbers.
    warnings : tuple of str
        Values beyond what is usual.
    changes : mapping of str to Any
        Fields that replace those of the file, as they were given.
    slope : SlopeRock or None
        The rock of a slope; None where the project has a rock of its own.
    """

    source: SiteSource
    project: ShedProject
    layout: ShedLayout
    warnings: tuple[str, ...]
    changes: Mapping[str, Any]
    slope: SlopeRock | None = None

    @property
    def name(self) -> str:
        """Name of the project, or of its file."""
        return self.project.name or (self.source.file.stem if self.source.file else "shed")


def is_field(name: str) -> bool:
    """Tell whether a name is that of a field of a project, ``cushion.thickness`` for instance.

    Parameters
    ----------
    name : str
        With dots.

    Returns
    -------
    bool
    """
    parts = name.split(".")
    if parts[0] == "material" and len(parts) == 3:
        parts[1] = ANY
    return ".".join(parts) in all_fields()


@cache
def all_fields() -> tuple[str, ...]:
    """Return the names of all fields of a project that have one value."""
    return tuple(name for name, _ in fields(ShedProject) if EACH not in name)


def prepare(
    project: SiteLike,
    changes: Mapping[str, Any] | None = None,
    rock_of_slope: RockOfSlope | None = None,
) -> PreparedShed:
    """Read and check a project.

    Parameters
    ----------
    project : path, mapping or ShedProject
        Project file (TOML), or its content.
    changes : mapping of str to Any, optional
        Fields that replace those of the project: ``{"cushion.thickness": "1.5 m"}``.
    rock_of_slope : callable, optional
        Gives the rock of a project that has a slope.

    Returns
    -------
    PreparedShed
        All of its numbers.

    Raises
    ------
    InputRefused
        Everything that is wrong with the project, with line and column.
    """
    source = _changed(site_source(project, "project"), changes or {})
    where = source.places
    problems: list[Problem] = []
    data = formed(ShedProject, source.content, where, problems)
    doubted = tuple(doubts(data, where))
    problems += told_if_formed(rock_source_problems, data, where)
    roof = if_formed(roof_part, data, where, problems)
    slope = if_formed(_from_slope, data, source, rock_of_slope, problems)
    rock = slope.rock if slope else if_formed(rock_part, data, where, problems)
    parts = (rock, if_formed(cushion_part, data, rock, where, problems), roof)
    arrival = slope.arrival if slope else None
    found = if_formed(_laid_out, data, parts, arrival, source, problems)
    if problems or found is None:
        raise InputRefused(first(explained(problems, doubted)))
    doubted += tuple(doubts_of_stiffness(data.material, found.cushion.material, where))
    doubted += slope.warnings if slope else ()
    return PreparedShed(source, data, found, doubted, dict(changes or {}), slope)


def _from_slope(
    data: ShedProject,
    source: SiteSource,
    rock_of_slope: RockOfSlope | None,
    problems: list[Problem],
) -> SlopeRock | None:
    """Return the rock of a project's slope; None where it has none, or anything is wrong with it.

    Raises
    ------
    TypeError
        Nobody is there to carry out the campaign.
    """
    if data.slope is None or data.rock is not None:
        return None
    if rock_of_slope is None:
        raise TypeError("a project with a slope needs somebody who carries out its campaign")
    thickness = if_formed(thickness_of, data, source.places, [])
    if thickness is None:
        return None
    span = data.roof.span
    left = centred(span, data.cushion.width or span)
    return rock_of_slope(data, source, Cushioned(left, span - left, thickness), problems)


_Parts = tuple[RockPart | None, CushionPart | None, RoofPart | None]


def _laid_out(
    data: ShedProject,
    parts: _Parts,
    arrival: RoofArrival | None,
    source: SiteSource,
    problems: list[Problem],
) -> ShedLayout | None:
    """Return all numbers of a shed; None where a part or its supports are not known.

    What is wrong with the supports is appended, and what does not fit.
    """
    where = source.places
    before = len(problems)
    problems += support_problems(data, where)
    pile = pile_part(data, source.folder, where, problems)
    rock, cushion, roof = parts
    if rock is None or cushion is None or roof is None or len(problems) > before:
        return None
    found = layout(rock, cushion, roof, data.numerics, pile, arrival)
    problems += fit_problems(data, found, where)
    return found


def _changed(source: SiteSource, changes: Mapping[str, Any]) -> SiteSource:
    """Return a project with other fields.

    Raises
    ------
    InputRefused
        There are no such fields.
    """
    content = deepcopy(dict(source.content))
    problems = []
    for name, value in changes.items():
        if not is_field(name):
            problems.append(Problem(name, "is no field of a project", nearest(name, all_fields())))
            continue
        *section, key = name.split(".")
        table = content
        for part in section:
            table = table.setdefault(part, {})
            if not isinstance(table, dict):
                break  # the form says so
        else:
            table[key] = value
    if problems:
        raise InputRefused(problems)
    places = replace(source.places, replaced=(*source.places.replaced, *changes))
    return replace(source, content=content, places=places)
