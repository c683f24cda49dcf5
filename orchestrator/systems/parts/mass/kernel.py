"""The mass in time, in closed form under a force that is constant in a step."""

import math

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel

from .declarations import DIVERGED, LAYOUT

V = LAYOUT.scalar


@kernel
def initialise(w, x, k):
    """Set position, velocity and energies at the start."""
    w[V.position_y] = w[V.position0_y]
    w[V.velocity_y] = w[V.velocity0_y]
    w[V.energy_work] = 0.0
    w[V.energy_start] = 0.0
    _account(w)
    w[V.energy_start] = w[V.energy_kinetic] + w[V.energy_elastic]
    w[V.energy_residual] = 0.0
    return OK


@kernel
def evaluate(w, x, k):
    """Leave the outputs at the start: no output follows from an input."""
    return OK


@kernel
def step(t, h, w, x, k):
    """Advance by h (s) under a constant force."""
    force, before = w[V.force_y], w[V.position_y]
    if w[V.stiffness] > 0.0:
        rate = math.sqrt(w[V.stiffness] / w[V.mass])
        rest = force / w[V.stiffness]
        away = before - rest
        cosine, sine = math.cos(rate * h), math.sin(rate * h)
        w[V.position_y] = rest + away * cosine + w[V.velocity_y] / rate * sine
        w[V.velocity_y] = w[V.velocity_y] * cosine - away * rate * sine
    else:
        gained = force / w[V.mass] * h
        w[V.position_y] = before + (w[V.velocity_y] + 0.5 * gained) * h
        w[V.velocity_y] += gained
    w[V.energy_work] += force * (w[V.position_y] - before)
    _account(w)
    return OK if math.isfinite(w[V.position_y]) else DIVERGED


@kernel
def _account(w):
    """Write energies and the error of their balance."""
    w[V.energy_kinetic] = 0.5 * w[V.mass] * w[V.velocity_y] * w[V.velocity_y]
    w[V.energy_elastic] = 0.5 * w[V.stiffness] * w[V.position_y] * w[V.position_y]
    stored = w[V.energy_kinetic] + w[V.energy_elastic]
    w[V.energy_residual] = stored - w[V.energy_work] - w[V.energy_start]
