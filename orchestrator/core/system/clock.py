"""Time as whole ticks: steps add up exactly.

A time in seconds is computed from its tick and never accumulated.
"""

from decimal import Decimal
from math import ulp

TICKS_PER_SECOND = 10**12
"""A tick is a picosecond: steps in use go down to 1e-7 s, and a step that follows from a wave speed
needs a few digits more. In 64 bits, that reaches over 50 days."""

_MOST = 2**62
"""Longest time in ticks: 53 days, so that sums of two times hold in 64 bits as well."""


def to_ticks(seconds: float) -> int:
    """Count the ticks in a time, as far as a float can tell: 3 * 0.1 has as many as 0.3.

    Parameters
    ----------
    seconds : float
        Time (s).

    Returns
    -------
    int

    Raises
    ------
    ValueError
        Not a whole number of ticks, or more of them than 64 bits hold.
    """
    exact = Decimal(seconds) * TICKS_PER_SECOND
    ticks = exact.to_integral_value()
    if abs(exact - ticks) > 2 * Decimal(ulp(seconds)) * TICKS_PER_SECOND:
        raise ValueError(f"{seconds!r} s is no whole number of picoseconds")
    if abs(ticks) > _MOST:
        raise ValueError(
            f"{seconds:g} s is beyond the longest time, {float(_MOST) / TICKS_PER_SECOND:.3g} s"
        )
    return int(ticks)


def to_seconds(ticks: int) -> float:
    """Return a time in ticks in s, the same to the bit as in the compiled loop."""
    return float(ticks) / float(TICKS_PER_SECOND)
