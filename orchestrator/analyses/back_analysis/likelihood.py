"""How likely measured end points are where the ground has given values.

The model: a measured value is a computed one plus a normal deviation of the stated scatter, and one
in a hundred is anything (uniform over the profile). Its density is estimated from trials with the
same random numbers for all values of the parameters (common random numbers), which makes it a
function of them without noise. With N trials it is a mixture of N normal densities.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...campaigns.campaign import Campaign, TrialRecords, compute
from ..frame import FloatArray
from .endpoints import Observed

ANYTHING = 0.01
"""Part of the measured values that may be anything."""
_ROOT = float(np.sqrt(2.0 * np.pi))


@dataclass(frozen=True)
class Likelihood:
    """Likelihood of what was measured.

    Attributes
    ----------
    observed : sequence of Observed
        End points first.
    trials : int
        Number of the trials for each evaluation.
    """

    observed: Sequence[Observed]
    trials: int

    def pointwise(self, campaign: Campaign) -> FloatArray:
        """Return the logarithm of the likelihood of each measured value.

        Parameters
        ----------
        campaign : Campaign
            With the values of the ground that are tried.

        Returns
        -------
        array of float, shape (values of all quantities,)
        """
        records = compute(campaign, 0, self.trials)
        return np.concatenate([self._of(entry, records) for entry in self.observed])

    def _of(self, observed: Observed, records: TrialRecords) -> FloatArray:
        computed = observed.computed(records)
        reach = np.ptp(observed.values) + 10.0 * observed.scatter
        away = (observed.values[:, None] - computed[None, :]) / observed.scatter
        density = np.exp(-0.5 * away**2).sum(axis=1) / (_ROOT * observed.scatter * self.trials)
        return np.asarray(np.log((1.0 - ANYTHING) * density + ANYTHING / reach))


def held_out(pointwise: FloatArray, folds: int, seed: int) -> tuple[NDArray[np.int64], FloatArray]:
    """Return weights of the posterior samples without each fold of the measured values.

    The posterior without some values follows from the whole one by importance weights, the inverse
    of the likelihood of these values (Gelfand, Dey and Chang 1992).

    Parameters
    ----------
    pointwise : array of float, shape (samples, n)
        Logarithms of the likelihood of each value.
    folds : int
        Number of folds.
    seed : int
        Of the division.

    Returns
    -------
    fold : array of int, shape (n,)
        Number of the fold of each value.
    weights : array of float, shape (folds, samples)
        Their sum is 1 for each fold.
    """
    n = pointwise.shape[1]
    fold = np.random.default_rng(seed).permutation(n) % folds
    weights = np.empty((folds, len(pointwise)))
    for number in range(folds):
        logarithm = -pointwise[:, fold == number].sum(axis=1)
        weights[number] = np.exp(logarithm - logarithm.max())
    weights /= weights.sum(axis=1, keepdims=True)
    return fold, weights
