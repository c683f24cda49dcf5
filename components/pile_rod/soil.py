"""Soil after Smith: an elastic-plastic static resistance, and damping in proportion to it and to the velocity."""

import math
from collections import namedtuple

from ..common.kernels import kernel

Soil = namedtuple("Soil", "stretch quake resistance damping tension")
"""Elastic displacement (m), quake (m), ultimate resistance (N), Smith's damping (s/m), and whether the soil pulls too: a shaft
does, the ground under a toe does not."""
Grip = namedtuple("Grip", "velocity shaft toe drag")
"""Velocity (m/s), static resistances of shaft and toe (N) and damping of both (N s/m), means over a step."""

_ROUNDS = 60


@kernel
def static(soil, stretch):
    """Static resistance (N) at an elastic displacement (m)."""
    low = -soil.resistance if soil.tension else 0.0
    return min(max(soil.resistance / soil.quake * stretch, low), soil.resistance)


@kernel
def mean_static(soil, way):
    """Mean static resistance (N) while the node moves evenly by way (m): the work on the soil divided by the way."""
    end, low = soil.stretch + way, -soil.quake if soil.tension else 0.0
    begun, held = min(max(soil.stretch, low), soil.quake), min(max(end, low), soil.quake)
    elastic = 0.5 * soil.resistance / soil.quake * (begun + held)
    if way == 0.0 or held - begun == way:
        return elastic
    return (elastic * (held - begun) + static(soil, end) * (end - held)) / way


@kernel
def drag(soil, resistance):
    """Damping (N s/m) at a static resistance (N). Its amount counts, so that damping never creates energy."""
    return soil.damping * abs(resistance)


@kernel
def stretched(soil, way):
    """Elastic displacement (m) after the node has moved by way (m). Without tension the node may leave the soil."""
    after = min(soil.stretch + way, soil.quake)
    return max(after, -soil.quake) if soil.tension else after


@kernel
def stored(soil, stretch, after):
    """Elastic energy (J) between two displacements (m), the same one twice or two a step apart."""
    if not soil.tension and (stretch < 0.0 or after < 0.0):
        return 0.0
    return 0.5 * soil.resistance / soil.quake * stretch * after


@kernel
def gripped(impedance, drive, shaft, toe, dt):
    """Velocity v with impedance * v + soil(v) = drive in a step dt (s): a node that the soil holds.

    impedance (N s/m): of all waves that leave the node; drive (N): what would act on the node at rest, without the soil. Implicit:
    the resistance is its mean over the way of the step, so that elastic soil keeps its energy. Newton's method between bounds: the
    resistance never falls with the way.
    """
    on_shaft, on_toe = static(shaft, shaft.stretch), static(toe, toe.stretch)
    velocity, damping = 0.0, 0.0
    for _ in range(2):
        damping = drag(shaft, on_shaft) + drag(toe, on_toe)
        total = impedance + damping
        low, high, change = (
            (drive - shaft.resistance - toe.resistance) / total,
            (drive + shaft.resistance) / total,
            math.inf,
        )
        for _ in range(_ROUNDS):
            way = dt * velocity
            on_shaft, on_toe = mean_static(shaft, way), mean_static(toe, way)
            excess = total * velocity + on_shaft + on_toe - drive
            low, high = (low, min(high, velocity)) if excess > 0.0 else (max(low, velocity), high)
            after = velocity - excess / (
                total + dt * (_slope(shaft, way, on_shaft) + _slope(toe, way, on_toe))
            )
            if not low <= after <= high or abs(after - velocity) > 0.5 * abs(change):
                after = 0.5 * (low + high)
            change = after - velocity
            velocity = after
            if abs(change) <= 1e-14 * abs(velocity):
                break
    return Grip((drive - on_shaft - on_toe) / (impedance + damping), on_shaft, on_toe, damping)


@kernel
def _slope(soil, way, mean):
    """Change of the mean resistance with the way (N/m)."""
    end, low = soil.stretch + way, -soil.quake if soil.tension else 0.0
    if low <= soil.stretch and low <= end <= soil.quake:
        return 0.5 * soil.resistance / soil.quake
    return 0.0 if way == 0.0 else (static(soil, end) - mean) / way
