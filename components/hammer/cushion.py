"""The hammer cushion after Smith: loads along one line, unloads and reloads along a steeper one, takes no tension."""

import math

from ..common.kernels import kernel

_ROUNDS = 60


@kernel
def steeper(stiffness, restitution):
    """Stiffness (N/m) of unloading: the area under it is restitution squared times that under the line of loading."""
    return stiffness / (restitution * restitution)


@kernel
def cushion_force(compression, largest, stiffness, restitution):
    """Force (N) at a compression (m) when the largest so far was ``largest`` (m)."""
    if compression >= largest:
        return stiffness * max(compression, 0.0)
    return max(0.0, stiffness * largest - steeper(stiffness, restitution) * (largest - compression))


@kernel
def mean_force(start, way, largest, stiffness, restitution):
    """Mean force (N) while the compression goes evenly from start by way (m): the work on the cushion divided by the way."""
    slack = largest * (1.0 - restitution * restitution)
    if way == 0.0:
        return cushion_force(start, largest, stiffness, restitution)
    unloading = _work(start, start + way, slack, largest, largest, stiffness, restitution)
    return (
        unloading + _work(start, start + way, largest, math.inf, largest, stiffness, restitution)
    ) / way


@kernel
def _work(start, end, low, high, largest, stiffness, restitution):
    """Work (J) from start to end (m), of what lies between low and high, where the force is linear."""
    begun, done = min(max(start, low), high), min(max(end, low), high)
    forces = cushion_force(begun, largest, stiffness, restitution) + cushion_force(
        done, largest, stiffness, restitution
    )
    return 0.5 * forces * (done - begun)


@kernel
def met(start, free, yielding, largest, stiffness, restitution):
    """Mean force F (N) of the cushion in a step from the compression start that goes by free - yielding * F (m).

    Newton's method between bounds: the force never falls with the way, so there is one solution.
    """
    high = free
    low = free - yielding * max(
        cushion_force(start, largest, stiffness, restitution),
        cushion_force(start + free, largest, stiffness, restitution),
    )
    way, force, change = high, 0.0, math.inf
    for _ in range(_ROUNDS):
        force = mean_force(start, way, largest, stiffness, restitution)
        excess = way - free + yielding * force
        low, high = (low, way) if excess > 0.0 else (way, high)
        rise = 0.5 * steeper(stiffness, restitution)
        if way != 0.0:
            rise = max(
                (cushion_force(start + way, largest, stiffness, restitution) - force) / way, 0.0
            )
        after = way - excess / (1.0 + yielding * rise)
        if not low <= after <= high or abs(after - way) > 0.5 * abs(change):
            after = 0.5 * (low + high)
        change = after - way
        way = after
        if abs(change) <= 1e-15 * (abs(start) + abs(way)):
            break
    return max(force, 0.0)
