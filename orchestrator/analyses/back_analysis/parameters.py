"""Parameters of the ground that a back-analysis infers, and the campaigns that they make."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rockshed.components.catalogue import component
from rockshed.components.common.cache import source_stamp
from rockshed.components.common.component import OK, value_problems

from ...campaigns.campaign import Campaign
from ...core.errors import InputRefused, Problem
from ...core.system.names import nearest
from ...input_files.form import first
from ...sites.rockfall.materials import COEFFICIENTS, COMMON, DRSP, by_coefficients
from ...sites.rockfall.preparation import PreparedSlope
from ..frame import FloatArray

LOGARITHMIC = 5.0
"""Largest ratio of a range whose prior is uniform in the value; beyond it, in its logarithm."""
_SCATTERING = ("tilt", "roughness")
_COMPONENT = {"": "", "mean": "", "deviation": "_deviation"}


@dataclass(frozen=True)
class Parameter:
    """A quantity of a material, and the range in which it is sought.

    Attributes
    ----------
    name : str
        ``soil.strength``, ``soil.roughness.mean``, or ``limit_speed.mean``.
    low, high : float
        Ends of the range (SI); the prior is uniform in the value, or in its logarithm for wide
        ranges of positive values.
    """

    name: str
    low: float
    high: float

    @property
    def is_logarithmic(self) -> bool:
        """Whether the prior is uniform in the logarithm."""
        return self.low > 0.0 and self.high / self.low > LOGARITHMIC

    def value(self, place: Any) -> Any:
        """Return the value at a place from 0 to 1 of the range."""
        if self.is_logarithmic:
            return self.low * (self.high / self.low) ** place
        return self.low + (self.high - self.low) * place

    def place(self, value: Any) -> Any:
        """Return the place from 0 to 1 of the range that a value has."""
        if self.is_logarithmic:
            return np.log(value / self.low) / np.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


def default_parameters(slope: PreparedSlope) -> list[Parameter]:
    """Return the parameters of all materials that end points tell most about.

    Parameters
    ----------
    slope : PreparedSlope
        With its materials.

    Returns
    -------
    list of Parameter
        Of DRSP the strength, of coefficients of restitution both, and of any material the roughness
        and the undulation.
    """
    made = []
    for name, material in slope.materials.items():
        if by_coefficients(material):
            made += [Parameter(f"{name}.normal_restitution", 0.05, 0.7)]
            made += [Parameter(f"{name}.tangential_restitution", 0.4, 1.0)]
        else:
            strength = float(material.strength or 0.0)
            made += [Parameter(f"{name}.strength", 0.1 * strength, 10.0 * strength)]
        made += [Parameter(f"{name}.roughness.mean", 0.02, 0.8)]
        made += [Parameter(f"{name}.undulation", 0.0, 0.5)]
    return made


def given_parameters(
    ranges: Mapping[str, tuple[float, float]], slope: PreparedSlope
) -> list[Parameter]:
    """Return the parameters that a user names, with their ranges.

    Raises
    ------
    InputRefused
        There is no such quantity, the slope does not have the material, or a range is none.
    """
    known = known_names(slope)
    problems = []
    for name, (low, high) in ranges.items():
        if name not in known:
            remedy = nearest(name, known)
            problems.append(Problem(f"fit {name}", "there is no such quantity here", remedy))
        elif text := _range_fault(name, low, high, slope):
            problems.append(
                Problem(f"fit {name}", text, "give NAME=LOW..HIGH within what is allowed")
            )
    if problems:
        raise InputRefused(first(problems))
    return [Parameter(name, low, high) for name, (low, high) in ranges.items()]


def _range_fault(name: str, low: float, high: float, slope: PreparedSlope) -> str:
    """Return what is wrong with a range; empty if nothing is."""
    if not (np.isfinite(low) and np.isfinite(high)):
        return f"{low:g} to {high:g} are no two finite numbers"
    if not low < high:
        return f"{low:g} is not below {high:g}"
    variables = {entry.name: entry for entry in slope.instance.component.layout.variables}
    variable = variables[component_name(name)]
    found = [text for end in (low, high) for text in value_problems(variable, name, end)]
    return "; ".join(found)


def component_name(name: str) -> str:
    """Return the name of the component's parameter that a quantity is: ``roughness_deviation``."""
    if name.startswith("limit_speed."):
        return name
    _, quantity, part = parts_of(name)
    return quantity + _COMPONENT[part]


def unit_of(name: str) -> str:
    """Return the SI unit of a quantity, ``1`` where it has none."""
    variables = component("SlopeRockfall").layout.variables
    return next(entry.unit for entry in variables if entry.name == component_name(name))


def parts_of(name: str) -> tuple[str, str, str]:
    """Return material, quantity, and ``mean`` or ``deviation`` or nothing, of a name.

    The material's own name may have dots.
    """
    before, _, last = name.rpartition(".")
    if last not in _COMPONENT:
        return before, last, ""
    material, _, quantity = before.rpartition(".")
    return material, quantity, last


def known_names(slope: PreparedSlope) -> list[str]:
    """Return the names of all quantities of a slope that can be inferred."""
    names = ["limit_speed.mean", "limit_speed.deviation"]
    for material, values in slope.materials.items():
        law = (*COEFFICIENTS, "scaling_speed") if by_coefficients(values) else DRSP
        for quantity in (*law, *COMMON, "undulation"):
            parts = [".mean", ".deviation"] if quantity in _SCATTERING else [""]
            names += [f"{material}.{quantity}{part}" for part in parts]
    return names


class GroundOfValues:
    """Campaigns over one slope with other values of its ground.

    Parameters
    ----------
    slope : PreparedSlope
        With its component.
    campaign : Campaign
        Over it.
    names : sequence of str
        Of the parameters, those of materials that the slope does not have have no effect.
    """

    def __init__(self, slope: PreparedSlope, campaign: Campaign, names: Sequence[str]) -> None:
        self.campaign = campaign
        self._component = slope.instance.component
        self._places = [self._place(slope, name) for name in names]

    @property
    def about(self) -> tuple[object, ...]:
        """Everything that a campaign follows from besides the values."""
        return source_stamp(self._component.folder), self.campaign, self._places

    def _place(self, slope: PreparedSlope, name: str) -> Any:
        """Return the places in the buffer of the component that a parameter sets."""
        instance = slope.instance
        if name.startswith("limit_speed."):
            return [instance.references[name]]
        material = parts_of(name)[0]
        variable = component_name(name)
        cells = [i for i, node in enumerate(slope.nodes[:-1]) if node.material == material]
        return [instance.references[f"{variable}[{cell + 1}]"] for cell in cells]

    def with_values(self, values: FloatArray) -> Campaign | None:
        """Return the campaign with these values; None where the component refuses them."""
        w, x = self.campaign.w.copy(), self.campaign.x.copy()
        k = self.campaign.k.copy()
        for places, value in zip(self._places, values, strict=True):
            w[places] = value
        if self._component.initialise(w, x, k) != OK:
            return None
        return replace(self.campaign, w=w, x=x, k=k)


def values_at(parameters: Sequence[Parameter], places: FloatArray) -> FloatArray:
    """Return the values of parameters at places from 0 to 1, shape (..., parameters)."""
    columns = [p.value(places[..., i]) for i, p in enumerate(parameters)]
    return np.stack(columns, axis=-1)
