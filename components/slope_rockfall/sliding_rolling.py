"""Line motion on a cell: rolling, sliding, spinning on the spot. Equations (1)-(14).

All in the frame of the cell, mirrored for a rock that moves up-slope so that u >= 0: u along the
cell, omega positive against the direction of rolling. Accelerations are constant until the next
event.
"""

import math
from collections import namedtuple

from ..common.kernels import kernel
from .declarations import REST, ROLLING, SLIDING, SPINNING

Loads = namedtuple("Loads", "along normal drag")
"""Components of the weight along the cell and into it, and the resistance C (N)."""
Touch = namedtuple("Touch", "mass radius ratio friction sin cos")
"""A rock on a cell: mass (kg), radius (m), I/(m r2), mu, sine and cosine of the angle phi of the
contact force."""
LineMotion = namedtuple("LineMotion", "mode acceleration normal_force shear_force")
"""Motion of a rock until the next event: mode, acceleration (m/s2), P and S (N)."""

_SLIP = 1e-10
"""Slip, relative to the speeds it is the difference of, that is rounding."""


@kernel
def rolling(loads, touch):
    """Return the motion of a rock that rolls, equations (5) and (6).

    Parameters
    ----------
    loads : Loads
        Forces on the rock (N).
    touch : Touch
        The rock on its cell.

    Returns
    -------
    LineMotion
    """
    s, c, ratio = touch.sin, touch.cos, touch.ratio
    k1 = (loads.along - loads.normal * s / c - loads.drag) / touch.mass
    k2 = s * s / c + c
    acceleration = k1 / (1.0 + ratio * k2)
    shear_force = ratio * touch.mass * acceleration
    return LineMotion(ROLLING, acceleration, (loads.normal + shear_force * s) / c, shear_force)


@kernel
def sliding(loads, touch, across):
    """Return the motion of a rock that slides with S = across P, equation (11).

    P follows from m g cos(theta) = P (cos(phi) - across sin(phi)).

    Parameters
    ----------
    loads : Loads
        Forces on the rock (N).
    touch : Touch
        The rock on its cell.
    across : float
        S / P: mu, with the sign of the slip.

    Returns
    -------
    LineMotion
    """
    normal_force = loads.normal / (touch.cos - across * touch.sin)
    net = loads.along - normal_force * (touch.sin + across * touch.cos) - loads.drag
    return LineMotion(SLIDING, net / touch.mass, normal_force, across * normal_force)


@kernel
def slip_of(u, spin):
    """Return the speed (m/s) of the contact point, zero if it is rounding.

    Parameters
    ----------
    u : float
        Speed along the cell (m/s).
    spin : float
        omega r (m/s).

    Returns
    -------
    float
        Slip (m/s).
    """
    slip = u + spin
    return slip if abs(slip) > _SLIP * (abs(u) + abs(spin)) else 0.0


@kernel
def law(u, omega, loads, touch):
    """Return the motion of a rock that moves with u >= 0, or is about to.

    Equation (4) as abs(S) <= mu P: the printed form calls a rock that decelerates a sliding one.

    Parameters
    ----------
    u, omega : float
        Speed along the cell (m/s) and angular velocity (rad/s).
    loads : Loads
        Forces on it.
    touch : Touch
        The rock on its cell.

    Returns
    -------
    LineMotion
        Rolling or sliding.
    """
    slip = slip_of(u, touch.radius * omega)
    rolls = rolling(loads, touch)
    if slip == 0.0 and abs(rolls.shear_force) <= touch.friction * rolls.normal_force:
        return rolls
    side = slip if slip != 0.0 else rolls.shear_force
    return sliding(loads, touch, math.copysign(touch.friction, side))


@kernel
def start(omega, loads, touch):
    """Return what a rock without speed does: it sets off, spins on the spot or rests.

    Resistances never start a motion: it sets off only into a direction in which it is accelerated.

    Parameters
    ----------
    omega : float
        Angular velocity (rad/s), not mirrored.
    loads : Loads
        Forces on it, not mirrored.
    touch : Touch
        The rock on its cell.

    Returns
    -------
    tuple of float and LineMotion
        Direction (1 or -1) and motion in it.
    """
    along, friction = loads.along, touch.friction
    first = 1.0 if along >= 0.0 else -1.0
    for direction in (first, -first):
        mirrored = Loads(direction * along, loads.normal, loads.drag)
        motion = law(0.0, direction * omega, mirrored, touch)
        if motion.acceleration > 0.0:
            return direction, motion
    if omega == 0.0:
        return first, LineMotion(REST, 0.0, loads.normal, 0.0)
    shear_force = math.copysign(friction * loads.normal, first * omega)
    return first, LineMotion(SPINNING, 0.0, loads.normal, shear_force)
