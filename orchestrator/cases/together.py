"""Values of a case that move together: beam, box, sand and rock when one of them is changed."""

import math
from collections.abc import Mapping
from contextlib import suppress

from rockshed.components.catalogue import component
from rockshed.components.common.component import Component
from rockshed.components.sand_cushion.models import SPREAD

from ..core.system.fields import Value
from ..core.system.system import SystemSpec
from ..sites.shed.discretisation import axis_below_top, discs_in, element_length
from ..sites.words import length_in_words, mass_in_words
from .sand_models import SandLayer, lattice_height

ComponentSizes = Mapping[str, Mapping[str, int]]
"""Sizes by component of the system: ``{"sand": {"discs": 370}}``."""

_SAME = 1e-9
"""Part by which two equal values may differ."""


def declared_value(declared: Component, port: str) -> Value | None:
    """Return the start value that a component declares, of a choice its word.

    Parameters
    ----------
    declared : Component
        The component.
    port : str
        Name of the variable.

    Returns
    -------
    Value or None
        None if there is no such variable.
    """
    for variable in declared.layout.ordered:
        if variable.name == port:
            start = variable.start_at(0, {})
            return variable.choices[int(start) - 1] if variable.choices else start
    return None


_MODELS = {"sand": "SandCushion", "beam": "RBSMBeam", "rock": "FallingRock"}
"""Components of the catalogue by their name in the cases."""


def value_in(system: SystemSpec, name: str) -> Value:
    """Return the value that a parameter of sand, beam or rock has in a system.

    Parameters
    ----------
    system : SystemSpec
        Of a case.
    name : str
        ``component.parameter``.

    Returns
    -------
    Value
        Shared, of its own, or the one that the component declares.
    """
    for entry in system.shared.values():
        if name in entry.targets:
            return entry.value
    owner, _, port = name.partition(".")
    given = system.components[owner].parameters
    if port in given:
        return given[port]
    return declared_value(component(_MODELS[owner]), port) or 0.0


def _number(system: SystemSpec, name: str) -> float:
    return float(value_in(system, name))


def moved(layer: SandLayer, system: SystemSpec, sizes: ComponentSizes) -> dict[str, Value]:
    """Return the values that follow from a changed span, box, layer or rock.

    Parameters
    ----------
    layer : SandLayer
        The sand of the case as it is declared.
    system : SystemSpec
        The case with the values that are asked for.
    sizes : mapping of str to sizes
        Sizes by component.

    Returns
    -------
    dict of str to Value
        By ``component.parameter``; empty where everything is as it was.
    """
    values: dict[str, Value] = {}
    with suppress(ValueError, ArithmeticError):  # no number, or none above 0: the FMU says so
        if "beam" in sizes:
            values |= _beam(system, sizes["beam"]["elements"])
        values |= _box(system, has_beam="beam" in sizes, dropped=layer.dropped)
        if layer.dropped:
            values |= _start_above(layer, system, sizes["sand"]["discs"])
    return {
        name: value
        for name, value in values.items()
        if not math.isclose(float(value), _number(system, name), rel_tol=_SAME, abs_tol=_SAME)
    }


def _beam(system: SystemSpec, elements: int) -> dict[str, Value]:
    """Return axis and disc radius of a beam whose top is y = 0."""
    span = _number(system, "beam.span")
    return {
        "beam.axis.y": axis_below_top(span, elements),
        "sand.beam.radius": 0.5 * element_length(span, elements),
    }


def _box(system: SystemSpec, has_beam: bool, dropped: bool) -> dict[str, Value]:
    """Return the place of box and rock: in the middle of the span, or of the box."""
    width = _number(system, "sand.box.width")
    if has_beam:
        middle = _number(system, "beam.axis.x") + 0.5 * _number(system, "beam.span")
        left = middle - 0.5 * width
        box: dict[str, Value] = {"sand.box.left": left}
        if width == _number(system, "beam.box.width"):
            box["beam.box.left"] = left
    else:
        middle = _number(system, "sand.box.left") + 0.5 * width
        box = {}
    return {**box, "rock.position0.x": middle} if dropped else box


def _start_above(layer: SandLayer, system: SystemSpec, discs: int) -> dict[str, Value]:
    """Return the start of another rock, or above a layer of other discs or in another box."""
    more = _number(system, "rock.radius") - layer.rock_radius
    if value_in(system, "sand.packing") == "square":  # the case has put it above so many discs
        more += _height(system, discs) - lattice_height(discs, layer.width, layer.disc_radius)
    elif value_in(system, "sand.packing") == "prepared" and _is_other_layer(layer, system, discs):
        more += _height(system, discs) - layer.height
    if abs(more) <= _SAME * layer.height:
        return {}
    return {"rock.position0.y": _number(system, "rock.position0.y") + more}


def _is_other_layer(layer: SandLayer, system: SystemSpec, discs: int) -> bool:
    width, radius = (_number(system, f"sand.{key}") for key in ("box.width", "disc.radius"))
    solid = _number(system, "sand.solid_fraction")
    own = discs_in(layer.width, layer.height, layer.disc_radius, solid)
    return (width, radius, discs) != (layer.width, layer.disc_radius, own)


def _height(system: SystemSpec, discs: int) -> float:
    """Return the height of a layer (m): of a lattice, or of discs of many sizes."""
    width, radius = (_number(system, f"sand.{key}") for key in ("box.width", "disc.radius"))
    if value_in(system, "sand.packing") == "square":
        return lattice_height(discs, width, radius)
    area = math.pi * radius**2 * (1.0 + SPREAD**2 / 3.0)
    return discs * area / (_number(system, "sand.solid_fraction") * width)


def described(layer: SandLayer, own: SystemSpec, system: SystemSpec, sizes: ComponentSizes) -> str:
    """Return the description of a case with other values: those that it has now.

    Parameters
    ----------
    layer : SandLayer
        The sand of the case as it is declared.
    own : SystemSpec
        The case as it is, with its model of the sand.
    system : SystemSpec
        The case with the values that are asked for.
    sizes : mapping of str to sizes
        Sizes by component.

    Returns
    -------
    str
        That of the case, where rock, layer and span are its own.
    """
    if not layer.dropped:
        return system.description
    with suppress(ValueError, ArithmeticError, TypeError):  # no number: the FMU says so
        before, now = (_in_words(each, sizes) for each in (own, system))
        if before != now:
            return f"{now} (changed from the case)"
    return system.description


def _in_words(system: SystemSpec, sizes: ComponentSizes) -> str:
    """Return rock, layer and span of a system in a line."""
    speed = math.hypot(*(_number(system, f"rock.velocity0.{axis}") for axis in "xy"))
    rock = f"{mass_in_words(_number(system, 'rock.mass'))} at {speed:.3g} m/s"
    sand = f"{length_in_words(_height(system, sizes['sand']['discs']))} of sand"
    if "beam" not in sizes:
        return f"{rock} on {sand} on a rigid base"
    return f"{rock} on {sand} on a beam of {_number(system, 'beam.span'):.3g} m"
