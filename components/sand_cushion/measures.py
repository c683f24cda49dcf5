"""Measures of a sand cushion that follow from its parameters, for metrics and captions of a run."""

import math
from collections.abc import Mapping, Sequence

from ..common.units import MPa, cm, kgf
from .models import MODELS, model_of

Parameters = Mapping[str, float | str]

_OPTIONAL = (
    ("rolling_resistance", "rolling resistance", 0.0, 1.0, ""),
    ("unloading_ratio", "unloading ratio", 1.0, 1.0, ""),
    ("cohesion", "cohesion", 0.0, 1e3, " kPa"),
)
"""Parameters that are named where they are not idle: name, words, idle value, unit in SI, its
name."""


def contact_frequency(parameters: Parameters) -> float:
    """Return the natural frequency of a sand disc on one contact, sqrt(k_n/m) / 2 pi.

    Parameters
    ----------
    parameters : mapping of str to value
        Parameters of the cushion.

    Returns
    -------
    float
        In Hz.
    """
    factor, modulus, density, radius, solid = (
        float(parameters[name])
        for name in ("stiffness_factor", "modulus", "density", "disc.radius", "solid_fraction")
    )
    if parameters["density_of"] == "layer":
        density /= solid
    return math.sqrt(factor * modulus / (density * math.pi)) / radius / (2.0 * math.pi)


def doubts(parameters: Parameters, structures: Sequence[str]) -> list[str]:
    """Return the reasons why the results may not mean what the user has in mind.

    Parameters
    ----------
    parameters : mapping of str to value
        Parameters of the cushion.
    structures : sequence of str
        Names of the beams in the system.

    Returns
    -------
    list of str
        Each continues the name of the cushion.
    """
    found = []
    if parameters["base"] == "floor" and structures:
        found.append(
            f"rests on a rigid floor (base = floor), so that nothing of the impact reaches the "
            f"{' and the '.join(structures)}: set base to beam_discs or beam_surface"
        )
    if float(parameters["gravity"]) == 0.0:
        found.append(
            "has no gravity (gravity = 0): nothing holds the sand down, and it weighs nothing on "
            "what carries it"
        )
    return found


def description(parameters: Parameters) -> str:
    """Return the model of the sand in a line: its name, and the parameters that make it up.

    Parameters
    ----------
    parameters : mapping of str to value
        Parameters of the cushion.
    """
    optional = [
        f"{words} {float(parameters[key]) / size:.3g}{unit}"
        for key, words, idle, size, unit in _OPTIONAL
        if float(parameters[key]) != idle
    ]
    modulus = float(parameters["modulus"])
    packing = f"{parameters['packing']} packing"
    if parameters["packing"] == "prepared":
        packing += f" of {parameters['solid_fraction']}"
    parts = [
        f"rotation {parameters['rotation']}",
        f"stiffness factor {float(parameters['stiffness_factor']):g}",
        *optional,
        packing,
        f"fictitious modulus E_bar {modulus / MPa:.3g} MPa ({modulus / kgf * cm**2:.1f} kgf/cm²)",
    ]
    return f"{model_of(parameters) or 'modified'} sand: {', '.join(parts)}"


def assumptions(parameters: Parameters) -> list[str]:
    """Return what the forces of a cushion rest on, for a report.

    Parameters
    ----------
    parameters : mapping of str to value
        Parameters of the cushion.

    Returns
    -------
    list of str
        A sentence or two each.
    """
    model = model_of(parameters)
    thickness = float(parameters["thickness"])
    plane = (
        f"The sand is a plane layer of discs, {thickness:g} m thick out of the plane; all forces "
        "are those of this thickness. Nothing spreads out of the plane."
    )
    made = "It is none of the models that were calibrated together."
    if model is not None:
        made = f"Model {model} of the sand: {MODELS[model].summary}."
    return [plane, made]
