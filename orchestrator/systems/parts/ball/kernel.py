"""The ball in time: parabolas between impacts, whose times are roots of quadratic equations."""

import math

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel

from .declarations import LAYOUT, TABLE_FALLS, TOO_MANY_BOUNCES

V = LAYOUT.scalar

MOST_BOUNCES = 1000
"""Impacts in one communication step, at most."""


@kernel
def initialise(w, x, k):
    """Set height and velocity at the start."""
    w[V.position_y], w[V.velocity_y] = w[V.position0_y], w[V.velocity0_y]
    w[V.impacts], w[V.last_impact_time] = 0.0, -1.0
    _account(w)
    return OK


@kernel
def evaluate(w, x, k):
    """Leave the outputs at the start: no output follows from an input."""
    return OK


@kernel
def step(t, h, w, x, k):
    """Advance by h (s): to each impact, and from the last one to the end of the step."""
    gone, nearer = 0.0, w[V.gravity] + w[V.table_acceleration_y]
    if nearer <= 0.0:
        return TABLE_FALLS
    for _ in range(MOST_BOUNCES):
        table, rate = _table(gone, w)
        height = max(0.0, w[V.position_y] - table)
        until = _falls(height, w[V.velocity_y] - rate, nearer)
        if gone + until >= h:
            _fly(h - gone, w)
            _account(w)
            return OK
        _fly(until, w)
        gone += until
        w[V.position_y], rate = _table(gone, w)
        w[V.velocity_y] = rate + w[V.restitution] * (rate - w[V.velocity_y])
        w[V.impacts] += 1.0
        w[V.last_impact_time] = t + gone
    return TOO_MANY_BOUNCES


@kernel
def _table(since, w):
    """Return height (m) and velocity (m/s) of the table so long (s) after the start of the step."""
    rate = w[V.table_velocity_y] + w[V.table_acceleration_y] * since
    return w[V.table_position_y] + 0.5 * (w[V.table_velocity_y] + rate) * since, rate


@kernel
def _falls(height, away, nearer):
    """Return the time (s) until a ball at this height (m) above the table is on it.

    Both relative to the table: the velocity away from it (m/s), the acceleration towards it (m/s2).
    """
    return (away + math.sqrt(away * away + 2.0 * nearer * height)) / nearer


@kernel
def _fly(time, w):
    """Move the ball freely for a time (s)."""
    w[V.position_y] += (w[V.velocity_y] - 0.5 * w[V.gravity] * time) * time
    w[V.velocity_y] -= w[V.gravity] * time


@kernel
def _account(w):
    """Write kinetic and potential energy (J)."""
    w[V.energy_kinetic] = 0.5 * w[V.mass] * w[V.velocity_y] * w[V.velocity_y]
    w[V.energy_gravity] = w[V.mass] * w[V.gravity] * w[V.position_y]
