"""Materials by name: those that ship, and those of a site, which may build on them."""

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from ...core.errors import Problem
from ...core.system.names import nearest
from ...input_files.places import Places
from .site import Material, Scatter

QUANTITIES = ("strength", "stiffness", "hardening", "friction", "resistance", "tilt", "roughness")
OWN = "given with the site"
"""Source of a value that the site's file gives."""


@cache
def shipped() -> dict[str, Material]:
    """The table ``materials.toml``."""
    data = tomllib.loads((Path(__file__).parent / "materials.toml").read_text(encoding="utf-8"))
    return {name: Material.model_validate(entry) for name, entry in data.items()}


def materials(
    own: Mapping[str, Material], where: Places, problems: list[Problem]
) -> dict[str, Material]:
    """All materials by name, complete; those of the site come before those that ship."""
    found = dict(shipped())
    for name, given in own.items():
        base = shipped().get(given.like or "")
        if given.like is not None and base is None:
            problems.append(
                Problem(
                    where.of(("material", name, "like")),
                    f"there is no material {given.like!r}",
                    nearest(given.like, shipped()),
                )
            )
            continue
        made = _completed(given, base)
        missing = [quantity for quantity in QUANTITIES if getattr(made, quantity) is None]
        if missing:
            problems.append(
                Problem(
                    where.of(("material", name)),
                    f"material {name} has no {', '.join(missing)}",
                    'give them, or name with like = "..." the material that has them',
                )
            )
        found[name] = made
    return found


def _completed(given: Material, base: Material | None) -> Material:
    """A material with the values of the one it is like, and the sources of all of them."""
    own = {
        quantity: getattr(given, quantity)
        for quantity in QUANTITIES
        if getattr(given, quantity) is not None
    }
    values = {
        **({quantity: getattr(base, quantity) for quantity in QUANTITIES} if base else {}),
        **own,
    }
    source = {
        **({quantity: source_of(base, quantity) for quantity in QUANTITIES} if base else {}),
        **{quantity: source_of(given, quantity) or OWN for quantity in own},
    }
    return Material(description=given.description, source=source, **values)


def source_of(material: Material, quantity: str) -> str:
    """Where a value comes from."""
    return material.source.get(quantity, material.source.get("*", ""))


def parameters(material: Material) -> dict[str, float]:
    """Values by the names of the component's parameters."""
    found: dict[str, float] = {}
    for quantity in QUANTITIES:
        value = getattr(material, quantity)
        if isinstance(value, Scatter):
            found[quantity], found[f"{quantity}_deviation"] = value.mean, value.deviation
        else:
            found[quantity] = value
    return found


def described(material: Material) -> dict[str, Any]:
    """Values and their sources as plain data."""
    return {
        "description": material.description,
        **parameters(material),
        "source": {quantity: source_of(material, quantity) for quantity in QUANTITIES},
    }
