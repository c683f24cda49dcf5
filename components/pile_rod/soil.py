"""Soil after Smith: an elastic-plastic static resistance, and damping in proportion to it and to the velocity."""

from collections import namedtuple

from ..compilation import kernel

Soil = namedtuple("Soil", "stretch quake resistance damping tension")
"""Elastic displacement (m), quake (m), ultimate resistance (N), Smith's damping (s/m), and whether the soil pulls too: a shaft
does, the ground under a toe does not."""
Grip = namedtuple("Grip", "velocity shaft toe drag")
"""Velocity (m/s), static resistances of shaft and toe (N) and damping of both (N s/m), means over a step."""

_ROUNDS = 8


@kernel
def static(soil, stretch):
    """Static resistance (N) at an elastic displacement (m)."""
    low = -soil.resistance if soil.tension else 0.0
    return min(max(soil.resistance / soil.quake * stretch, low), soil.resistance)


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
    """Velocity v with impedance * v + soil(v) = drive in a step dt (s), by the midpoint rule: a node that the soil holds.

    impedance (N s/m): of all waves that leave the node; drive (N): what would act on the node at rest, without the soil.
    """
    velocity, resisting, damping = 0.0, 0.0, 0.0
    on_shaft, on_toe = static(shaft, shaft.stretch), static(toe, toe.stretch)
    for _ in range(2):
        damping = drag(shaft, on_shaft) + drag(toe, on_toe)
        for _ in range(_ROUNDS):
            way = 0.5 * dt * velocity
            on_shaft, on_toe = static(shaft, shaft.stretch + way), static(toe, toe.stretch + way)
            resisting = on_shaft + on_toe
            slope = impedance + damping + 0.5 * dt * (_stiffness(shaft, on_shaft) + _stiffness(toe, on_toe))
            change = (drive - resisting - (impedance + damping) * velocity) / slope
            velocity += change
            if abs(change) <= 1e-14 * abs(velocity):
                break
    return Grip((drive - resisting) / (impedance + damping), on_shaft, on_toe, damping)


@kernel
def _stiffness(soil, resistance):
    """Slope of the static resistance (N/m)."""
    yielding = resistance >= soil.resistance or (resistance <= -soil.resistance if soil.tension else resistance <= 0.0)
    return 0.0 if yielding else soil.resistance / soil.quake
