"""Hammers and cushions by name: the tables that ship, and the complete ones of a pile."""

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from rockshed.components.common.units import standard_gravity

from ...core.errors import Problem
from ...core.system.names import nearest
from ...input_files.form import Data
from ...input_files.places import Key, Places
from .design import Ram, Spring
from .site import DrivingCushion, Hammer


class CushionMaterial(Data):
    """Modulus (Pa) and restitution of a material, and whether its source could be read."""

    modulus: float
    restitution: float
    source: str
    verified: bool


class HammerModel(Hammer):
    """A hammer of the table, and whether its source could be read."""

    source: str
    verified: bool


@cache
def cushion_materials() -> Mapping[str, CushionMaterial]:
    """Return the materials of ``cushions.toml`` by name."""
    entries = _table("cushions.toml").items()
    return {name: CushionMaterial.model_validate(entry) for name, entry in entries}


@cache
def hammer_models() -> Mapping[str, HammerModel]:
    """Return the hammers of ``hammers.toml`` by name."""
    entries = _table("hammers.toml").items()
    return {name: HammerModel.model_validate(entry) for name, entry in entries}


def _table(name: str) -> Mapping[str, Any]:
    return tomllib.loads((Path(__file__).parent / name).read_text(encoding="utf-8"))


def ram(given: Hammer, where: Places, problems: list[Problem]) -> Ram | None:
    """Return the ram of a hammer, with what the table has of it.

    Parameters
    ----------
    given : Hammer
        As the file has it.
    where : Places
        Of the values of the site.
    problems : list of Problem
        What is missing or contradictory is appended.

    Returns
    -------
    Ram or None
        None where something is missing.
    """
    values = {name: getattr(given, name) for name in Hammer.model_fields}
    source = ""
    verified = True
    if given.model is not None:
        model = hammer_models().get(given.model)
        if model is None:
            text = f"there is no hammer {given.model!r}"
            place = where.of(("hammer", "model"))
            problems.append(Problem(place, text, nearest(given.model, hammer_models())))
            return None
        values = _filled(given, model)
        source = model.source
        verified = model.verified
    problems += [Problem(where.of(key), text, remedy) for key, text, remedy in _faults(values)]
    if problems:
        return None
    drop = values["drop"] or values["energy"] / (values["mass"] * standard_gravity)
    return Ram(
        kind=values["kind"] or "drop",
        mass=values["mass"],
        drop=drop,
        efficiency=values["efficiency"] or 1.0,
        ports=values["ports"] or 0.0,
        rate=values["rate"],
        anvil=values["anvil"],
        gas=values["gas"],
        model=given.model or "",
        source=source,
        verified=verified,
    )


def _filled(given: Hammer, model: HammerModel) -> dict[str, Any]:
    """Return the values of a hammer, those of the model where the file has none."""
    named = {name: getattr(given, name) for name in Hammer.model_fields}
    own = {name: value for name, value in named.items() if value is not None}
    strokes = {"drop", "energy"}
    kept = strokes if strokes & own.keys() else set()
    table = {name: value for name, value in dict(model).items() if name not in kept}
    return {**dict.fromkeys(Hammer.model_fields), **table, **own}


def _faults(values: Mapping[str, Any]) -> list[tuple[Key, str, str]]:
    """Return place, fault and remedy of what is missing or contradictory in a hammer."""
    faults: list[tuple[Key, str, str]] = []
    if values["mass"] is None:
        faults.append(
            (("hammer",), "hammer.mass is missing", "give the mass of the ram, or a model")
        )
    strokes = [name for name in ("drop", "energy") if values[name] is not None]
    if len(strokes) != 1:
        text = "hammer.drop is missing" if not strokes else "hammer has a drop and an energy"
        faults.append((("hammer", *strokes[-1:]), text, "give one of drop and energy, or a model"))
    is_diesel = values["kind"] == "diesel"
    if is_diesel and values["gas"] is None:
        text = "a diesel hammer has no force of its gas"
        faults.append((("hammer", "kind"), text, "give hammer.gas.force, or a model of the table"))
    for name in ("gas", "ports"):
        if values[name] is not None and not is_diesel:
            text = f"only a diesel hammer has {name}"
            faults.append((("hammer", name), text, 'set kind = "diesel", or leave it out'))
    gas = values["gas"]
    if gas is not None and gas.end < gas.hold:
        text = f"the gas ends at {gas.end:g} s, before it has lost its force at {gas.hold:g} s"
        faults.append((("hammer", "gas", "end"), text, "let it end later"))
    drop, ports = values["drop"], values["ports"]
    if drop is not None and ports is not None and ports >= drop:
        text = f"the ports close {ports:g} m above the anvil, and the ram falls by {drop:g} m"
        faults.append((("hammer", "ports"), text, "give less than the height of the fall"))
    return faults


def spring(
    given: DrivingCushion | None, name: str, where: Places, problems: list[Problem]
) -> Spring | None:
    """Return a cushion with its stiffness, E A / t where a material is given.

    Parameters
    ----------
    given : DrivingCushion or None
        As the file has it.
    name : str
        Its table in the file.
    where : Places
        Of the values of the site.
    problems : list of Problem
        What is missing or contradictory is appended.

    Returns
    -------
    Spring or None
        None where there is no cushion, or something is missing.
    """
    if given is None:
        return None
    if given.stiffness is not None:
        extra = [key for key in ("material", "thickness", "area", "modulus") if getattr(given, key)]
        for key in extra:
            text = f"{name} has a stiffness and {key}"
            problems.append(Problem(where.of((name, key)), text, "leave one of the two out"))
        return Spring(stiffness=given.stiffness, restitution=given.restitution or 1.0)
    return _of_material(given, name, where, problems)


def _of_material(
    given: DrivingCushion, name: str, where: Places, problems: list[Problem]
) -> Spring | None:
    """Return a cushion of a material, an area and a thickness."""
    before = len(problems)
    material = cushion_materials().get(given.material or "")
    if given.material is not None and material is None:
        text = f"there is no cushion material {given.material!r}"
        remedy = nearest(given.material, cushion_materials())
        problems.append(Problem(where.of((name, "material")), text, remedy))
    missing = [key for key in ("thickness", "area") if getattr(given, key) is None]
    if given.material is None and given.modulus is None:
        missing.insert(0, "material")
    if missing:
        text = f"{name} has no stiffness, and no {', no '.join(missing)} from which it follows"
        remedy = "give stiffness, or material (or modulus), thickness and area"
        problems.append(Problem(where.of((name,)), text, remedy))
    if len(problems) > before or given.area is None or given.thickness is None:
        return None
    modulus = given.modulus or (material.modulus if material else 0.0)
    own = material.restitution if material else 1.0
    restitution = given.restitution if given.restitution is not None else own
    stiffness = modulus * given.area / given.thickness
    return Spring(
        stiffness=stiffness,
        restitution=restitution,
        material=given.material or "own modulus",
        source=material.source if material and given.modulus is None else "",
        verified=material is None or given.modulus is not None or material.verified,
    )
