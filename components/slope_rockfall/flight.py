"""Motion with constant accelerations between two events, and the exact times at which it meets something. Equations (15)-(18)."""

import math

from ..common.kernels import kernel
from .declarations import BODY, NEVER, PATH


@kernel
def move(b, time):
    """Bring the rock to a time (s) before its next event; it keeps its accelerations."""
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
    """Time (s) in which a point with this speed >= 0 has gone ``distance`` >= 0 first; NEVER if it turns back before."""
    if distance <= 0.0:
        return 0.0
    square = speed * speed + 2.0 * acceleration * distance
    if square < 0.0 or (speed == 0.0 and acceleration <= 0.0):
        return NEVER
    return min(NEVER, 2.0 * distance / (speed + math.sqrt(square)))


@kernel
def passing(place, speed, acceleration, bound, direction):
    """Time (s) at which a coordinate passes ``bound`` in this direction (+1 or -1); NEVER if it does not."""
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
    """Time (s) from now at which a rock in flight meets the path, and the number of the line that it meets.

    (x, y): centre, above line j. On each line in its way the normal distance is a concave parabola of time: it has one root
    after the entry, which counts if the rock is still over the line then.
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
