"""The hammer cushion after Smith.

It loads along one line, unloads and reloads along a steeper one, and takes no tension.
"""

import math

from ..common.kernels import kernel

_ROUNDS = 60


@kernel
def steeper(stiffness, restitution):
    """Return the stiffness of unloading, k/e2.

    The area under its line is e2 times that under the line of loading.

    Parameters
    ----------
    stiffness : float
        Of loading, k (N/m).
    restitution : float
        Coefficient of restitution e.

    Returns
    -------
    float
        Stiffness (N/m).
    """
    return stiffness / (restitution * restitution)


@kernel
def cushion_force(compression, largest, stiffness, restitution):
    """Return the force of the cushion.

    Parameters
    ----------
    compression, largest : float
        Compression now and the largest so far (m).
    stiffness, restitution : float
        Stiffness of loading (N/m) and coefficient of restitution.

    Returns
    -------
    float
        Force (N), not negative.
    """
    if compression >= largest:
        return stiffness * max(compression, 0.0)
    return max(0.0, stiffness * largest - steeper(stiffness, restitution) * (largest - compression))


@kernel
def mean_force(start, way, largest, stiffness, restitution):
    """Return the mean force while the compression goes evenly from start by a way.

    It is the work on the cushion divided by the way.

    Parameters
    ----------
    start, way : float
        Compression at the start, and its change (m).
    largest : float
        Largest compression so far (m).
    stiffness, restitution : float
        Stiffness of loading (N/m) and coefficient of restitution.

    Returns
    -------
    float
        Force (N).
    """
    slack = largest * (1.0 - restitution * restitution)
    if way == 0.0:
        return cushion_force(start, largest, stiffness, restitution)
    unloading = _work(start, start + way, slack, largest, largest, stiffness, restitution)
    return (
        unloading + _work(start, start + way, largest, math.inf, largest, stiffness, restitution)
    ) / way


@kernel
def _work(start, end, low, high, largest, stiffness, restitution):
    """Return the work (J) from start to end (m) between low and high, where the force is linear."""
    begun, done = min(max(start, low), high), min(max(end, low), high)
    forces = cushion_force(begun, largest, stiffness, restitution) + cushion_force(
        done, largest, stiffness, restitution
    )
    return 0.5 * forces * (done - begun)


@kernel
def met(start, free, yielding, largest, stiffness, restitution):
    """Return the mean force F of the cushion in a step.

    Its compression changes by free - y F in the step.

    Newton's method between bounds: the force never falls with the way, so there is one solution.

    Parameters
    ----------
    start : float
        Compression at the start (m).
    free : float
        Way of the compression without the force (m).
    yielding : float
        Way that a unit force takes off, y (m/N).
    largest : float
        Largest compression so far (m).
    stiffness, restitution : float
        Stiffness of loading (N/m) and coefficient of restitution.

    Returns
    -------
    float
        F (N), not negative.
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
