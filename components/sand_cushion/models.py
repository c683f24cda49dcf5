"""Models of the sand by name: sets of parameters that were calibrated together."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..common.units import cm, kgf
from .declarations import LAYOUT


@dataclass(frozen=True)
class SandModel:
    """A model of the sand.

    Attributes
    ----------
    summary : str
        The model in a sentence.
    parameters : mapping of str to value
        Parameters that differ from the component's start values.
    prepared : bool
        Whether the layer is prepared in the state of the case's soil.
    beam_base : str
        Base where the sand lies on a beam.
    """

    summary: str
    parameters: Mapping[str, float | str]
    prepared: bool = False
    beam_base: str = "beam_surface"


ONE_LAW_MODULUS = 35.0
"""Fictitious modulus E_bar (kgf/cm2) of the one law: calibrated to twelve tests in the laboratory
and to table 6."""
ONE_LAW_UNLOADING = 3.0
"""Unloading stiffness / loading stiffness of the one law, calibrated with its modulus."""
ROLLING = 0.3
"""Rolling resistance of the one law."""
SPREAD = 0.25
"""Spread of the radii of the one law."""

MODELS: Mapping[str, SandModel] = {
    "calibrated": SandModel(
        "rotation locked and a factor on the stiffness, fitted to the paper's own figures", {}
    ),
    "literal": SandModel(
        "eq. (1) to the letter: three freedoms a disc, no factor",
        {"rotation": "free", "stiffness_factor": 1.0, "base.shape": "round"},
        beam_base="beam_discs",
    ),
    "one-law": SandModel(
        "one contact law for all tests: discs of many sizes that resist rolling, yield and stick; "
        "the soil's cohesion and solid fraction are what differs",
        {
            "rotation": "free",
            "stiffness_factor": 1.0,
            "modulus": ONE_LAW_MODULUS * (kgf / cm**2),
            "packing": "prepared",
            "disc.spread": SPREAD,
            "rolling_resistance": ROLLING,
            "unloading_ratio": ONE_LAW_UNLOADING,
            "density_of": "layer",
        },
        prepared=True,
    ),
}
_FREE = ("modulus", "packing", "disc.spread")
"""Parameters that may differ within a model, packing and spread with lattices only."""


def model_of(values: Mapping[str, float | str]) -> str | None:
    """Return the name of the model that the parameters of a sand cushion belong to.

    Parameters
    ----------
    values : mapping of str to value
        All parameters of the cushion; soil and modulus may be any.

    Returns
    -------
    str or None
        None if they belong to no model.
    """
    own = _start_values({key for model in MODELS.values() for key in model.parameters})
    for name, model in MODELS.items():
        wanted = {**own, **model.parameters}
        if values["base"] in ("floor", model.beam_base) and all(
            _same(values[key], wanted[key]) for key in wanted if key not in _FREE
        ):
            return name
    return None


def _start_values(names: set[str]) -> dict[str, float | str]:
    """Return the component's start values; a choice is a word."""
    found: dict[str, float | str] = {}
    for variable in LAYOUT.ordered:
        if variable.name in names:
            start = variable.start_at(0, {})
            found[variable.name] = variable.choices[int(start) - 1] if variable.choices else start
    return found


def _same(value: float | str, wanted: float | str) -> bool:
    if isinstance(wanted, float):
        return math.isclose(float(value), wanted)
    return value == wanted
