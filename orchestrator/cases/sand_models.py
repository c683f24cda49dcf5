"""Models of the sand by name.

A model sets parameters of the sand cushion, and takes from the case the state of the soil.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

from rockshed.components.common.units import cm, kgf, standard_gravity
from rockshed.components.sand_cushion.models import MODELS, SPREAD, SandModel

from ..core.errors import InputRefused, Problem
from ..core.system.fields import Value
from ..core.system.names import nearest

_KGF_PER_CM2 = kgf / cm**2

LATTICE_SHIFT = 1e-3
"""Random displacement of the discs of a lattice, in diameters, where samples are to differ."""


@dataclass(frozen=True)
class Soil:
    """State of a soil.

    Attributes
    ----------
    cohesion : float
        Of the moist sand (Pa).
    solid_fraction : float
        Part of the layer that its discs fill.
    """

    cohesion: float
    solid_fraction: float


@dataclass(frozen=True)
class SandLayer:
    """The layer of sand of a case, and the rock that meets it.

    Attributes
    ----------
    width, height : float
        Of the layer (m).
    disc_radius, rock_radius : float
        Radii (m).
    speed : float
        Of the rock at the surface, downwards (m/s).
    soil : Soil
        State of the soil.
    duration : float
        Duration of the run (s).
    falling : bool
        Whether the rock speeds up on its way to the surface.
    dropped : bool
        Whether the rock starts above the layer, and does not come from a slope.
    on_beam : bool
        Whether the sand lies on a beam.
    step : float or None
        Internal step of the sand (s), where the case's own is longer than prepared layers bear.
    """

    width: float
    height: float
    disc_radius: float
    rock_radius: float
    speed: float
    soil: Soil
    duration: float
    falling: bool = True
    dropped: bool = True
    on_beam: bool = False
    step: float | None = None


@dataclass(frozen=True)
class Changes:
    """Whatever a case has other than as it is declared.

    Attributes
    ----------
    values : mapping of str to Value
        By ``component.parameter``.
    sizes : mapping of str to int
        By ``component.size``.
    options : mapping of str to float
        Keys of the system.
    """

    values: Mapping[str, Value] = field(default_factory=dict)
    sizes: Mapping[str, int] = field(default_factory=dict)
    options: Mapping[str, float] = field(default_factory=dict)


LOOSE, DENSE = 0.735, 0.75
"""Solid fractions of discs (in the plane) for sand as poured and as compacted.

Calibrated with the same tests.
"""
FULL_SCALE_SOIL = Soil(0.05 * _KGF_PER_CM2, DENSE)
"""Soil on rigid base and girders, of which nothing is known: moist and compacted."""


def sand_model(name: str) -> SandModel:
    """Return a model by its name.

    Parameters
    ----------
    name : str
        ``calibrated``, ``literal`` or ``one-law``.

    Returns
    -------
    SandModel
        The model.

    Raises
    ------
    InputRefused
        There is no such model.
    """
    if name not in MODELS:
        raise InputRefused(
            [Problem(f"model {name}", "there is no such model of the sand", nearest(name, MODELS))]
        )
    return MODELS[name]


def lattice_height(discs: int, width: float, radius: float) -> float:
    """Return the height of a square lattice of discs.

    Parameters
    ----------
    discs : int
        Number of discs.
    width : float
        Of the box (m).
    radius : float
        Of a disc (m).

    Returns
    -------
    float
        Height (m).
    """
    columns = max(1, math.floor(width / (2.0 * radius) * (1.0 + 1e-9)))
    return math.ceil(discs / columns) * 2.0 * radius


@cache
def discs_of(layer: SandLayer, solid_fraction: float) -> int:
    """Return the number of discs of many sizes that fill a layer.

    The mean of r^2 is r^2 (1 + spread^2 / 3).

    Parameters
    ----------
    layer : SandLayer
        The layer.
    solid_fraction : float
        Part of it that the discs fill.

    Returns
    -------
    int
        Number of discs.
    """
    area = math.pi * layer.disc_radius**2 * (1.0 + SPREAD**2 / 3.0)
    return round(solid_fraction * layer.width * layer.height / area)


def model_values(name: str) -> dict[str, Value]:
    """Return the values of a model that takes nothing from the soil, for sand on a floor.

    Parameters
    ----------
    name : str
        Name of the model.

    Returns
    -------
    dict of str to Value
        By ``sand.parameter``.
    """
    return {f"sand.{key}": value for key, value in MODELS[name].parameters.items()}


def changes(model: SandModel, layer: SandLayer, soil: Soil | None = None) -> Changes:
    """Return what is other in a case with a model of the sand.

    The surface of a prepared layer is uneven and known only when it has settled: the rock starts
    higher, and slower by what it gains on the way.

    Parameters
    ----------
    model : SandModel
        The model.
    layer : SandLayer
        The layer of the case.
    soil : Soil, optional
        Another state of the soil than the case's.

    Returns
    -------
    Changes
        Values, sizes and keys of the system.
    """
    values: dict[str, Value] = {f"sand.{name}": value for name, value in model.parameters.items()}
    if layer.on_beam:
        values["sand.base"] = model.beam_base
    if not model.prepared:
        return Changes(values)
    state = soil or layer.soil
    largest = 2.0 * layer.disc_radius * (1.0 + SPREAD)
    clearance = _CLEARANCE * largest
    gained = 2.0 * standard_gravity * clearance if layer.falling else 0.0
    values |= {
        "sand.cohesion": state.cohesion,
        "sand.solid_fraction": state.solid_fraction,
        "sand.settling.time": _SETTLING * math.sqrt(layer.disc_radius / standard_gravity),
    }
    if layer.dropped:
        values |= {
            "rock.position0.y": layer.height + clearance + layer.rock_radius,
            "rock.velocity0.y": -math.sqrt(layer.speed**2 - gained),
        }
    if layer.step:
        values["sand.internal_step"] = layer.step
    return Changes(
        values,
        {"sand.discs": discs_of(layer, state.solid_fraction)},
        {"stop_time": math.ceil(1e3 * (layer.duration + clearance / layer.speed)) / 1e3},
    )


_SETTLING = 60.0
"""Longest time of settling after the preparation, in sqrt(r/g): single discs come to rest late, a
layer at rest ends it earlier."""
_CLEARANCE = 2.5
"""Height over the layer at which the rock starts, in largest diameters: single discs of a random
surface stand out by nearly two."""
