"""Butterworth low-pass filters of even order, for curves of some thousand rows.

The same as ``scipy.signal`` to rounding, which a test compares. It is written out here because every run shows filtered forces, and
importing scipy.signal takes as long as the run.
"""

import math

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

_EDGE = 3
"""Rows that are added at each end for a filter without shift in time, in orders of the filter and one more."""


def looking_back(values: Values, cut_off: float, rate: float, order: int) -> Values:
    """Filtered values that lag, as a measuring device's do; before the first value it is taken to have been steady.

    cut_off: Hz. rate: values in a second.
    """
    filtered: list[float] = values.tolist()
    for section in _sections(cut_off, rate, order):
        filtered = _filtered(filtered, *section)
    return np.array(filtered)


def without_shift(values: Values, cut_off: float, rate: float, order: int) -> Values:
    """Values that are filtered forwards and then backwards, so that nothing lags; both ends are continued by their reflection in
    the end's value.

    Raises:
        ValueError: fewer values than are needed at the ends.
    """
    edge = fewest(order) - 1
    if values.size <= edge:
        raise ValueError(f"{values.size} values, and more than {edge} are needed")
    longer = np.concatenate((2.0 * values[0] - values[edge:0:-1], values, 2.0 * values[-1] - values[-2:-edge - 2:-1]))
    for _ in range(2):
        longer = looking_back(longer, cut_off, rate, order)[::-1]
    return longer[edge:-edge].copy()


def fewest(order: int) -> int:
    """How many values :func:`without_shift` needs."""
    return _EDGE * (order + 1) + 1


def _sections(cut_off: float, rate: float, order: int) -> list[tuple[float, float, float]]:
    """Gain and two coefficients of each section gain (1 + 2/z + 1/z2) / (1 + a/z + b/z2): pairs of poles on a circle, by the
    bilinear transform."""
    k = math.tan(math.pi * cut_off / rate)
    found = []
    for pair in range(order // 2):
        damping = 2.0 * math.cos(math.pi * (2 * pair + 1) / (2 * order))
        whole = 1.0 + damping * k + k * k
        found.append((k * k / whole, 2.0 * (k * k - 1.0) / whole, (1.0 - damping * k + k * k) / whole))
    return found


def _filtered(values: list[float], gain: float, a: float, b: float) -> list[float]:
    """Values after one section, steady before the first one: there the gain is 1."""
    first = values[0]
    one, two = first * (1.0 - gain), first * (gain - b)
    found = []
    for value in values:
        shown = gain * value + one
        one, two = 2.0 * gain * value - a * shown + two, gain * value - b * shown
        found.append(shown)
    return found
