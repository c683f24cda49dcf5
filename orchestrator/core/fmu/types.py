"""Types of numbers as FMI calls pass them, of FMI 2.0 and 3.0.

The master keeps every number as float64. A type says how a call holds it, and which numbers it can
hold.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .slave import BOOLEAN, INTEGER, REAL

LARGEST_WHOLE = 2.0**53 - 1.0
"""Largest whole number that no other one is rounded to in a float64."""
MORE_BITS = "a whole number of more than 53 bits, which an exchange cannot hold exactly"
"""Why a larger one is refused."""


@dataclass(frozen=True)
class NumberType:
    """A type of numbers in FMI calls.

    Attributes
    ----------
    name : str
        Key of :data:`TYPES`.
    kind : str
        Real, Integer or Boolean: values of one kind can be connected.
    call : str
        End of the names of the functions that move it: ``Float64`` of ``fmi3GetFloat64``.
    number : numpy.dtype
        A value in memory.
    is_counted : bool
        Whether calls tell the number of values too, as those of FMI 3.0 do.
    """

    name: str
    kind: str
    call: str
    number: np.dtype[Any]
    is_counted: bool

    @property
    def low(self) -> float:
        """Return the smallest number that it holds and that a float64 holds exactly."""
        return max(-LARGEST_WHOLE, self._limits[0]) if self.is_whole else self._limits[0]

    @property
    def high(self) -> float:
        """Return the largest number that it holds and that a float64 holds exactly."""
        return min(LARGEST_WHOLE, self._limits[1]) if self.is_whole else self._limits[1]

    @property
    def is_whole(self) -> bool:
        """Tell whether its values are whole numbers."""
        return self.kind != REAL

    @property
    def _limits(self) -> tuple[float, float]:
        if self.kind == BOOLEAN:
            return 0.0, 1.0
        number: Any = self.number
        limits: Any = np.iinfo(number) if self.is_whole else np.finfo(number)
        return float(limits.min), float(limits.max)


BOOLEAN_3 = "Boolean (FMI 3.0)"
"""Type of a truth value that takes one byte."""

_WHOLE = [f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)]

TYPES = {
    made.name: made
    for made in (
        NumberType(REAL, REAL, REAL, np.dtype(np.float64), False),
        NumberType(INTEGER, INTEGER, INTEGER, np.dtype(np.int32), False),
        NumberType(BOOLEAN, BOOLEAN, BOOLEAN, np.dtype(np.int32), False),
        NumberType("Float32", REAL, "Float32", np.dtype(np.float32), True),
        NumberType("Float64", REAL, "Float64", np.dtype(np.float64), True),
        NumberType(BOOLEAN_3, BOOLEAN, "Boolean", np.dtype(np.bool_), True),
        *(NumberType(name, INTEGER, name, np.dtype(name.lower()), True) for name in _WHOLE),
    )
}
"""All types by name: those of FMI 2.0 (Real, Integer, Boolean), then those of FMI 3.0."""

TYPES_2 = tuple(name for name, made in TYPES.items() if not made.is_counted)
"""Types that an FMU of FMI 2.0 has."""
TYPES_3 = tuple(name for name, made in TYPES.items() if made.is_counted)
"""Types that an FMU of FMI 3.0 has. An enumeration travels as Int64."""
