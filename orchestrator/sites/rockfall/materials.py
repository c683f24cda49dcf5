"""Materials by name: those that ship, and those of a site, which may build on them."""

import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from ...core.errors import Problem
from ...core.system.names import nearest
from ...input_files.form import if_formed
from ...input_files.places import Places
from .site import Material, Scatter

DRSP = ("strength", "stiffness", "hardening")
"""Values of the impact law DRSP."""
COEFFICIENTS = ("normal_restitution", "tangential_restitution")
"""Values of the impact law by coefficients of restitution."""
COMMON = ("friction", "resistance", "tilt", "roughness")
"""Values that every material has."""
OPTIONAL = ("undulation", "scaling_speed")
"""Values that are zero where they are not given."""
QUANTITIES = (*DRSP, *COMMON, *COEFFICIENTS, *OPTIONAL)
"""Names of all values."""
OWN = "given with the site"
"""Source of a value that the site's file gives."""


@cache
def shipped() -> dict[str, Material]:
    """Return the materials of the table ``materials.toml`` by name."""
    data = tomllib.loads((Path(__file__).parent / "materials.toml").read_text(encoding="utf-8"))
    return {name: Material.model_validate(entry) for name, entry in data.items()}


def materials(
    own: Mapping[str, Material], where: Places, problems: list[Problem]
) -> dict[str, Material]:
    """Return all materials by name, complete.

    Parameters
    ----------
    own : mapping of str to Material
        Materials of the site; they come before those that ship.
    where : Places
        Of the values of the site.
    problems : list of Problem
        Materials that are not complete are appended.

    Returns
    -------
    dict of str to Material
        Those that ship and those of the site that have a form.
    """
    every = dict(shipped())
    for name, material in own.items():
        complete = if_formed(_complete, name, material, where, problems)
        if complete is not None:
            every[name] = complete
    return every


def _complete(
    name: str, material: Material, where: Places, problems: list[Problem]
) -> Material | None:
    """Return a material with all of its values; None if the one that it is like does not exist."""
    base = shipped().get(material.like or "")
    if material.like is not None and base is None:
        place = where.of(("material", name, "like"))
        text = f"there is no material {material.like!r}"
        problems.append(Problem(place, text, nearest(material.like, shipped())))
        return None
    problems += _mixed(name, material, where)
    complete = _completed(material, base)
    wanted = (*(COEFFICIENTS if by_coefficients(complete) else DRSP), *COMMON)
    missing = [quantity for quantity in wanted if getattr(complete, quantity) is None]
    if missing:
        remedy = 'give them, or name with like = "..." the material that has them'
        text = f"material {name} has no {', '.join(missing)}"
        problems.append(Problem(where.of(("material", name)), text, remedy))
    return complete


def by_coefficients(material: Material) -> bool:
    """Tell whether impacts on a material have coefficients of restitution, instead of DRSP."""
    return any(getattr(material, quantity) is not None for quantity in COEFFICIENTS)


def _mixed(name: str, material: Material, where: Places) -> Iterator[Problem]:
    """Yield a fault where a material gives values of both impact laws."""
    drsp = [quantity for quantity in DRSP if getattr(material, quantity) is not None]
    other = [quantity for quantity in COEFFICIENTS if getattr(material, quantity) is not None]
    if drsp and other:
        text = f"{', '.join(drsp)} belong to DRSP, {', '.join(other)} to another law of impact"
        place = where.of(("material", name, other[0]))
        yield Problem(place, text, "give the values of one law")


def _completed(material: Material, base: Material | None) -> Material:
    """Return a material with the values of the one it is like, and the sources of all of them.

    Values of the impact law that it has not come from there only if that one has the same law.
    """
    values: dict[str, Any] = {}
    source: dict[str, str] = {}
    unused: tuple[str, ...] = ()
    if by_coefficients(material):
        unused = DRSP
    elif any(getattr(material, quantity) is not None for quantity in DRSP):
        unused = COEFFICIENTS
    for quantity in QUANTITIES:
        if getattr(material, quantity) is not None:
            values[quantity] = getattr(material, quantity)
            source[quantity] = source_of(material, quantity) or OWN
        elif base is not None and quantity not in unused:
            values[quantity] = getattr(base, quantity)
            source[quantity] = source_of(base, quantity)
    return Material(description=material.description, source=source, **values)


def source_of(material: Material, quantity: str) -> str:
    """Return where a value of a material comes from.

    Parameters
    ----------
    material : Material
        Of the ground.
    quantity : str
        One of :data:`QUANTITIES`.

    Returns
    -------
    str
        Empty where no source is known.
    """
    return material.source.get(quantity, material.source.get("*", ""))


def parameters(material: Material) -> dict[str, float]:
    """Return the values of a complete material by the names of the component's parameters.

    Parameters
    ----------
    material : Material
        With all values of its impact law.

    Returns
    -------
    dict of str to float
        In SI units; a quantity that scatters gives two, ``tilt`` and ``tilt_deviation``.
    """
    values: dict[str, float] = {"by_coefficients": float(by_coefficients(material))}
    for quantity in QUANTITIES:
        value = getattr(material, quantity)
        if isinstance(value, Scatter):
            values[quantity] = value.mean
            values[f"{quantity}_deviation"] = value.deviation
        elif value is not None:
            values[quantity] = value
    return values


def described(material: Material) -> dict[str, Any]:
    """Return values and sources of a complete material as plain data."""
    return {
        "description": material.description,
        **parameters(material),
        "source": {
            quantity: source_of(material, quantity)
            for quantity in QUANTITIES
            if getattr(material, quantity) is not None
        },
    }
