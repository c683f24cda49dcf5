"""Statistics of measured and computed peaks: power laws, errors, predictions."""

from collections.abc import Callable, Sequence

import numpy as np

Predictor = Callable[[Sequence[float], Sequence[float], float], float]
"""Function of known x and y that gives the y at another x."""


def power_law(x: Sequence[float], y: Sequence[float]) -> tuple[float, float]:
    """Return factor and exponent of y = factor * x ** exponent, by least squares of logarithms."""
    exponent, logarithm = np.polyfit(np.log(x), np.log(y), 1)
    return float(np.exp(logarithm)), float(exponent)


def line_through_origin(x: Sequence[float], y: Sequence[float]) -> tuple[float, float]:
    """Fit y = slope * x by least squares.

    Parameters
    ----------
    x, y : sequence of float
        Points.

    Returns
    -------
    slope : float
        Slope of the line through the origin.
    r2 : float
        Part of the variance of y that it explains; 0 where all y are the same, for there is none.
    """
    known = np.asarray(x, float)
    values = np.asarray(y, float)
    slope = float(known @ values / (known @ known))
    rest = np.sum((values - slope * known) ** 2)
    variance = np.sum((values - values.mean()) ** 2)
    return slope, float(1.0 - rest / variance) if variance > 0.0 else 0.0


def exponent_error(x: Sequence[float], y: Sequence[float]) -> float:
    """Return the standard error of the exponent of :func:`power_law`."""
    from scipy.stats import linregress

    return float(linregress(np.log(x), np.log(y)).stderr)


def constant(x: Sequence[float], y: Sequence[float], at: float) -> float:
    """Return the mean of all y, whatever x is."""
    return float(np.mean(y))


def by_power_law(x: Sequence[float], y: Sequence[float], at: float) -> float:
    """Return the value of the power law through the points at another x."""
    factor, exponent = power_law(x, y)
    return factor * at**exponent


def mean_of_equals(x: Sequence[float], y: Sequence[float], at: float) -> float:
    """Return the mean of the y whose x is the same."""
    return float(np.mean([value for place, value in zip(x, y, strict=True) if place == at]))


def in_proportion(x: Sequence[float], y: Sequence[float], at: float) -> float:
    """Return ``at`` times the mean ratio (geometric) of y to x."""
    return float(at * np.exp(np.mean(np.log(np.divide(y, x)))))


def leave_one_out(x: Sequence[float], y: Sequence[float], predictor: Predictor) -> list[float]:
    """Predict each y from all the others.

    Parameters
    ----------
    x, y : sequence of float
        Points.
    predictor : callable
        Function of known x and y that gives the y at another x.
    """

    def others(values: Sequence[float], i: int) -> list[float]:
        return [*values[:i], *values[i + 1 :]]

    return [predictor(others(x, i), others(y, i), x[i]) for i in range(len(x))]


def mean_absolute_error(predicted: Sequence[float], measured: Sequence[float]) -> float:
    """Return the mean of abs(predicted / measured - 1)."""
    return float(np.mean(np.abs(np.divide(predicted, measured) - 1.0)))
