"""Percentiles of samples with the confidence that their number gives.

Order statistics, without any assumed distribution.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CONFIDENCE = 0.95
"""Confidence of all intervals."""
SHARES = (0.50, 0.90, 0.95, 0.99)
"""Parts of the population whose percentiles are reported."""


@dataclass(frozen=True)
class Percentile:
    """Value below which a share of the population lies, and an interval that covers it.

    Attributes
    ----------
    share : float
        Part of the population.
    value : float
        Of the sample.
    low, high : float or None
        Bounds of the interval; None where the sample is too small for a bound.
    """

    share: float
    value: float
    low: float | None
    high: float | None


def percentile(
    ordered: NDArray[np.floating], share: float, confidence: float = CONFIDENCE
) -> Percentile:
    """Return a percentile of a sample and its confidence interval.

    The interval lies between two order statistics, as the number of values below the percentile is
    binomial. Source: Conover 1999, Practical Nonparametric Statistics, sec. 3.2.

    Parameters
    ----------
    ordered : array of float, shape (n,)
        Values in ascending order.
    share : float
        Part of the population.
    confidence : float
        Of the interval, at least.

    Returns
    -------
    Percentile
        Its value is the smallest that is not exceeded by at least ``share`` of the sample.
    """
    from scipy.stats import quantile_test

    test = quantile_test(ordered, p=share)
    low, high = test.confidence_interval(confidence)
    return Percentile(share, float(_not_exceeded(ordered, share)), _bound(low), _bound(high))


def _bound(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def _not_exceeded(ordered: NDArray[np.floating], share: float) -> float:
    """Return the smallest value that at least this share of an ordered sample does not exceed."""
    return ordered[rank(len(ordered), share)]


def rank(count: int, share: float) -> int:
    """Return the place, from 0, of the smallest value that a share of so many does not exceed."""
    return max(0, math.ceil(count * share - 1e-9) - 1)


def proportion(hits: int, count: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Return an interval that covers a probability.

    The exact one of Clopper and Pearson 1934, in closed form; ``scipy.stats.binomtest`` finds the
    same by iteration, to 12 digits.

    Parameters
    ----------
    hits, count : int
        Successes, and independent trials.
    confidence : float
        Of the interval, at least.

    Returns
    -------
    low, high : float
        Bounds of the interval.
    """
    from scipy.stats import beta

    tail = 0.5 * (1.0 - confidence)
    low = float(beta.ppf(tail, hits, count - hits + 1)) if hits else 0.0
    high = float(beta.isf(tail, hits + 1, count - hits)) if hits < count else 1.0
    return low, high


def envelope(peaks: NDArray[np.float32]) -> dict[str, NDArray[np.float64]]:
    """Return the largest values and percentiles at each station.

    Parameters
    ----------
    peaks : array of float32, shape (trials, stations)
        Largest values of each trial, negative where its rock did not come by.

    Returns
    -------
    dict of str to array of float, shape (stations,)
        ``max``, ``p50`` ... ``p99``; NaN where no rock came by.
    """
    names = {f"p{100 * share:.0f}": share for share in SHARES}
    curves = {name: np.full(peaks.shape[1], np.nan) for name in ("max", *names)}
    for i in range(peaks.shape[1]):
        here = np.sort(peaks[peaks[:, i] >= 0.0, i])
        if len(here):
            curves["max"][i] = here[-1]
            for name, share in names.items():
                curves[name][i] = _not_exceeded(here, share)
    return curves


# --- distributions that may be drawn ---

_CRITICAL = 0.752
"""Largest A2* at which normality is not rejected at 5 %, mean and deviation being fitted.

Source: Stephens 1986, in D'Agostino and Stephens, Goodness-of-fit techniques, table 4.7."""
_FEWEST = 8
"""Values from which on the test means something."""


def fitting(values: NDArray[np.float64]) -> str:
    """Return the distribution that a test does not reject at 5 %: normal, else lognormal.

    The test is that of Anderson and Darling, with mean and deviation of the sample.

    Parameters
    ----------
    values : array of float, shape (n,)
        A sample.

    Returns
    -------
    str
        ``normal``, ``lognormal``, or empty if both are rejected, or the sample is too small.
    """
    if len(values) < _FEWEST:
        return ""
    if _is_normal(values):
        return "normal"
    return "lognormal" if values.min() > 0.0 and _is_normal(np.log(values)) else ""


def _is_normal(values: NDArray[np.float64]) -> bool:
    from scipy.special import log_ndtr

    deviation = float(values.std(ddof=1))
    if deviation <= 1e-9 * float(np.abs(values).max()):
        return False
    z = (np.sort(values) - values.mean()) / deviation
    n = len(z)
    weights = 2.0 * np.arange(1, n + 1) - 1.0
    square = -n - float((weights * (log_ndtr(z) + log_ndtr(-z[::-1]))).sum()) / n
    return square * (1.0 + 0.75 / n + 2.25 / n**2) <= _CRITICAL
