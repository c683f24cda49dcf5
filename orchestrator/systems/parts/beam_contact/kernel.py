"""The contact: a spring that only pushes, between the ball and the middle disc."""

import math

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel, view

from .declarations import DIVERGED, LAYOUT

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def initialise(w, x, k):
    """Keep nothing from the initialisation."""
    return OK


@kernel
def evaluate(w, x, k):
    """Compute the forces where ball and beam are shown."""
    heights, forces = view(w, k, A.beam_position_y), view(w, k, A.beam_force_y)
    middle = heights.size // 2
    pressed = max(0.0, heights[middle] - w[V.ball_position_y])
    for i in range(forces.size):
        forces[i] = 0.0
    w[V.ball_force_y] = w[V.stiffness] * pressed
    forces[middle] = -w[V.ball_force_y]
    w[V.energy_elastic] = 0.5 * w[V.stiffness] * pressed * pressed
    return OK if math.isfinite(w[V.ball_force_y]) else DIVERGED


@kernel
def step(t, h, w, x, k):
    """Compute the forces where ball and beam are shown now."""
    return evaluate(w, x, k)
