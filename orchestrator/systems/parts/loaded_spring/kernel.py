"""Load less spring force, at the end of a step."""

import math

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel

from .declarations import DIVERGED, LAYOUT

V = LAYOUT.scalar


@kernel
def initialise(w, x, k):
    """Keep nothing from the initialisation."""
    return OK


@kernel
def evaluate(w, x, k):
    """Compute the force at the start, the time 0."""
    return _balance(0.0, w)


@kernel
def step(t, h, w, x, k):
    """Compute the force at the end of the step, for the displacement that is given."""
    return _balance(t + h, w)


@kernel
def _balance(time, w):
    load = w[V.amplitude] * math.sin(w[V.angular_frequency] * time)
    w[V.force] = load - w[V.stiffness] * w[V.displacement]
    return OK if math.isfinite(w[V.force]) else DIVERGED
