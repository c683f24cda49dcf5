"""The path of the rock's centre: the slope, moved outwards by the rock's radius.

A rock touches a facet when its centre lies on the facet's line moved out by r, and a corner when it
lies on the arc of radius r round it. The path is the upper envelope of these: a cell too narrow for
the rock drops out. The arcs are replaced by tangents, so that no joint round a corner turns by more
than 30 degrees: the path lies on or above the exact one, by less than 3.6 % of r. The rock never
cuts into the slope, and all its motion is that of a point on straight lines.
"""

import math

from ..common.kernels import kernel, view
from .declarations import LAYOUT, NEVER, PATH, STEEPEST_JOINT

V, A = LAYOUT.scalar, LAYOUT.array

_PARALLEL = 1e-9
"""Sine of the turn below which two lines count as parallel."""
_HALVINGS = 100
_UPRIGHT = 0.5 * math.pi - 1e-3
"""Steepest tangent (rad) of a corner."""


@kernel
def node(i, w, k):
    """Return the coordinates (m) of node i of the slope.

    Parameters
    ----------
    i : int
        Number of the node or cell.
    w, k : ndarray
        Variables and integers of the instance.

    Returns
    -------
    tuple of float
        x and y (m).
    """
    if i == 0:
        return w[V.profile_x], w[V.profile_y]
    return view(w, k, A.end_x)[i - 1], view(w, k, A.end_y)[i - 1]


@kernel
def inclination(i, w, k):
    """Return the angle (rad) of cell i, positive if it descends to the right.

    Parameters
    ----------
    i : int
        Number of the node or cell.
    w, k : ndarray
        Variables and integers of the instance.

    Returns
    -------
    float
        Angle (rad).
    """
    x0, y0 = node(i, w, k)
    x1, y1 = node(i + 1, w, k)
    return math.atan2(y0 - y1, x1 - x0)


# --- which cells the rock can touch ---
#
# The centre of a rock that touches a cell with its corners lies on a line with an arc of radius r
# at either end. Of two cells the left one's lies higher on the left and lower on the right, for it
# consists of arcs round points that are all farther left. So each cell, from left to right, hides
# the newest ones altogether or from one place on.


@kernel
def facet_range(i, cells, radius, w, k):
    """Return the range of x (m) of the centre of a rock that touches cell i between its corners.

    The end cells have no end.

    Parameters
    ----------
    i : int
        Number of the node or cell.
    cells : int
        Number of cells.
    radius : float
        Radius of the rock (m).
    w, k : ndarray
        Variables and integers of the instance.

    Returns
    -------
    tuple of float
        Smallest and largest x (m).
    """
    s = math.sin(inclination(i, w, k))
    left, _ = node(i, w, k)
    right, _ = node(i + 1, w, k)
    return left + radius * s if i > 0 else -NEVER, right + radius * s if i < cells - 1 else NEVER


@kernel
def centre_y(i, x, cells, radius, w, k):
    """Return the height (m) of the centre, at x, of a rock that touches cell i or its corners.

    Parameters
    ----------
    i : int
        Number of the cell.
    x : float
        Place of the centre (m), not beyond the arcs round the corners.
    cells : int
        Number of cells.
    radius : float
        Radius of the rock (m).
    w, k : ndarray
        Parameters and table of arrays.

    Returns
    -------
    float
        Height (m).
    """
    begin, end = facet_range(i, cells, radius, w, k)
    px, py = node(i + 1 if x > end else i, w, k)
    if begin <= x <= end:
        angle = inclination(i, w, k)
        return py + radius / math.cos(angle) - (x - px) * math.tan(angle)
    return py + math.sqrt(max(0.0, radius * radius - (x - px) * (x - px)))


@kernel
def takeover(i, other, cells, radius, w, k):
    """Return the x (m) from which on a rock touches a cell farther right, and not cell i.

    Parameters
    ----------
    i, other : int
        Numbers of the two cells, ``other`` on the right.
    cells : int
        Number of cells.
    radius : float
        Radius of the rock (m).
    w, k : ndarray
        Parameters and table of arrays.

    Returns
    -------
    float
        Place of the rock's centre (m).
    """
    if other == i + 1 and inclination(other, w, k) >= inclination(i, w, k):
        return facet_range(i, cells, radius, w, k)[1]
    low, high = node(other, w, k)[0] - radius, node(i + 1, w, k)[0] + radius
    if low >= high:
        return low
    if i > 0:
        low = max(low, node(i, w, k)[0] - radius)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        is_last = middle in (low, high)
        if centre_y(other, middle, cells, radius, w, k) >= centre_y(i, middle, cells, radius, w, k):
            high = middle
        else:
            low = middle
        if is_last:
            break
    return high


@kernel
def visible(w, x, k):
    """List the cells that the rock can touch, from left to right, and return their number.

    ``order`` gets the cells, ``order_begin`` the x (m) from which on the rock touches each.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    int
        Number of these cells.
    """
    begin, order = view(x, k, A.order_begin), view(k, k, A.order)
    cells = k[A.end_x + 1]
    count = 0
    for i in range(cells):
        place = -NEVER
        while count > 0:
            place = takeover(order[count - 1], i, cells, w[V.radius], w, k)
            if place > begin[count - 1]:
                break
            count -= 1
        begin[count] = place if count > 0 else -NEVER
        order[count] = i
        count += 1
    begin[count] = NEVER
    return count


# --- the path of straight lines ---


