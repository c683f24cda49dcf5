"""Small statistics of measured and computed peaks: power laws, errors, predictions of a value from all others."""

from collections.abc import Callable, Sequence

import numpy as np

Predictor = Callable[[Sequence[float], Sequence[float], float], float]
"""From known x and y to the y at another x."""


def power_law(x: Sequence[float], y: Sequence[float]) -> tuple[float, float]:
    """Factor and exponent of y = factor * x ** exponent, by least squares of the logarithms."""
    exponent, logarithm = np.polyfit(np.log(x), np.log(y), 1)
    return float(np.exp(logarithm)), float(exponent)


def line_through_origin(x: Sequence[float], y: Sequence[float]) -> tuple[float, float]:
    """Slope of y = slope * x by least squares, and R2, the part of the variance of y that it explains."""
    known, values = np.asarray(x, float), np.asarray(y, float)
    slope = float(known @ values / (known @ known))
    return slope, float(
        1.0 - np.sum((values - slope * known) ** 2) / np.sum((values - values.mean()) ** 2)
    )


def exponent_error(x: Sequence[float], y: Sequence[float]) -> float:
    """Standard error of the exponent of :func:`power_law`."""
    from scipy.stats import linregress

    return float(linregress(np.log(x), np.log(y)).stderr)


def constant(x: Sequence[float], y: Sequence[float], at: float) -> float:
    """The mean of all y, whatever x is."""
    return float(np.mean(y))


def by_power_law(x: Sequence[float], y: Sequence[float], at: float) -> float:
    """The power law through the points, at another x."""
    factor, exponent = power_law(x, y)
    return factor * at**exponent


def leave_one_out(x: Sequence[float], y: Sequence[float], predictor: Predictor) -> list[float]:
    """Each y, predicted from all the others."""

    def others(values: Sequence[float], i: int) -> list[float]:
        return [*values[:i], *values[i + 1 :]]

    return [predictor(others(x, i), others(y, i), x[i]) for i in range(len(x))]


def mean_absolute_error(predicted: Sequence[float], measured: Sequence[float]) -> float:
    """Mean of |predicted / measured - 1|."""
    return float(np.mean(np.abs(np.divide(predicted, measured) - 1.0)))
