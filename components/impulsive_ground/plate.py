"""A rigid plate that slides down against a resistance linear in time.

Its load gives way with its velocity:

    M dv/dt = c - Z v - (R + r t)

c (N) and Z (N s/m) are constant: a held force has Z = 0, a rod that hands out waves has its
impedance. Settlement s, velocity v and forces on the plate count downwards. Everything is exact;
phi functions make Z = 0 no special case.

The functions share their parameters: ``t``: time from now (s); ``v``: velocity now (m/s);
``mass``: M (kg); ``load``: c (N); ``impedance``: Z (N s/m); ``resistance``: R now (N); ``rise``: r
(N/s).
"""

import math

from ..common.kernels import kernel

_SERIES = 0.5
"""Argument below which phi functions are summed as series."""
_BISECTIONS = 60


@kernel
def phi(z):
    """Return phi_0 to phi_4 of z.

    phi_0 = exp(-z), phi_(n+1) = (1/n! - phi_n)/z, so that phi_n(0) = 1/n!.

    Parameters
    ----------
    z : float
        Argument, not negative.

    Returns
    -------
    tuple of float
        The five values.
    """
    if z < _SERIES:
        term, last = 1.0 / 24.0, 0.0
        for n in range(24):
            last += term
            term *= -z / (n + 5.0)
        p3 = 1.0 / 6.0 - z * last
        p2 = 0.5 - z * p3
        p1 = 1.0 - z * p2
        return 1.0 - z * p1, p1, p2, p3, last
    p0 = math.exp(-z)
    p1 = (1.0 - p0) / z
    p2 = (1.0 - p1) / z
    p3 = (0.5 - p2) / z
    return p0, p1, p2, p3, (1.0 / 6.0 - p3) / z


@kernel
def velocity(t, v, mass, load, impedance, resistance, rise):
    """Return the velocity of the plate after a time.

    Parameters
    ----------
    t : float
        Time (s).
    v : float
        Velocity now (m/s).
    mass : float
        Of the plate, M (kg).
    load, impedance : float
        c (N) and Z (N s/m).
    resistance, rise : float
        R now (N) and r (N/s).

    Returns
    -------
    float
        v (m/s): v phi_0 + ((c - R) phi_1 - r t phi_2) t/M, with phi of Z t/M.
    """
    p0, p1, p2, _, _ = phi(impedance / mass * t)
    return v * p0 + ((load - resistance) * p1 - rise * t * p2) * t / mass


@kernel
def slide(t, v, mass, load, impedance, resistance, rise):
    """Return what a plate that goes on sliding has done after a time.

    Parameters
    ----------
    t : float
        Time (s).
    v : float
        Velocity now (m/s).
    mass : float
        Of the plate, M (kg).
    load, impedance : float
        c (N) and Z (N s/m).
    resistance, rise : float
        R now (N) and r (N/s).

    Returns
    -------
    tuple of float
        Velocity (m/s), settlement (m) and work of the resistance (J).
    """
    p0, p1, p2, p3, p4 = phi(impedance / mass * t)
    push = (load - resistance) / mass
    jerk = rise / mass
    end = v * p0 + (push * p1 - jerk * t * p2) * t
    way = (v * p1 + (push * p2 - jerk * t * p3) * t) * t
    area = (v * p2 + (push * p3 - jerk * t * p4) * t) * t * t
    return end, way, resistance * way + rise * (t * way - area)


@kernel
def stop(t, v, mass, load, impedance, resistance, rise):
    """Return the time at which the plate comes to rest.

    Parameters
    ----------
    t : float
        Longest time (s).
    v : float
        Velocity now (m/s), not negative.
    mass : float
        Of the plate, M (kg).
    load, impedance : float
        c (N) and Z (N s/m).
    resistance, rise : float
        R now (N) and r (N/s).

    Returns
    -------
    float
        Time (s); t if the plate moves on.
    """
    if velocity(t, v, mass, load, impedance, resistance, rise) >= 0.0:
        return t
    before, after = 0.0, t
    for _ in range(_BISECTIONS):
        middle = 0.5 * (before + after)
        if velocity(middle, v, mass, load, impedance, resistance, rise) >= 0.0:
            before = middle
        else:
            after = middle
    return before


@kernel
def work_of_load(t, v, mass, load, impedance, resistance, rise):
    """Return the work of the load c - Z v on the plate.

    Gauss's rule of three points: exact for Z = 0 and for short t.

    Parameters
    ----------
    t : float
        Time (s).
    v : float
        Velocity now (m/s).
    mass : float
        Of the plate, M (kg).
    load, impedance : float
        c (N) and Z (N s/m).
    resistance, rise : float
        R now (N) and r (N/s).

    Returns
    -------
    float
        Work (J).
    """
    total = 0.0
    for place, weight in (
        (0.1127016653792583, 5.0 / 18.0),
        (0.5, 4.0 / 9.0),
        (0.8872983346207417, 5.0 / 18.0),
    ):
        u = velocity(place * t, v, mass, load, impedance, resistance, rise)
        total += weight * (load - impedance * u) * u
    return total * t