@kernel
def build_path(w, x, k):
    """Lay the lines of the path from left to right; their number goes to ``lines``.

    The first and the last have no end.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.
    """
    begin, order, path = view(x, k, A.order_begin), view(k, k, A.order), view(x, k, A.path)
    cells = k[A.end_x + 1]
    count = 0
    for q in range(visible(w, x, k)):
        i, start, end = order[q], begin[q], begin[q + 1]
        line_start, line_end = facet_range(i, cells, w[V.radius], w, k)
        if start < line_start:
            joined = (
                q > 0
                and order[q - 1] == i - 1
                and start == facet_range(i - 1, cells, w[V.radius], w, k)[1]
            )
            count = round_corner(
                count, i, start, min(end, line_start), joined, end > line_start, w, k, path
            )
        if start < line_end and end > line_start:
            angle = inclination(i, w, k)
            px, py = node(i, w, k)
            count = append(count, angle, px, py, w[V.radius], i, angle, angle, start, path)
        if end > line_end:
            count = round_corner(
                count, i + 1, max(start, line_end), end, start < line_end, False, w, k, path
            )
    view(k, k, A.lines)[0] = count


@kernel
def round_corner(count, i, start, end, after_facet, before_facet, w, k, path):
    """Append tangents of the arc round node i between two x (m), and return the number of lines.

    Parameters
    ----------
    count : int
        Number of lines so far.
    i : int
        Number of the node.
    start, end : float
        Range of the centre (m).
    after_facet, before_facet : bool
        Whether the first tangent is a facet's line, and whether the last one is.
    w, k : ndarray
        Parameters and table of arrays.
    path : ndarray of float64
        The path.

    Returns
    -------
    int
        Number of lines.
    """
    px, py = node(i, w, k)
    first = math.asin(min(max((start - px) / w[V.radius], -1.0), 1.0))
    last = math.asin(min(max((end - px) / w[V.radius], -1.0), 1.0))
    steps = max(1, math.ceil((last - first) / STEEPEST_JOINT))
    for q in range(1 if after_facet else 0, steps if before_facet else steps + 1):
        angle = min(max(first + (last - first) * q / steps, -_UPRIGHT), _UPRIGHT)
        count = append(count, angle, px, py, w[V.radius], max(0, i - 1), first, last, start, path)
    return count


@kernel
def append(count, angle, px, py, radius, cell, left, right, begin, path):
    """Append a line at distance ``radius`` from a node, and return the new number of lines.

    Parameters
    ----------
    count : int
        Number of lines so far.
    angle : float
        Inclination of the line (rad).
    px, py, radius : float
        The node and the distance from it (m).
    cell : int
        Cell whose material the line has.
    left, right : float
        Angles of the facets on either side (rad).
    begin : float
        Where the line begins (m) if it is parallel to the one before.
    path : ndarray of float64
        The path.

    Returns
    -------
    int
        Number of lines.
    """
    s, c = math.sin(angle), math.cos(angle)
    x, y = px + radius * s, py + radius * c
    start = -NEVER
    if count > 0:
        before = (count - 1) * len(PATH)
        start = max(crossing(count - 1, s, c, x, y, begin, path), path[before + PATH.left])
        path[before + PATH.right] = start
    at = count * len(PATH)
    path[at + PATH.left], path[at + PATH.right] = start, NEVER
    path[at + PATH.x], path[at + PATH.y] = x, y
    path[at + PATH.sin], path[at + PATH.cos] = s, c
    path[at + PATH.angle] = angle
    path[at + PATH.ahead_left], path[at + PATH.ahead_right] = left, right
    path[at + PATH.cell] = cell
    return count + 1


@kernel
def crossing(j, s, c, x, y, otherwise, path):
    """Return the x (m) at which line j of the path meets another line.

    Parameters
    ----------
    j : int
        Number of the line.
    s, c, x, y : float
        Sine and cosine of the other line's inclination, and a point on it (m).
    otherwise : float
        Returned if they are parallel (m).
    path : ndarray of float64
        The path.

    Returns
    -------
    float
        x (m) of the crossing.
    """
    at = j * len(PATH)
    s0, c0 = path[at + PATH.sin], path[at + PATH.cos]
    turn = s * c0 - c * s0
    if abs(turn) < _PARALLEL:
        return otherwise
    gap = (x - path[at + PATH.x]) * s + (y - path[at + PATH.y]) * c
    return path[at + PATH.x] + gap * c0 / turn


@kernel
def line_below(x, lines, path):
    """Return the number of the line of the path above or below x (m).

    Parameters
    ----------
    x : float
        Place (m).
    lines : int
        Number of its lines.
    path : ndarray of float64, shape (lines * len(PATH),)
        The path.

    Returns
    -------
    int
        Number of the line.
    """
    low, high = 0, lines - 1
    while low < high:
        middle = (low + high) // 2
        if x < path[middle * len(PATH) + PATH.right]:
            high = middle
        else:
            low = middle + 1
    return low


@kernel
def height_above(j, x, y, path):
    """Return the distance (m) of the centre from line j of the path, along its normal.

    It is that of the rock from the facet.

    Parameters
    ----------
    j : int
        Line of the path.
    x : float
        Place of the centre, to the right (m).
    y : float
        Height of the centre (m).
    path : ndarray of float64, shape (lines * len(PATH),)
        The path.

    Returns
    -------
    float
        Distance (m), negative below the line.
    """
    at = j * len(PATH)
    return (x - path[at + PATH.x]) * path[at + PATH.sin] + (y - path[at + PATH.y]) * path[
        at + PATH.cos
    ]


@kernel
def path_y(j, x, path):
    """Return the height y (m) of line j of the path at x.

    Parameters
    ----------
    j : int
        Line of the path.
    x : float
        Place (m).
    path : ndarray of float64, shape (lines * len(PATH),)
        The path.

    Returns
    -------
    float
        Height (m).
    """
    at = j * len(PATH)
    return path[at + PATH.y] - (x - path[at + PATH.x]) * path[at + PATH.sin] / path[at + PATH.cos]
