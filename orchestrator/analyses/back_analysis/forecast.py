"""End points that inferred parameters lead to, on the slope of the data or on another one."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from rockshed.components.slope_rockfall.records import OUTCOME, RESTED

from ...campaigns.campaign import Campaign, compute
from ...sites.rockfall.preparation import PreparedSlope
from ..frame import FloatArray
from ..kept_values import KeptValues
from .inferred import Inferred
from .parameters import GroundOfValues

DRAWS = 200
"""Samples of the posterior with which a slope is computed."""
SHARES = (0.05, 0.10, 0.50, 0.90, 0.95)
"""Parts of the rocks whose percentiles are told."""
CONFIDENCE = 0.90
"""Part of the posterior that its intervals hold."""


@dataclass(frozen=True)
class Forecast:
    """End points for samples of the posterior.

    Attributes
    ----------
    name : str
        Of the slope.
    numbers : array of int, shape (draws,)
        Samples of the posterior.
    ends : array of float, shape (draws, trials)
        x (m) at the end, infinite where the rock leaves the profile.
    """

    name: str
    numbers: FloatArray
    ends: FloatArray

    def percentile(self, share: float) -> tuple[float, float, float]:
        """Return the value that a share of all rocks does not exceed, and its interval (m).

        The value is that of the mixture over the posterior; the interval holds that of a single
        set of parameters with probability :data:`CONFIDENCE`.
        """
        tail = 50.0 * (1.0 - CONFIDENCE)
        # no percentile is an average with a rock that has left the profile
        each = np.percentile(self.ends, 100.0 * share, axis=1, method="inverted_cdf")
        value = np.percentile(self.ends, 100.0 * share, method="inverted_cdf")
        low, high = np.percentile(each, [tail, 100.0 - tail], method="inverted_cdf")
        return float(value), float(low), float(high)

    @property
    def percentiles(self) -> Sequence[tuple[float, tuple[float, float, float]]]:
        """Each share with its percentile and interval."""
        return [(share, self.percentile(share)) for share in SHARES]

    @property
    def left(self) -> float:
        """Part of the rocks that leave the profile."""
        return float(np.isinf(self.ends).mean())


def forecast_of(
    slope: PreparedSlope, campaign: Campaign, inferred: Inferred, threads: int, kept: KeptValues
) -> Forecast:
    """Compute a slope with samples of the posterior.

    Parameters
    ----------
    slope : PreparedSlope
        With materials of the names of the parameters.
    campaign : Campaign
        Over it.
    inferred : Inferred
        Samples of the parameters.
    threads : int
        On which samples are computed.
    kept : KeptValues
        End points that have been computed before, to which others are added.

    Returns
    -------
    Forecast
    """
    ground = GroundOfValues(slope, campaign, [entry.name for entry in inferred.parameters])
    count = len(inferred.values)
    numbers = np.unique(np.linspace(0, count - 1, DRAWS).astype(int))

    def ends(values: FloatArray) -> FloatArray:
        tried = ground.with_values(values)
        if tried is None:
            return np.full(inferred.trials, np.nan)
        outcomes = compute(tried, 0, inferred.trials).outcomes
        rested = outcomes[:, OUTCOME.end] == RESTED
        return np.where(rested, outcomes[:, OUTCOME.x], np.inf)

    remembered = kept.of(ends, "ends", ground.about, inferred.trials)
    with ThreadPoolExecutor(threads) as pool:
        rows = np.array(list(pool.map(remembered, inferred.values[numbers])))
    good = ~np.isnan(rows).any(axis=1)
    return Forecast(slope.name, numbers[good], rows[good])
