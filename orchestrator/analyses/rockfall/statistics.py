"""Percentiles of samples with the confidence that their number gives: order statistics, without any assumed distribution."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CONFIDENCE = 0.95
SHARES = (0.50, 0.90, 0.95, 0.99)
"""Percentiles that are reported."""


@dataclass(frozen=True)
class Percentile:
    """Value below which a share of the population lies, and an interval that covers it; None: too small a sample for a bound."""

    share: float
    value: float
    low: float | None
    high: float | None


def ranks(count: int, share: float, confidence: float = CONFIDENCE) -> tuple[int, int]:
    """Ranks l and u, from 1, between whose order statistics the percentile lies with at least this confidence.

    The number of values below the percentile is binomial: P(X_l <= q) >= 1 - a/2 and P(X_u >= q) >= 1 - a/2. Rank 0 and rank
    count + 1 stand for no bound. Source: Conover 1999, Practical Nonparametric Statistics, sec. 3.2.
    """
    from scipy.stats import binom

    tail = 0.5 * (1.0 - confidence)
    return int(binom.ppf(tail, count, share)), int(binom.isf(tail, count, share)) + 1


def percentile(
    ordered: NDArray[np.floating], share: float, confidence: float = CONFIDENCE
) -> Percentile:
    """Of values in ascending order: the smallest that is not exceeded by at least this share of them."""
    count = len(ordered)
    low, high = ranks(count, share, confidence)
    value = ordered[max(0, math.ceil(count * share - 1e-9) - 1)]
    return Percentile(
        share,
        float(value),
        float(ordered[low - 1]) if low >= 1 else None,
        float(ordered[high - 1]) if high <= count else None,
    )


def proportion(hits: int, count: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Interval that covers a probability, from ``hits`` in ``count`` independent trials (Clopper and Pearson 1934)."""
    from scipy.stats import beta

    tail = 0.5 * (1.0 - confidence)
    low = float(beta.ppf(tail, hits, count - hits + 1)) if hits else 0.0
    high = float(beta.isf(tail, hits + 1, count - hits)) if hits < count else 1.0
    return low, high


def envelope(peaks: NDArray[np.float32]) -> dict[str, NDArray[np.float64]]:
    """Of values (trials, stations), negative where a rock did not come by: largest value and percentiles at each station.

    NaN where no rock came by.
    """
    names = ("max", *(f"p{100 * share:.0f}" for share in SHARES))
    made = {name: np.full(peaks.shape[1], np.nan) for name in names}
    for i in range(peaks.shape[1]):
        here = np.sort(peaks[peaks[:, i] >= 0.0, i])
        if len(here):
            made["max"][i] = here[-1]
            for share in SHARES:
                made[f"p{100 * share:.0f}"][i] = here[
                    max(0, math.ceil(len(here) * share - 1e-9) - 1)
                ]
    return made
