"""Displacement of the spring from the force on it."""

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
    """Compute the displacement for the force that is given."""
    w[V.displacement] = w[V.force] / w[V.stiffness]
    return OK if math.isfinite(w[V.displacement]) else DIVERGED


@kernel
def step(t, h, w, x, k):
    """Compute the displacement for the force that is given now."""
    return evaluate(w, x, k)
