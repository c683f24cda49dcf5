"""The buffer in time, by the trapezoidal rule: the balance of energy closes for any step."""

import math

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel

from .declarations import DIVERGED, LAYOUT

V = LAYOUT.scalar

UNBOUNDED_STEP = 1e6
"""Published as stable step (s): every step is stable."""


@kernel
def initialise(w, x, k):
    """Rest at the position of the start."""
    w[V.position_y] = 0.0
    w[V.velocity_y] = 0.0
    w[V.energy_damping] = 0.0
    w[V.energy_work_contact] = 0.0
    w[V.stable_step] = UNBOUNDED_STEP
    return OK


@kernel
def evaluate(w, x, k):
    """Compute what follows from the state."""
    position = w[V.position_y]
    velocity = w[V.velocity_y]
    w[V.compression] = -position
    w[V.ground_force_y] = -w[V.stiffness] * position - w[V.damping] * velocity
    w[V.energy_kinetic] = 0.5 * w[V.mass] * velocity * velocity
    w[V.energy_elastic] = 0.5 * w[V.stiffness] * position * position
    stored = w[V.energy_kinetic] + w[V.energy_elastic]
    w[V.energy_residual] = stored + w[V.energy_damping] - w[V.energy_work_contact]
    return OK if math.isfinite(position) else DIVERGED


@kernel
def step(t, h, w, x, k):
    """Advance with the mean velocity of the step, which the equation of motion gives at its middle."""
    position = w[V.position_y]
    velocity = w[V.velocity_y]
    inertia = 2.0 * w[V.mass] / h
    driving = w[V.force_y] - w[V.stiffness] * position + inertia * velocity
    mean = driving / (inertia + 0.5 * h * w[V.stiffness] + w[V.damping])
    w[V.position_y] = position + h * mean
    w[V.velocity_y] = 2.0 * mean - velocity
    w[V.energy_damping] += w[V.damping] * mean * mean * h
    w[V.energy_work_contact] += w[V.force_y] * mean * h
    return evaluate(w, x, k)
