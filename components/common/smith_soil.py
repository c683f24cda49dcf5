"""Smith's soil: a static resistance that is elastic and then plastic, and damping with it.

The static resistance R rises by R_u/Q with the way (R_u: ultimate resistance, Q: quake) up to R_u,
at which the soil slides; on the way back it falls along the same slope. Damping adds J R v. A shaft
also pulls, down to -R_u; the ground under a toe only pushes, and the toe may leave it.

The law stands here in the two forms that its users need, with one set of words; a test compares
them:

* of a **node** that goes some way in a step (:class:`Soil`): the state is the stretch, the elastic
  displacement R Q/R_u, negative where a toe has left the ground. The resistance is its mean over
  the way, so that elastic soil keeps its energy.
* of a **toe** that moves piece by piece (:class:`Spring`): the state is the resistance itself and
  the slack, the way until the toe touches the ground. Pieces end where the law changes and are
  exact.
"""

import math
from collections import namedtuple

from .kernels import kernel

Soil = namedtuple("Soil", "stretch quake ultimate damping tension")
"""State and constants of the soil at a node: stretch (m), Q (m), R_u (N), J (s/m), and whether the
soil pulls too."""
Grip = namedtuple("Grip", "velocity shaft toe drag")
"""Velocity (m/s), static resistances of shaft and toe (N) and damping of both (N s/m): means over a
step."""
Spring = namedtuple("Spring", "resistance slack stiffness ultimate")
"""State and constants of the soil under a toe: static resistance (N), slack (m), R_u/Q (N/m), R_u
(N)."""

_ROUNDS = 60
_ENDLESS = 1e30
"""Time (s) that never passes."""


# --- a node that goes some way in a step ---


@kernel
def static(soil, stretch):
    """Return the static resistance (N) at a stretch (m).

    Parameters
    ----------
    soil : Soil
        State and constants at the start of the step.
    stretch : float
        Elastic displacement (m).

    Returns
    -------
    float
        Resistance (N).
    """
    low = -soil.ultimate if soil.tension else 0.0
    return min(max(soil.ultimate / soil.quake * stretch, low), soil.ultimate)


@kernel
def mean_static(soil, way):
    """Return the mean static resistance (N) while the node moves evenly by a way (m).

    It is the work on the soil divided by the way.

    Parameters
    ----------
    soil : Soil
        State and constants at the start of the step.
    way : float
        Way of the node (m).

    Returns
    -------
    float
        Resistance (N).
    """
    end = soil.stretch + way
    low = -soil.quake if soil.tension else 0.0
    begun, held = min(max(soil.stretch, low), soil.quake), min(max(end, low), soil.quake)
    elastic = 0.5 * soil.ultimate / soil.quake * (begun + held)
    if way == 0.0 or held - begun == way:
        return elastic
    return (elastic * (held - begun) + static(soil, end) * (end - held)) / way


@kernel
def drag(soil, resistance):
    """Return the damping (N s/m) at a static resistance (N).

    The amount of the resistance counts, so that damping never creates energy.

    Parameters
    ----------
    soil : Soil
        State and constants at the start of the step.
    resistance : float
        Static resistance (N).

    Returns
    -------
    float
        Damping (N s/m).
    """
    return soil.damping * abs(resistance)


@kernel
def stretched(soil, way):
    """Return the stretch (m) after the node has moved by a way (m).

    Parameters
    ----------
    soil : Soil
        State and constants at the start of the step.
    way : float
        Way of the node (m).

    Returns
    -------
    float
        Stretch (m).
    """
    after = min(soil.stretch + way, soil.quake)
    return max(after, -soil.quake) if soil.tension else after


@kernel
def stored(soil, stretch, after):
    """Return the elastic energy (J) between two stretches (m): one twice, or two a step apart.

    Parameters
    ----------
    soil : Soil
        State and constants at the start of the step.
    stretch : float
        Elastic displacement (m).
    after : float
        The same at another time (m).

    Returns
    -------
    float
        Energy (J).
    """
    if not soil.tension and (stretch < 0.0 or after < 0.0):
        return 0.0
    return 0.5 * soil.ultimate / soil.quake * stretch * after


@kernel
def gripped(impedance, drive, shaft, toe, dt):
    """Return what a step does to a node that the soil holds: impedance * v + soil(v) = drive.

    The damping is that of the mean resistances, found in two rounds.

    Parameters
    ----------
    impedance : float
        Of all waves that leave the node (N s/m).
    drive : float
        Force that would act on the node at rest, without the soil (N).
    shaft, toe : Soil
        The soil at the start of the step.
    dt : float
        Length of the step (s).

    Returns
    -------
    Grip
        Velocity, resistances and damping.
    """
    on_shaft, on_toe = static(shaft, shaft.stretch), static(toe, toe.stretch)
    velocity, damping = 0.0, 0.0
    for _ in range(2):
        damping = drag(shaft, on_shaft) + drag(toe, on_toe)
        velocity, on_shaft, on_toe = _balanced(impedance + damping, drive, shaft, toe, velocity, dt)
    return Grip((drive - on_shaft - on_toe) / (impedance + damping), on_shaft, on_toe, damping)


