"""Envelopes of many trials along a slope, and distributions that may be drawn over them."""

import numpy as np
from numpy.typing import NDArray

from ..metrics.percentiles import SHARES, needed, not_exceeded


def envelope(peaks: NDArray[np.float32]) -> dict[str, NDArray[np.float64]]:
    """Return the largest values and percentiles at each station.

    Parameters
    ----------
    peaks : array of float32, shape (trials, stations)
        Largest values of each trial, negative where its rock did not come by.

    Returns
    -------
    dict of str to array of float, shape (stations,)
        ``max``, ``p50`` ... ``p99``; NaN where no rock came by, or too few for the percentile.
    """
    names = {f"p{100 * share:.0f}": share for share in SHARES}
    curves = {name: np.full(peaks.shape[1], np.nan) for name in ("max", *names)}
    for i in range(peaks.shape[1]):
        here = np.sort(peaks[peaks[:, i] >= 0.0, i])
        if len(here):
            curves["max"][i] = here[-1]
        for name, share in names.items():
            if needed(share) <= len(here):
                curves[name][i] = not_exceeded(here, share)
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
