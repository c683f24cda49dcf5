"""The spring: its force follows from where it is shown the two bodies."""

import math

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel

from .declarations import DIVERGED, LAYOUT

V = LAYOUT.scalar


@kernel
def initialise(w, x, k):
    """Begin the account of its energy."""
    w[V.energy_work] = 0.0
    return OK


@kernel
def evaluate(w, x, k):
    """Compute force and energy at the start."""
    _press(w)
    w[V.energy_start] = w[V.energy_elastic]
    w[V.energy_residual] = 0.0
    return OK if math.isfinite(w[V.upper_force_y]) else DIVERGED


@kernel
def step(t, h, w, x, k):
    """Compute the force where the bodies are shown now."""
    before = w[V.energy_elastic]
    _press(w)
    w[V.energy_work] += w[V.energy_elastic] - before
    w[V.energy_residual] = w[V.energy_elastic] - w[V.energy_work] - w[V.energy_start]
    return OK if math.isfinite(w[V.upper_force_y]) else DIVERGED


@kernel
def _press(w):
    """Write compression, forces and elastic energy."""
    pressed = w[V.length] - (w[V.upper_position_y] - w[V.lower_position_y])
    stiffness = w[V.stiffness] if pressed > 0.0 else w[V.tension_ratio] * w[V.stiffness]
    w[V.compression] = pressed
    w[V.upper_force_y] = stiffness * pressed
    w[V.lower_force_y] = -w[V.upper_force_y]
    w[V.energy_elastic] = 0.5 * stiffness * pressed * pressed
