"""Quantities as fields of input files: read in SI, and doubted beyond what is usual."""

import math
from dataclasses import dataclass
from typing import Any

from rockshed.components.common.plausible import Plausible

from ..core.system.quantities import in_si


@dataclass(frozen=True)
class InUnit:
    """Reads texts as quantities of one kind; for ``BeforeValidator`` of pydantic.

    Attributes
    ----------
    unit : str
        SI unit of the value, a key of :data:`rockshed.components.common.units.UNITS`.
    """

    unit: str

    def __call__(self, value: Any) -> Any:
        """Return the value of a text in SI; anything else as it is.

        Parameters
        ----------
        value : Any
            As it stands in a file.

        Raises
        ------
        ValueError
            It is no quantity of this kind.
        """
        return in_si(value, self.unit) if isinstance(value, str) else value


def doubt(value: float, unit: str, plausible: Plausible) -> str | None:
    """Return why a value is doubted, with the unit in which it may have been meant.

    Parameters
    ----------
    value : float
        In ``unit``.
    unit : str
        Key of :data:`rockshed.components.common.units.UNITS`.
    plausible : Plausible
        Range of the quantity in practice.

    Returns
    -------
    str or None
        Continues the name of the value; None where it is within the range.
    """
    if plausible.holds(value) or not math.isfinite(value):  # refused elsewhere
        return None
    suffix = "" if unit == "1" else f" {unit}"
    usual = f"{plausible.low:g} to {plausible.high:g}{suffix}"
    text = f"is {value:.6g}{suffix}, and {usual} are usual"
    for likely in plausible.likely:
        meant = in_si(f"{value!r} {likely}", unit)
        if plausible.holds(meant):
            return f"{text}; if {value:.6g} {likely} is meant, write that unit: {meant:.4g}{suffix}"
    return text
