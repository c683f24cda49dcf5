"""The light mass in time: velocity first, then the position, once in a communication step."""

import math

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel

from .declarations import DIVERGED, LAYOUT

V = LAYOUT.scalar


@kernel
def initialise(w, x, k):
    """Set position, velocity and stable step at the start."""
    w[V.position_y] = w[V.position0_y]
    w[V.velocity_y] = w[V.velocity0_y]
    w[V.stable_step] = 2.0 * math.sqrt(w[V.mass] / (w[V.stiffness] + w[V.partner_stiffness]))
    return OK


@kernel
def evaluate(w, x, k):
    """Compute the force on the partner and the energies."""
    way = w[V.partner_position_y] - w[V.position_y]
    w[V.partner_force_y] = -w[V.partner_stiffness] * way
    w[V.energy_kinetic] = 0.5 * w[V.mass] * w[V.velocity_y] * w[V.velocity_y]
    ground = 0.5 * w[V.stiffness] * w[V.position_y] * w[V.position_y]
    w[V.energy_elastic] = ground + 0.5 * w[V.partner_stiffness] * way * way
    return OK if math.isfinite(w[V.position_y]) else DIVERGED


@kernel
def step(t, h, w, x, k):
    """Advance by h (s) in one explicit step."""
    pull = w[V.partner_stiffness] * (w[V.partner_position_y] - w[V.position_y])
    force = pull - w[V.stiffness] * w[V.position_y]
    w[V.velocity_y] += force / w[V.mass] * h
    w[V.position_y] += w[V.velocity_y] * h
    return evaluate(w, x, k)
