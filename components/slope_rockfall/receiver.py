"""The receiver: a box in which the rock is handed over.

There it moves under its weight and the forces that come from outside.
"""

from ..common.kernels import kernel
from .declarations import BODY, NEVER
from .flight import passing


@kernel
def inside(world, x, y):
    """Tell whether a centre at (x, y), in m, lies in the receiver, sides included.

    Parameters
    ----------
    world : World
        Constants of the trial.
    x : float
        Place of the centre (m).
    y : float
        Height of the centre (m).

    Returns
    -------
    bool
    """
    return world.receiver and world.left <= x <= world.right and world.bottom <= y <= world.top


@kernel
def entrance(world, b):
    """Return the time (s) from now at which the rock enters the receiver; NEVER if it does not.

    Its present accelerations stay.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    float
        Time (s).
    """
    if not world.receiver:
        return NEVER
    x, y, vx, vy, ax, ay = b[BODY.x], b[BODY.y], b[BODY.vx], b[BODY.vy], b[BODY.ax], b[BODY.ay]
    first = NEVER
    for bound, direction in ((world.left, 1.0), (world.right, -1.0)):
        time = passing(x, vx, ax, bound, direction)
        if time < first and world.bottom <= y + time * (vy + 0.5 * time * ay) <= world.top:
            first = time
    for bound, direction in ((world.bottom, 1.0), (world.top, -1.0)):
        time = passing(y, vy, ay, bound, direction)
        if time < first and world.left <= x + time * (vx + 0.5 * time * ax) <= world.right:
            first = time
    return first


@kernel
def departure(world, b):
    """Return the time (s) from now at which a rock that is handed over leaves the receiver.

    It moves under its weight alone; the time is 0 if it is outside.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    float
        Time (s).
    """
    x, y, vx, vy, ax, ay = b[BODY.x], b[BODY.y], b[BODY.vx], b[BODY.vy], b[BODY.ax], b[BODY.ay]
    if not inside(world, x, y) and not approaches(world, b):
        return 0.0
    return min(
        min(passing(x, vx, ax, world.left, -1.0), passing(x, vx, ax, world.right, 1.0)),
        min(passing(y, vy, ay, world.bottom, -1.0), passing(y, vy, ay, world.top, 1.0)),
    )


@kernel
def approaches(world, b):
    """Tell whether a rock outside a side goes inwards: rounding may leave it there as it enters.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    bool
    """
    x, y, vx, vy = b[BODY.x], b[BODY.y], b[BODY.vx], b[BODY.vy]
    return (
        (x >= world.left or vx > 0.0)
        and (x <= world.right or vx < 0.0)
        and (y >= world.bottom or vy > 0.0)
        and (y <= world.top or vy < 0.0)
    )
