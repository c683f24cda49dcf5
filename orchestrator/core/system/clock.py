"""Time as whole ticks: steps add up exactly.

A time in seconds is computed from its tick and never accumulated. A tick is a picosecond, unless a
time is none of them: then it is the largest fraction of a second of which all times of the run are
whole multiples, 1/60 s for instance.
"""

from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction
from math import lcm, ulp
from typing import Any

from .quantities import in_si

PICOSECONDS = 10**12
"""Ticks in a second where nothing else is needed: steps in use go down to 1e-7 s, and a step that
follows from a wave speed needs a few digits more. In 64 bits, that reaches over 50 days."""

_MOST = 2**62
"""Longest time in ticks, so that sums of two times hold in 64 bits as well; 53 days of
picoseconds."""
_DENOMINATOR = 10**6
"""Largest denominator of a fraction of a second that is no decimal number."""


def seconds_in(text: str) -> float:
    """Return the time (s) that a text has.

    Parameters
    ----------
    text : str
        A number, with a unit or in s, or a fraction of two whole numbers: ``1/60``.

    Returns
    -------
    float
        The one nearest to it.

    Raises
    ------
    ValueError
        It is none of them.
    """
    if text.strip() and "/" not in text:
        return in_si(text, "s")
    try:
        return float(Fraction(text))
    except (ValueError, ZeroDivisionError, OverflowError):
        what = f"{text[:40]!r} is no time: write a number of seconds, or a fraction, 1/60"
        raise ValueError(what) from None


def from_text(value: Any) -> Any:
    """Return the time of a text or a fraction, ``20 ms``, ``1/60``, in s; all else as it is."""
    return seconds_in(str(value)) if isinstance(value, Fraction | str) else value


def exact(seconds: float) -> Fraction:
    """Return the number that a time stands for, as far as a float can tell.

    Parameters
    ----------
    seconds : float
        Time (s).

    Returns
    -------
    Fraction
        A whole number of picoseconds where there is one next to it (3 * 0.1 is 0.3), else the
        fraction of two whole numbers that it is nearest to: 1/60, 1/44100.

    Raises
    ------
    ValueError
        It is neither.
    """
    margin = 2 * Decimal(ulp(seconds))
    picoseconds = Decimal(seconds) * PICOSECONDS
    whole = picoseconds.to_integral_value()
    is_some = bool(whole) or not seconds  # 5e-324 s is not none
    if is_some and abs(picoseconds - whole) <= margin * PICOSECONDS:
        return Fraction(int(whole), PICOSECONDS)
    simple = Fraction(seconds).limit_denominator(_DENOMINATOR)
    if simple and abs(simple - Fraction(seconds)) <= Fraction(margin):
        return simple
    raise ValueError(f"{seconds!r} s is no whole number of picoseconds, and no fraction like 1/60")


def ticks_per_second(times: Iterable[Fraction]) -> int:
    """Return the number of ticks in a second with which all these times (s) are whole."""
    denominators = [time.denominator for time in times]
    if all(PICOSECONDS % denominator == 0 for denominator in denominators):
        return PICOSECONDS
    return lcm(*denominators)


def to_ticks(time: Fraction, rate: int = PICOSECONDS) -> int:
    """Count the ticks in a time.

    Parameters
    ----------
    time : Fraction
        Time (s), of :func:`exact`.
    rate : int
        Ticks in a second, of :func:`ticks_per_second`.

    Returns
    -------
    int

    Raises
    ------
    ValueError
        More ticks than 64 bits hold.
    """
    ticks = time * rate
    assert ticks.denominator == 1, f"{time} s is no whole number of ticks"
    if abs(ticks) > _MOST or rate > _MOST:
        longest = _MOST / rate
        raise ValueError(f"{float(time):g} s is beyond the longest time, {longest:.3g} s")
    return int(ticks)


def to_seconds(ticks: int, rate: int = PICOSECONDS) -> float:
    """Return a time in ticks in s, the same to the bit as in the compiled loop."""
    return float(ticks) / float(rate)


def fraction_near(seconds: float) -> str:
    """Return the fraction that a rounded time was meant to be: ``1/60`` for 0.016666667 s.

    Parameters
    ----------
    seconds : float
        Time (s), greater than 0.

    Returns
    -------
    str
        Empty where there is no such fraction next to it, or where it is exact in picoseconds.
    """
    parts = max(1, round(1.0 / seconds))
    difference = abs(parts * seconds - 1.0)
    is_meant = 0.0 < difference < min(1e-4, 1e-2 / parts) and PICOSECONDS % parts != 0
    return f"1/{parts}" if is_meant else ""
