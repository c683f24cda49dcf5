"""Parameters that were inferred, with the measured values that they were inferred from."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..frame import FloatArray
from .endpoints import Observed
from .parameters import Parameter, values_at
from .sampling import Posterior


@dataclass(frozen=True)
class Inferred:
    """Samples of the parameters.

    Attributes
    ----------
    parameters : sequence of Parameter
        With the ranges in which they were sought.
    observed : sequence of Observed
        End points first.
    posterior : Posterior
        Samples.
    seed, trials : int
        Of the sampler, and trials for each evaluation.
    """

    parameters: Sequence[Parameter]
    observed: Sequence[Observed]
    posterior: Posterior
    seed: int
    trials: int

    @cached_property
    def values(self) -> FloatArray:
        """Values (SI) of the samples, shape (samples, parameters)."""
        return values_at(self.parameters, self.posterior.places)

    @cached_property
    def best(self) -> FloatArray:
        """Values of the likeliest sample, shape (parameters,)."""
        likeliest = int(np.argmax(self.posterior.pointwise.sum(axis=1)))
        return np.asarray(self.values[likeliest])

    @property
    def end_points(self) -> FloatArray:
        """Measured end points (m), in the order of the file."""
        return self.observed[0].values
