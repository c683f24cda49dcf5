"""Random numbers of rocks and starts that differ from trial to trial.

They belong to streams of their own, beyond those of the trials and of the strata of Latin
hypercubes, so that a trial draws the same numbers on its way whatever its rock is.
"""

import numpy as np

from ..common.counter_random import draw, mix, shuffled, stream
from ..common.kernels import released

_ROCKS, _ORDERS = 1 << 34, 1 << 35
"""First streams of the rocks, and of the orders of their strata."""


@released
def rock_numbers(seed, first, hypercube, numbers):
    """Draw uniform numbers in [0, 1) for the rocks of consecutive trials.

    Parameters
    ----------
    seed, first : int
        Number of the sample, and of the first trial.
    hypercube : int
        Trials of a Latin hypercube, 0 for independent numbers.
    numbers : ndarray of float64, shape (trials, n)
        Overwritten; each column is for one quantity.
    """
    for i in range(numbers.shape[0]):
        trial = first + i
        source = stream(seed, _ROCKS + trial)
        for q in range(numbers.shape[1]):
            u = draw(source, q)
            if hypercube > 0:
                key = stream(seed, _ORDERS + trial // hypercube) + mix(np.uint64(q))
                u = (shuffled(trial % hypercube, hypercube, key) + u) / hypercube
            numbers[i, q] = u
