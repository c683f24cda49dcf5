"""Impact on the ground: penetration, restitution, tilt of the contact, velocities after it.

Equations (19)-(28) of Ushiro, all in the frame of the cell, mirrored for a rock that moves up-slope
so that u >= 0: u along the cell, v along its outward normal, omega positive against the direction
of rolling.
"""

import math
from collections import namedtuple

from ..common.kernels import kernel
from .declarations import CONSISTENT, PRINTED

Approach = namedtuple("Approach", "u v omega gravity lever")
"""A rock that meets the ground: velocity along the surface and along its normal, v <= 0 (m/s),
angular velocity (rad/s), gravity along the normal (m/s2), distance of the contact point from the
centre (m)."""

_SERIES_BELOW = 0.02
_LONGEST = 60


@kernel
def strain_work(a):
    """Return a - 1 + exp(-a): the work that the ground takes up to a penetration.

    Parameters
    ----------
    a : float
        Penetration k delta / q_d, without unit.

    Returns
    -------
    float
        Work in units of q_d^2 A / k.
    """
    if a < _SERIES_BELOW:
        return (
            a
            * a
            * (
                0.5
                - a
                * (
                    1.0 / 6.0
                    - a * (1.0 / 24.0 - a * (1.0 / 120.0 - a * (1.0 / 720.0 - a / 5040.0)))
                )
            )
        )
    return a + math.expm1(-a)


@kernel
def penetration(energy, weight):
    """Return the penetration a = k delta / q_d: root of a - 1 + exp(-a) - weight a = energy.

    This is equation (26), with gravity if weight > 0. The left side is convex; from a start to the
    right of its minimum Newton's method comes down to the root from above.

    Parameters
    ----------
    energy : float
        Kinetic energy k / (q_d^2 A).
    weight : float
        m g cos(theta) / (q_d A), below 1.

    Returns
    -------
    float
        Penetration, without unit.
    """
    if energy <= 0.0 and weight <= 0.0:
        return 0.0
    high = (1.0 + energy) / (1.0 - weight)
    soft = weight + math.sqrt(weight * weight + 2.0 * energy)
    a = high if weight > 0.5 else min(high, soft * (1.0 + 0.25 * soft))
    for _ in range(_LONGEST):
        change = (strain_work(a) - weight * a - energy) / (-math.expm1(-a) - weight)
        a -= change
        if abs(change) <= 1e-15 * a:
            break
    return a


@kernel
def restitution(speed, mass, radius, gravity, strength, stiffness, hardening, area, treatment):
    """Return coefficient of restitution and penetration of an impact, equations (26)-(28).

    The penetration ends at 2 r, where the rock is all in the ground; then, and where the radicand
    is negative, e = 0: the rock stays embedded.

    Parameters
    ----------
    speed : float
        Normal speed (m/s), towards the ground.
    mass, radius : float
        Of the rock (kg, m).
    gravity : float
        Its component along the normal (m/s2).
    strength, stiffness, hardening : float
        q_d (Pa), k (N/m3) and epsilon of the ground.
    area : float
        Loaded area A (m2).
    treatment : int
        Of gravity: PRINTED, NONE or CONSISTENT.

    Returns
    -------
    tuple of float
        e and delta (m).
    """
    if speed <= 0.0:
        return 0.0, 0.0
    weight = mass * gravity / (strength * area) if treatment == CONSISTENT else 0.0
    if weight >= 1.0:
        return 0.0, 2.0 * radius
    a = penetration(0.5 * mass * speed * speed * stiffness / (strength * strength * area), weight)
    delta = a * strength / stiffness
    if delta >= 2.0 * radius:
        return 0.0, 2.0 * radius
    force = -strength * area * math.expm1(-a)
    radicand = hardening * force * force / (mass * stiffness * area)
    if treatment in (PRINTED, CONSISTENT):
        radicand -= 2.0 * gravity * delta
    return (math.sqrt(radicand) / speed if radicand > 0.0 else 0.0), delta


@kernel
def contact_tilt(delta, radius, u, v, e, capped):
    """Return sine and cosine of the angle phi of the contact force, equation (20).

    phi = arccos(1 - delta / r) / 2.

    Parameters
    ----------
    delta, radius : float
        Penetration and radius (m).
    u, v : float
        Velocity along the cell and along its normal (m/s).
    e : float
        Coefficient of restitution.
    capped : bool
        Whether phi <= arctan(abs(u) / ((1 + e) abs(v))), beyond which the normal force would throw
        the rock back and may add energy.

    Returns
    -------
    tuple of float
        Sine and cosine.
    """
    half = 0.5 * delta / radius
    s, c = math.sqrt(half), math.sqrt(max(0.0, 1.0 - half))
    across = (1.0 + e) * abs(v)
    if capped and s * across > c * abs(u):
        length = math.sqrt(across * across + u * u)
        return abs(u) / length, across / length
    return s, c