@kernel
def _balanced(total, drive, shaft, toe, velocity, dt):
    """Return the root of total * v + resistances(v) = drive, and the resistances (N) there.

    Newton's method between bounds from a velocity (m/s) on: the resistance never falls with the
    way. total: impedance and damping (N s/m).
    """
    on_shaft, on_toe, change = 0.0, 0.0, math.inf
    low = (drive - shaft.ultimate - toe.ultimate) / total
    high = (drive + shaft.ultimate) / total
    for _ in range(_ROUNDS):
        way = dt * velocity
        on_shaft, on_toe = mean_static(shaft, way), mean_static(toe, way)
        excess = total * velocity + on_shaft + on_toe - drive
        if excess > 0.0:
            high = min(high, velocity)
        else:
            low = max(low, velocity)
        slope = _slope(shaft, way, on_shaft) + _slope(toe, way, on_toe)
        after = velocity - excess / (total + dt * slope)
        if not low <= after <= high or abs(after - velocity) > 0.5 * abs(change):
            after = 0.5 * (low + high)
        change = after - velocity
        velocity = after
        if abs(change) <= 1e-14 * abs(velocity):
            break
    return velocity, on_shaft, on_toe


@kernel
def _slope(soil, way, mean):
    """Return the change of the mean resistance with the way (N/m)."""
    end = soil.stretch + way
    low = -soil.quake if soil.tension else 0.0
    if low <= soil.stretch and low <= end <= soil.quake:
        return 0.5 * soil.ultimate / soil.quake
    return 0.0 if way == 0.0 else (static(soil, end) - mean) / way


# --- a toe that moves piece by piece ---


@kernel
def press(way, spring):
    """Return what a way of the toe does: first the slack, then the spring, then sliding at R_u.

    On the way back the spring unloads to zero and the toe leaves it.

    Parameters
    ----------
    way : float
        Into the ground (m); negative on the way back.
    spring : Spring
        At the start of the way.

    Returns
    -------
    tuple of float
        Resistance (N) and slack (m) at the end, the part of the way slid at R_u (m), and the
        integral of the resistance over the way (J): what the spring gained and what sliding took.
    """
    resistance, stiffness, ultimate = spring.resistance, spring.stiffness, spring.ultimate
    if way < 0.0:
        back = resistance / stiffness
        if -way >= back:
            return 0.0, spring.slack - way - back, 0.0, -0.5 * resistance * back
        end = resistance + stiffness * way
        return end, spring.slack, 0.0, 0.5 * (resistance + end) * way
    if way <= spring.slack:
        return resistance, spring.slack - way, 0.0, 0.0
    way -= spring.slack
    elastic = (ultimate - resistance) / stiffness
    if way <= elastic:
        end = resistance + stiffness * way
        return end, 0.0, 0.0, 0.5 * (resistance + end) * way
    slid = way - elastic
    return ultimate, 0.0, slid, 0.5 * (resistance + ultimate) * elastic + ultimate * slid


@kernel
def mean_resistance(way, spring):
    """Return the mean resistance (N) over a way (m). It never falls as the way grows.

    Parameters
    ----------
    way : float
        Into the ground (m).
    spring : Spring
        At the start of the way.

    Returns
    -------
    float
        Resistance (N).
    """
    if way == 0.0:
        return spring.resistance
    _, _, _, area = press(way, spring)
    return area / way


@kernel
def relax(left, load, impedance, damping, spring):
    """Return the next piece of a massless toe's motion under a load that gives way.

    R + D v = c - Z v while the spring pushes; the toe moves with c/Z through the slack.

    Parameters
    ----------
    left : float
        Longest time of the piece (s).
    load, impedance : float
        c (N) and Z (N s/m) of the rod above.
    damping : float
        D (N s/m).
    spring : Spring
        At the start of the piece.

    Returns
    -------
    tuple of float
        Time (s), way (m) and integral of v2 over the piece (m2/s).
    """
    resistance, slack, ultimate = spring.resistance, spring.slack, spring.ultimate
    if resistance <= 0.0 and (slack > 0.0 or load <= 0.0):
        v = load / impedance
        time = min(left, slack / v if v > 0.0 else _ENDLESS)
        return time, v * time, v * v * time
    total = impedance + damping
    if resistance >= ultimate and load >= ultimate:
        v = (load - ultimate) / total
        return left, v * left, v * v * left
    rate = spring.stiffness / total
    time = left
    if load > ultimate:
        time = min(left, math.log((load - resistance) / (load - ultimate)) / rate)
    elif load < 0.0:
        time = min(left, math.log((resistance - load) / -load) / rate)
    v = (load - resistance) / total
    way = -v * math.expm1(-rate * time) / rate
    return time, way, -0.5 * v * v * math.expm1(-2.0 * rate * time) / rate
