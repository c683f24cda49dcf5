"""Percentiles of samples with the confidence that their number gives.

Order statistics, without any assumed distribution.
"""

import math
from collections.abc import Sequence
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
    low, high : float
        Bounds of the interval.
    """

    share: float
    value: float
    low: float
    high: float


def needed(share: float) -> int:
    """Return the number of values of which a percentile has an interval with both bounds.

    Between order statistics, no bound is there while all values may lie on one side of the
    percentile with more than 2.5 % probability.

    Parameters
    ----------
    share : float
        Part of the population, between 0 and 1.
    """
    tail = 0.5 * (1.0 - CONFIDENCE)
    return math.ceil(math.log(tail) / math.log(max(share, 1.0 - share)))


def borne(shares: Sequence[float], count: int) -> list[float]:
    """Return the parts whose percentiles a sample of this size bears; the others are not told."""
    return [share for share in shares if needed(share) <= count]


def percentile(
    ordered: NDArray[np.floating], share: float, confidence: float = CONFIDENCE
) -> Percentile:
    """Return a percentile of a sample and its confidence interval.

    The interval lies between two order statistics, as the number of values below the percentile is
    binomial. Source: Conover 1999, Practical Nonparametric Statistics, sec. 3.2.

    Parameters
    ----------
    ordered : array of float, shape (n,)
        Values in ascending order, as many as the percentile needs (:func:`needed`).
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
    return Percentile(share, float(not_exceeded(ordered, share)), float(low), float(high))


def not_exceeded(ordered: NDArray[np.floating], share: float) -> float:
    """Return the smallest value that at least a share of a sample does not exceed.

    Parameters
    ----------
    ordered : array of float, shape (n,)
        Sample in rising order.
    share : float
        Part of it.
    """
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
