"""The table over time; it begins at the time 0."""

import math

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel

from .declarations import LAYOUT

V = LAYOUT.scalar


@kernel
def initialise(w, x, k):
    """Stand at the time 0."""
    return _show(0.0, w)


@kernel
def evaluate(w, x, k):
    """Leave the outputs: nothing acts on the table."""
    return OK


@kernel
def step(t, h, w, x, k):
    """Move to the end of the step."""
    return _show(t + h, w)


@kernel
def _show(time, w):
    phase = w[V.angular_frequency] * time
    w[V.position_y] = w[V.amplitude] * math.sin(phase)
    w[V.velocity_y] = w[V.amplitude] * w[V.angular_frequency] * math.cos(phase)
    w[V.acceleration_y] = -w[V.angular_frequency] * w[V.angular_frequency] * w[V.position_y]
    return OK
