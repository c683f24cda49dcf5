"""Samples of the posterior by the affine-invariant ensemble sampler emcee.

Foreman-Mackey, Hogg, Lang and Goodman 2013, Publ. Astron. Soc. Pac. 125, 306, with differential
evolution as its move (ter Braak 2006), which copes with narrow and bent posteriors.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..frame import Count, FloatArray

BURNT = 0.4
"""Part of the steps, from the first on, that is left out."""

LogLikelihood = Callable[[FloatArray], FloatArray]
"""Takes places from 0 to 1 of the ranges, and returns the logarithm for each measured value."""


@dataclass(frozen=True)
class Posterior:
    """Samples of the posterior, all of the same weight.

    Attributes
    ----------
    places : array of float, shape (samples, parameters)
        From 0 to 1 of the ranges.
    pointwise : array of float, shape (samples, n)
        Logarithms of the likelihood of each measured value.
    accepted : float
        Part of the steps that were accepted.
    correlation : float
        Largest integrated autocorrelation time (steps) of a parameter; infinite if a walker has
        not moved.
    steps : int
        Steps of each walker that are kept.
    """

    places: FloatArray
    pointwise: FloatArray
    accepted: float
    correlation: float
    steps: int

    @property
    def effective(self) -> float:
        """Number of independent samples that these are worth."""
        return len(self.places) / max(1.0, self.correlation)


def sample(
    likelihood: LogLikelihood,
    dimensions: int,
    walkers: int,
    steps: int,
    seed: int,
    workers: int,
    count: Count,
) -> Posterior:
    """Sample the posterior under a uniform prior over the unit cube.

    Parameters
    ----------
    likelihood : callable
        Of the measured values.
    dimensions, walkers, steps : int
        Number of parameters, of walkers, and of their steps.
    seed : int
        Of the sampler.
    workers : int
        Threads on which walkers are evaluated; the result does not depend on it.
    count : Count
        Called with the numbers of steps done and of all.

    Returns
    -------
    Posterior
    """
    from emcee import EnsembleSampler
    from emcee.moves import DEMove, DESnookerMove

    with ThreadPoolExecutor(workers) as pool:

        def log_probability(places: FloatArray) -> Any:
            if np.any(places < 0.0) or np.any(places > 1.0):
                return -np.inf, outside
            values = likelihood(places)
            return float(values.sum()), values

        first = _start(likelihood, dimensions, walkers, seed, pool)
        outside = np.zeros_like(likelihood(first[0]))
        sampler = EnsembleSampler(
            walkers,
            dimensions,
            log_probability,
            pool=pool,
            moves=[(DEMove(), 0.8), (DESnookerMove(), 0.2)],
        )
        sampler.random_state = np.random.RandomState(seed).get_state()
        for done, _ in enumerate(sampler.sample(first, iterations=steps), 1):
            count(done, steps)
    return _collected(sampler, steps)


def _collected(sampler: Any, steps: int) -> Posterior:
    burnt = round(BURNT * steps)
    with np.errstate(invalid="ignore"):  # a walker that has not moved has no such time
        times = sampler.get_autocorr_time(discard=burnt, quiet=True, has_walkers=True, tol=0)
    longest = float(np.max(times))
    blobs = sampler.get_blobs(discard=burnt, flat=True)
    return Posterior(
        sampler.get_chain(discard=burnt, flat=True),
        np.asarray(blobs, float),
        float(np.mean(sampler.acceptance_fraction)),
        longest if np.isfinite(longest) else np.inf,
        steps - burnt,
    )


def _start(
    likelihood: LogLikelihood, dimensions: int, walkers: int, seed: int, pool: ThreadPoolExecutor
) -> FloatArray:
    """Return the best of a Sobol sequence over the cube, one for each walker."""
    from scipy.stats.qmc import Sobol

    most = int(np.ceil(np.log2(8 * walkers)))
    places = Sobol(dimensions, seed=seed).random_base2(most)
    heights = [float(values.sum()) for values in pool.map(likelihood, places)]
    return np.asarray(places[np.argsort(heights)[::-1][:walkers]])
