"""Meshes of a shed: coarser and finer sand discs and beam elements, and their runs."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...cases.shed import prepared
from ...core.system.fields import Value
from ...runs.batch import COLUMNS, Task
from ...runs.request import Request

Project = Path | Mapping[str, Any]
"""A project file, or its content."""

DISCS, ELEMENTS = "sand discs", "beam elements"
"""Names of the two that are refined."""
DISC_FIELD, ELEMENT_FIELD, SEED_FIELD = (
    "numerics.disc_radius",
    "numerics.elements",
    "numerics.seed",
)
"""Fields of a project that the study sets."""
_MOMENTS = "beam.moment[*]"


@dataclass(frozen=True)
class Resolution:
    """A shed with sand discs and beam elements of one size.

    Attributes
    ----------
    refined : str
        :data:`DISCS` or :data:`ELEMENTS`.
    fineness : float
        Size of the project's discs or elements / that of this mesh.
    disc_radius : float
        Mean radius of the sand discs (m).
    discs, elements : int
        Numbers of sand discs and of beam elements.
    """

    refined: str
    fineness: float
    disc_radius: float
    discs: int
    elements: int

    @property
    def fields(self) -> dict[str, Value]:
        """Fields of the project that make this mesh."""
        return {DISC_FIELD: self.disc_radius, ELEMENT_FIELD: self.elements}


def meshes(project: Project, changes: Mapping[str, Value], finest: float) -> list[Resolution]:
    """Return the meshes of a study: the project's own, one coarser, and finer ones.

    The size of the discs changes by sqrt(2) from mesh to mesh, that of the elements by 2.

    Parameters
    ----------
    project : path or mapping
        The project.
    changes : mapping of str to Value
        Fields that replace those of the project.
    finest : float
        Size of the project's discs / that of the finest ones.

    Returns
    -------
    list of Resolution
        Of the discs, then of the elements, each from coarse to fine.

    Raises
    ------
    InputRefused
        The project is refused, with its own discs and elements or with others.
    """
    own = prepared(project, changes).layout
    halves = round(2.0 * math.log2(finest))
    of_discs = [
        _mesh(project, changes, DISCS, 2.0 ** (0.5 * step), own.disc_radius, own.elements)
        for step in range(-1, halves + 1)
    ]
    of_elements = [
        _mesh(project, changes, ELEMENTS, fineness, own.disc_radius, own.elements)
        for fineness in (0.5, 1.0, 2.0, 4.0)
    ]
    return [*of_discs, *of_elements]


def _mesh(
    project: Project,
    changes: Mapping[str, Value],
    refined: str,
    fineness: float,
    disc_radius: float,
    elements: int,
) -> Resolution:
    """Return a mesh of the project; an odd number of elements has one under midspan."""
    if refined == DISCS:
        disc_radius = float(f"{disc_radius / fineness:.4g}")
    elif fineness != 1.0:
        elements = 2 * round(0.5 * (elements * fineness - 1.0)) + 1
    fields: dict[str, Value] = {DISC_FIELD: disc_radius, ELEMENT_FIELD: elements}
    layout = prepared(project, {**changes, **fields}).layout
    return Resolution(refined, fineness, disc_radius, layout.discs, layout.elements)


def tasks(
    project: Project, values: Mapping[str, Value], mesh: Resolution, first: int, packings: int
) -> list[Task]:
    """Return the runs of a mesh, one for each packing of the sand.

    Parameters
    ----------
    project : path or mapping
        The project.
    values : mapping of str to Value
        Fields of the project and values of components that differ.
    mesh : Resolution
        The mesh.
    first : int
        Seed of the first packing.
    packings : int
        Number of packings.
    """
    content = None if isinstance(project, Path) else project
    return [
        Task(
            Request(
                "project" if content is not None else str(project),
                {**values, **mesh.fields, SEED_FIELD: seed},
                project=content,
            ),
            seed=seed,
            columns=(*COLUMNS, _MOMENTS),
        )
        for seed in range(first, first + packings)
    ]
