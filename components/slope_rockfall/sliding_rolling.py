"""Line motion on a cell: rolling, sliding, spinning on the spot. Equations (1)-(14).

All in the frame of the cell, mirrored for a rock that moves up-slope so that u >= 0: u along the cell, omega positive against the
direction of rolling. Accelerations are constant until the next event.
"""

import math

from ..common.kernels import kernel
from .declarations import REST, ROLLING, SLIDING, SPINNING

_SLIP = 1e-10
"""Slip, relative to the speeds it is the difference of, that is rounding."""


@kernel
def pressure(weight, across, s, c):
    """Normal force P (N) of a rock that slides: m g cos(theta) = P (cos(phi) - across sin(phi)) with S = across P."""
    return weight / (c - across * s)


@kernel
def rolling(along, normal, drag, mass, s, c, ratio):
    """Equations (5), (6): acceleration (m/s2), P and S (N) of a rock that rolls.

    along, normal: components of the weight (N) along the cell and into it; drag: C (N); s, c: of phi.
    """
    k1 = (along - normal * s / c - drag) / mass
    k2 = s * s / c + c
    acceleration = k1 / (1.0 + ratio * k2)
    shear = ratio * mass * acceleration
    return acceleration, (normal + shear * s) / c, shear


@kernel
def sliding(along, normal, drag, mass, s, c, across):
    """Equation (11): acceleration (m/s2), P and S (N) of a rock that slides with S = across P."""
    p = pressure(normal, across, s, c)
    return (along - p * (s + across * c) - drag) / mass, p, across * p


@kernel
def slip_of(u, spin):
    """Speed (m/s) of the contact point; zero if it is rounding. spin: omega r."""
    slip = u + spin
    return slip if abs(slip) > _SLIP * (abs(u) + abs(spin)) else 0.0


@kernel
def law(u, omega, along, normal, drag, friction, mass, radius, s, c, ratio):
    """Mode, acceleration (m/s2), P and S (N) of a rock that moves with u >= 0, or is about to.

    Equation (4) as |S| <= mu P: the printed form calls a rock that decelerates a sliding one.
    """
    slip = slip_of(u, radius * omega)
    acceleration, p, shear = rolling(along, normal, drag, mass, s, c, ratio)
    if slip != 0.0:
        across = math.copysign(friction, slip)
    elif abs(shear) <= friction * p:
        return ROLLING, acceleration, p, shear
    else:
        across = math.copysign(friction, shear)
    acceleration, p, shear = sliding(along, normal, drag, mass, s, c, across)
    return SLIDING, acceleration, p, shear


@kernel
def start(omega, along, normal, drag, friction, mass, radius, s, c, ratio):
    """Direction, mode, acceleration (m/s2), P and S (N) of a rock without speed: it sets off, spins on the spot or rests.

    along, omega: not mirrored. Resistances never start a motion: it sets off only into a direction in which it is accelerated.
    """
    first = 1.0 if along >= 0.0 else -1.0
    for direction in (first, -first):
        mode, acceleration, p, shear = law(
            0.0,
            direction * omega,
            direction * along,
            normal,
            drag,
            friction,
            mass,
            radius,
            s,
            c,
            ratio,
        )
        if acceleration > 0.0:
            return direction, mode, acceleration, p, shear
    if omega == 0.0:
        return first, REST, 0.0, normal, 0.0
    return first, SPINNING, 0.0, normal, math.copysign(friction * normal, first * omega)
