"""Materials of a cushion by name: those that ship, and those of a project, which build on them."""

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from rockshed.components.common.units import MPa

from ...core.errors import Problem
from ...core.system.names import nearest
from ...input_files.form import if_formed
from ...input_files.places import Places
from .site import SandMaterial

DEFAULT_MATERIAL = "compacted sand"
STATE = ("modulus", "density", "solid_fraction", "cohesion", "friction_angle")
"""Names of the values that a complete material has."""
OWN_SOURCE = "given with the project"
"""Source of a value that the project's file gives."""


@cache
def shipped_sands() -> Mapping[str, SandMaterial]:
    """Return the materials of the table ``materials.toml`` by name."""
    data = tomllib.loads((Path(__file__).parent / "materials.toml").read_text(encoding="utf-8"))
    return {name: SandMaterial.model_validate(entry) for name, entry in data.items()}


def sands(
    own: Mapping[str, SandMaterial], where: Places, problems: list[Problem]
) -> dict[str, SandMaterial]:
    """Return all materials by name, complete.

    Parameters
    ----------
    own : mapping of str to SandMaterial
        Materials of the project; they come before those that ship.
    where : Places
        Of the values of the project.
    problems : list of Problem
        Materials that build on one that does not exist are appended.

    Returns
    -------
    dict of str to SandMaterial
        Those that ship and those of the project whose form is right.
    """
    every = dict(shipped_sands())
    for name, material in own.items():
        base = if_formed(_base, name, material, where, problems)
        complete = if_formed(_completed_sand, material, base or shipped_sands()[DEFAULT_MATERIAL])
        if complete is not None:
            every[name] = complete
    return every


def _base(
    name: str, material: SandMaterial, where: Places, problems: list[Problem]
) -> SandMaterial | None:
    """Return the material that another one is like."""
    base = shipped_sands().get(material.like or DEFAULT_MATERIAL)
    if base is None:
        text = f"there is no material {material.like!r}"
        remedy = nearest(str(material.like), shipped_sands())
        problems.append(Problem(where.of(("material", name, "like")), text, remedy))
    return base


def _completed_sand(material: SandMaterial, base: SandMaterial) -> SandMaterial:
    """Return a material with the values of the one it is like, and the sources of all of them."""
    like = material.like or DEFAULT_MATERIAL
    given = {key: value for key in STATE if (value := getattr(material, key)) is not None}
    taken = {key: f"that of {like}: {text}" for key, text in base.source.items()}
    source = {**taken, **{key: material.source.get(key, OWN_SOURCE) for key in given}}
    description = material.description or f"own material, like {like}"
    return base.model_copy(update={**given, "source": source, "description": description})


def doubts_of_stiffness(own: Mapping[str, SandMaterial], name: str, where: Places) -> list[str]:
    """Return a warning where the stiffness of a cushion is that of another material.

    Parameters
    ----------
    own : mapping of str to SandMaterial
        Materials of the project.
    name : str
        Of the material of the cushion.
    where : Places
        Of the values of the project.

    Returns
    -------
    list of str
        A sentence with its place; none of a material that ships, or whose modulus is given.
    """
    material = own.get(name)
    if material is None or material.modulus is not None:
        return []
    like = material.like or DEFAULT_MATERIAL
    base = shipped_sands().get(like, shipped_sands()[DEFAULT_MATERIAL])
    return [
        f"{where.of(('material', name))}: material {name!r} has no modulus: the stiffness of "
        f"{like} is assumed, E_bar = {float(base.modulus or 0.0) / MPa:.3g} MPa, calibrated to "
        "the sand of Sonoda et al. (1993) and to no other; forces and penetration follow it "
        "(docs/designer.md, Materials, tells how to find it)"
    ]


def caution(own: Mapping[str, SandMaterial], name: str) -> str:
    """Return what a reader of results has to know of a material; empty of one that ships.

    Parameters
    ----------
    own : mapping of str to SandMaterial
        Materials of the project.
    name : str
        Of the material of the cushion.
    """
    if name not in own:
        return ""
    return (
        f"{name} is a material of the project: no test with it stands behind these results, which "
        "are compared with tests on the sand of Sonoda et al. (1993) only"
    )
