"""Levelling of a prepared layer: discs that stand out of its surface are put into hollows."""

import math

from ..common.kernels import kernel, view
from .bodies import bodies_of
from .contact_search import base_top
from .declarations import FORCE_ROW, LAYOUT
from .pairs import set_to_zero

V, A = LAYOUT.scalar, LAYOUT.array

_PITCH = 0.5
"""Distance of the places at which a disc may be put, in mean radii."""
_WORTH = 0.5
"""Least height by which a disc must come down to be moved, in mean radii."""


@kernel
def highest_disc(bodies):
    """Return the number of the disc whose top is highest.

    Parameters
    ----------
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    int
    """
    found = 0
    for i in range(bodies.rock):
        if bodies.y[i] + bodies.radius[i] > bodies.y[found] + bodies.radius[found]:
            found = i
    return found


@kernel
def find_rest(moved, pitch, heights, bodies, left):
    """Write the heights (m) of its centre at which a disc from above would touch the other discs.

    Parameters
    ----------
    moved : int
        Number of the disc.
    pitch : float
        Distance (m) of the places, from ``left`` on.
    heights : ndarray of float64
        At each place; before, the least height that there may be (m).
    bodies : Bodies
        Columns of all bodies.
    left : float
        First place (m).
    """
    for j in range(bodies.rock):
        if j == moved:
            continue
        reach = bodies.radius[moved] + bodies.radius[j]
        begin = max(0, math.ceil((bodies.x[j] - reach - left) / pitch))
        end = min(heights.size - 1, math.floor((bodies.x[j] + reach - left) / pitch))
        for place in range(begin, end + 1):
            aside = left + place * pitch - bodies.x[j]
            above = math.sqrt(max(0.0, reach * reach - aside * aside))
            heights[place] = max(heights[place], bodies.y[j] + above)


@kernel
def put_lower(moved, room, w, bodies, bottom):
    """Put a disc at rest where it comes to lie lowest, if that is worth it; returns whether.

    Parameters
    ----------
    moved : int
        Number of the disc.
    room : ndarray of float64
        Room for the heights at all places.
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.
    bottom : float
        Height (m) under which no disc is put.

    Returns
    -------
    bool
    """
    radius, pitch = bodies.radius[moved], _PITCH * w[V.disc_radius]
    left = w[V.box_left] + radius
    count = 1 + max(0, math.floor((w[V.box_width] - 2.0 * radius) / pitch))
    heights = room[: min(room.size, count)]
    for place in range(heights.size):
        heights[place] = bottom + radius
    find_rest(moved, pitch, heights, bodies, left)
    lowest = 0
    for place in range(heights.size):
        if heights[place] < heights[lowest]:
            lowest = place
    if heights[lowest] > bodies.y[moved] - _WORTH * w[V.disc_radius]:
        return False
    bodies.x[moved], bodies.y[moved] = left + lowest * pitch, heights[lowest]
    bodies.vx[moved], bodies.vy[moved], bodies.spin[moved] = 0.0, 0.0, 0.0
    return True


@kernel
def level(w, x, k):
    """Put the highest disc into the deepest hollow, again and again until it is not worth it.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance; the loads of the discs are 0 and stay it. The
        lists of contacts are to be made anew.
    """
    bodies, bottom = bodies_of(x, k), base_top(w, x, k)
    room = view(x, k, A.load)[: FORCE_ROW * bodies.rock]
    for _ in range(bodies.rock):
        if not put_lower(highest_disc(bodies), room, w, bodies, bottom):
            break
    set_to_zero(room)
