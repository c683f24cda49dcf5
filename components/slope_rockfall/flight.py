"""Motion with constant accelerations, and the exact times at which it meets something.

Equations (15)-(18) of Ushiro; between two events all accelerations are constant.
"""

import math

from ..common.kernels import kernel
from .declarations import BODY, NEVER, PATH


@kernel
def move(b, time):
    """Bring the rock to a time (s) before its next event; it keeps its accelerations.

    Parameters
    ----------
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    time : float
        Time (s).
    """
    span = time - b[BODY.time]
    b[BODY.x] += span * (b[BODY.vx] + 0.5 * span * b[BODY.ax])
    b[BODY.y] += span * (b[BODY.vy] + 0.5 * span * b[BODY.ay])
    b[BODY.angle] += span * (b[BODY.omega] + 0.5 * span * b[BODY.alpha])
    b[BODY.vx] += span * b[BODY.ax]
    b[BODY.vy] += span * b[BODY.ay]
    b[BODY.omega] += span * b[BODY.alpha]
    b[BODY.time] = time


@kernel
def travel(distance, speed, acceleration):
    """Return the time (s) in which a point first goes a distance; NEVER if it turns back before.

    Parameters
    ----------
    distance : float
        Not negative (m).
    speed : float
        At the start, not negative (m/s).
    acceleration : float
        Constant (m/s2).

    Returns
    -------
    float
        The time (s).
    """
    if distance <= 0.0:
        return 0.0
    square = speed * speed + 2.0 * acceleration * distance
    if square < 0.0 or (speed == 0.0 and acceleration <= 0.0):
        return NEVER
    return min(NEVER, 2.0 * distance / (speed + math.sqrt(square)))


@kernel
def passing(place, speed, acceleration, bound, direction):
    """Return the time (s) at which a coordinate passes a bound; NEVER if it does not.

    Parameters
    ----------
    place, speed, acceleration : float
        Coordinate now (m), its velocity (m/s) and constant acceleration (m/s2).
    bound : float
        Value that it passes (m).
    direction : float
        1 for passing upwards, -1 for passing downwards.

    Returns
    -------
    float
        The time (s) from now.
    """
    distance, v, a = direction * (bound - place), direction * speed, direction * acceleration
    square = v * v + 2.0 * a * distance
    if square < 0.0:
        return NEVER
    root = math.sqrt(square)
    turned = (root - v) / a if a > 0.0 else NEVER
    time = 2.0 * distance / (v + root) if v > 0.0 else turned
    return time if 0.0 <= time < NEVER else NEVER


@kernel
def landing(j, x, y, vx, vy, gravity, lines, path):
    """Return when a rock in flight meets the path, and on which line.

    On each line in its way the normal distance is a concave parabola of time: it has one root after
    the entry, which counts if the rock is still over the line then.

    Parameters
    ----------
    j : int
        Line below the centre.
    x, y, vx, vy : float
        Position (m) and velocity (m/s) of the centre.
    gravity : float
        Acceleration of gravity (m/s2).
    lines : int
        Number of lines of the path.
    path : ndarray of float64, shape (lines * len(PATH),)
        The path.

    Returns
    -------
    tuple of float and int
        Time (s) from now, and number of the line.
    """
    entered = 0.0
    while True:
        at = j * len(PATH)
        s, c = path[at + PATH.sin], path[at + PATH.cos]
        height = (x - path[at + PATH.x]) * s + (y - path[at + PATH.y]) * c
        speed, pull = vx * s + vy * c, gravity * c
        meets = max(
            entered, (speed + math.sqrt(max(0.0, speed * speed + 2.0 * pull * height))) / pull
        )
        if vx > 0.0:
            leaves = (path[at + PATH.right] - x) / vx
        elif vx < 0.0:
            leaves = (path[at + PATH.left] - x) / vx
        else:
            return meets, j
        if meets <= leaves or (j >= lines - 1 if vx > 0.0 else j <= 0):
            return meets, j
        entered = max(entered, leaves)
        j += 1 if vx > 0.0 else -1