@kernel
def rebound(u, v, omega, e, s, c, friction, radius, ratio):
    """Return u, v and omega after the impact of a rock with v < 0, equations (21)-(23).

    Slip stops if the impulse that it takes, the absolute value of Int S, is at most mu Int P.
    Otherwise slip goes on, against the sign of that impulse. Where mu tan(phi) >= 1 the contact
    locks itself: no slip can go on, and it stops.

    Parameters
    ----------
    u, v, omega : float
        Velocity along the cell and along its normal (m/s), angular velocity (rad/s).
    e : float
        Coefficient of restitution.
    s, c : float
        Sine and cosine of phi, of :func:`contact_tilt`.
    friction, radius, ratio : float
        mu, radius of the rock (m), I / (m r^2).

    Returns
    -------
    tuple of float
        u, v (m/s) and omega (rad/s).
    """
    pushed = (1.0 + e) * v
    stuck = (pushed * s + u * c - ratio * radius * omega) / (ratio + c)
    shear = ratio * (stuck + radius * omega)
    side = 1.0 if shear >= 0.0 else -1.0
    locking = c - side * friction * s
    if locking <= 0.0 or abs(shear) * c <= friction * (s * shear - pushed):
        return stuck, -e * v, -stuck / radius
    pressed = -pushed / locking
    slid = u - pressed * (s + side * friction * c)
    return slid, -e * v, omega - side * friction * pressed / (ratio * radius)


@kernel
def collide(u, v, omega, e, delta, capped, friction, radius, ratio):
    """Return u, v and omega after an impact with u >= 0 and v < 0.

    Parameters
    ----------
    u, v, omega : float
        Velocity along the cell and along its normal (m/s), angular velocity (rad/s).
    e, delta : float
        Coefficient of restitution, and penetration (m).
    capped : bool
        Whether no impact may add energy. What the cap of phi leaves is a rock with strong back-spin
        on ground too soft to carry it, which would wedge itself upwards; it meets the ground
        without tilt, and then friction and restitution can only take energy.
    friction, radius, ratio : float
        mu, radius of the rock (m), I / (m r^2).

    Returns
    -------
    tuple of float
        u, v (m/s) and omega (rad/s).
    """
    s, c = contact_tilt(delta, radius, u, v, e, capped)
    after = rebound(u, v, omega, e, s, c, friction, radius, ratio)
    if capped and motion(after[0], after[1], after[2], radius, ratio) > motion(
        u, v, omega, radius, ratio
    ):
        after = rebound(u, v, omega, e, 0.0, 1.0, friction, radius, ratio)
    return after


@kernel
def slowing(speed, scaling):
    """Return by what a normal restitution is divided at a speed (m/s), 1 + (speed / K)^2.

    Source: Pfeiffer and Bowen 1989, with K = 30 ft/s = 9.144 m/s.

    Parameters
    ----------
    speed : float
        Normal speed (m/s).
    scaling : float
        K (m/s); 0 for coefficients that do not depend on the speed.

    Returns
    -------
    float
        Without unit, 1 or more.
    """
    return 1.0 + (speed / scaling) * (speed / scaling) if scaling > 0.0 else 1.0


@kernel
def rebound_by_coefficients(tilted, normal, tangential, ratio):
    """Return u, v and omega after an impact with coefficients of restitution.

    The velocity is that of programs with a lumped mass, -R_n v and R_t u. The rock then rolls, as
    far as tangential and rotational energy before the impact suffice for that.

    Parameters
    ----------
    tilted : Approach
        Motion before the impact.
    normal, tangential : float
        R_n and R_t, from 0 to 1.
    ratio : float
        I / (m lever^2).

    Returns
    -------
    tuple of float
        u, v (m/s) and omega (rad/s).
    """
    u = tangential * tilted.u
    spin = tilted.lever * tilted.omega
    most = math.sqrt(max(0.0, spin * spin + (tilted.u * tilted.u - u * u) / ratio))
    return u, -normal * tilted.v, -min(max(u, -most), most) / tilted.lever


@kernel
def motion(u, v, omega, radius, ratio):
    """Return the kinetic energy per half mass (m2/s2).

    Parameters
    ----------
    u : float
        Velocity along the line, to the right (m/s).
    v : float
        Velocity along its outward normal (m/s).
    omega : float
        Angular velocity (rad/s).
    radius : float
        Radius of the rock (m).
    ratio : float
        I / (m r^2).

    Returns
    -------
    float
        Energy / (m / 2) (m2/s2).
    """
    return u * u + v * v + ratio * radius * radius * omega * omega
