"""Probe of the units: whether they mean what their names say."""

import math
from typing import Any

from ..subject.subject import Subject
from ..subject.variables import listed
from ..verdicts import Seen, failed, passed, warned

_BASES = {
    "kg": "[mass]",
    "m": "[length]",
    "s": "[time]",
    "A": "[current]",
    "K": "[temperature]",
    "mol": "[substance]",
    "cd": "[luminosity]",
}
_TOLERANCE = 1e-6
"""Relative difference of two factors that counts as none."""


def units(subject: Subject) -> Seen:
    """Compare units with their names, where the name is one that everybody knows."""
    defined = subject.model.unitDefinitions
    wrong = [text for unit in defined if (text := _problem(unit))]
    if wrong:
        return failed(listed(wrong, 2), "correct BaseUnit, or name the unit otherwise")
    without = [unit.name for unit in defined if unit.baseUnit is None]
    if without:
        return warned(
            f"{listed(without)}: named, and not defined in base units",
            "give a BaseUnit, so that tools can convert",
        )
    real = [v for v in subject.model.modelVariables if v.type in ("Real", "Float64", "Float32")]
    if real and not defined:
        return passed("no variable has a unit, so that no tool can compare any")
    return passed(f"{len(defined)} units mean what their names say")


def _problem(unit: Any) -> str:
    """Return how a unit contradicts its name; empty where it does not, or nobody can tell."""
    base = unit.baseUnit
    known = _meaning(unit.name)
    if base is None or known is None:
        return ""
    exponents, factor, is_offset = known
    its = {dimension: int(getattr(base, symbol)) for symbol, dimension in _BASES.items()}
    if {key: value for key, value in its.items() if value} != exponents:
        return f"{unit.name} is defined with other base units than its name has"
    if is_offset or float(base.offset):
        return ""
    if not math.isclose(float(base.factor), factor, rel_tol=_TOLERANCE):
        return f"{unit.name} is defined with the factor {base.factor}, and its name says {factor:g}"
    return ""


def _meaning(name: str) -> tuple[dict[str, int], float, bool] | None:
    """Return exponents of dimensions and the factor to SI of a name; None where it is unknown."""
    import pint

    try:
        quantity = pint.get_application_registry().Quantity(1.0, name.replace(".", "*"))
        dimensions = {key: value for key, value in dict(quantity.dimensionality).items()}
        is_offset = not quantity._is_multiplicative
        factor = 1.0 if is_offset else float(quantity.to_base_units().magnitude)
    except Exception:  # whatever a strange name does to the reader
        return None
    if not set(dimensions) <= set(_BASES.values()):
        return None
    if any(value != int(value) for value in dimensions.values()):
        return None
    return {key: int(value) for key, value in dimensions.items()}, factor, is_offset
