"""The beam's top as a surface: straight lines between the tops of the beam's discs.

The top of a disc lies a radius above its centre and moves with its small angle: by ``-radius *
angle`` along the beam, as the torque ``-radius * force`` of a force there has it. Beyond the
outermost tops the last lines go on. A force on the surface is shared by the two discs beside its
foot after the lever rule, which is the gradient of the distance by their tops: what the contacts
store is what the beam gives them.
"""

import math
from collections import namedtuple

from ..common.kernels import inlined, kernel
from .declarations import ANGLE, INDEX, RADIUS, ROW

_NEAR = 0.2
"""Share of a line from its ends within which a foot may belong to the next line: far more than the
border of both leans over it, as long as they meet at less than 0.4 of length / distance (rad)."""

Lever = namedtuple("Lever", "left right share")
"""A place on the beam: the beam discs left and right of it, and the share of the right one, below 0
and above 1 beyond the outermost tops."""

Foot = namedtuple("Foot", "lever nx ny height")
"""The place on the surface that is nearest to a point: its :class:`Lever`, the normal from the
point to the surface, and the distance (m), negative below it."""


@inlined
def top_of(b, rows):
    """Return the top (m) of beam disc b, to the right and upwards.

    Parameters
    ----------
    b : int
        Number of the beam disc.
    rows : ndarray of float64
        Rows of all bodies.

    Returns
    -------
    tuple of float
        Place (m).
    """
    at = ROW * b & INDEX
    radius = rows[at + RADIUS]
    return rows[at] - radius * rows[at + ANGLE], rows[at + 1] + radius


@inlined
def is_before(b, x, y, rows):
    """Return whether a point belongs to the surface left of the inner beam disc b.

    The border goes through its top, at a right angle to the chord of the tops beside it: discs that
    are evenly spaced have it halve the surface's angle, and no distance jumps there.

    Parameters
    ----------
    b : int
        Number of the beam disc.
    x, y : float
        Point (m).
    rows : ndarray of float64
        Rows of all bodies.

    Returns
    -------
    bool
    """
    top_x, top_y = top_of(b, rows)
    left_x, left_y = top_of(b - 1, rows)
    right_x, right_y = top_of(b + 1, rows)
    return (x - top_x) * (right_x - left_x) + (y - top_y) * (right_y - left_y) < 0.0


@inlined
def line_at(x, rows, first, last):
    """Return the beam disc at the left end of the line at a place, as if discs were evenly spaced.

    Parameters
    ----------
    x : float
        Place (m).
    rows : ndarray of float64
        Rows of all bodies.
    first, last : int
        Numbers of the outermost beam discs, two at least.

    Returns
    -------
    int
        Number of the beam disc.
    """
    begin, lines = rows[ROW * first], last - first
    number = math.floor((x - begin) / (rows[ROW * last] - begin) * lines)
    return first + min(lines - 1, max(0, number))


@inlined
def foot_on_line(left, x, y, rows):
    """Return the :class:`Foot` of a point on the line right of beam disc ``left``.

    Parameters
    ----------
    left : int
        Number of the beam disc.
    x, y : float
        Point (m).
    rows : ndarray of float64
        Rows of all bodies.

    Returns
    -------
    Foot
    """
    top_x, top_y = top_of(left, rows)
    right_x, right_y = top_of(left + 1, rows)
    along_x, along_y = right_x - top_x, right_y - top_y
    per_length = 1.0 / math.sqrt(along_x * along_x + along_y * along_y)
    along_x, along_y = along_x * per_length, along_y * per_length
    dx, dy = x - top_x, y - top_y
    share = (dx * along_x + dy * along_y) * per_length
    height = dy * along_x - dx * along_y
    return Foot(Lever(left, left + 1, share), along_y, -along_x, height)


@inlined
def foot_of(x, y, bodies):
    """Return the :class:`Foot` of a point on the surface; a single disc is a level plane.

    Parameters
    ----------
    x, y : float
        Point (m).
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    Foot
    """
    return foot_among(x, y, bodies.rows, bodies.rock + 1, bodies.end - 1)


@kernel
def foot_among(x, y, rows, first, last):
    """Return the :class:`Foot` of a point, from all lines between the outermost discs.

    Only a foot near an end of its line can belong to the next one. This is no part of its callers:
    set into the loop over the contacts with boundaries, it would slow down all of them.

    Parameters
    ----------
    x, y : float
        Point (m).
    rows : ndarray of float64
        Rows of all bodies.
    first, last : int
        Numbers of the outermost beam discs.

    Returns
    -------
    Foot
    """
    if first == last:
        _, top_y = top_of(first, rows)
        return Foot(Lever(first, first, 0.0), 0.0, -1.0, y - top_y)
    left = line_at(x, rows, first, last)
    foot = foot_on_line(left, x, y, rows)
    while foot.lever.share < _NEAR and left > first and is_before(left, x, y, rows):
        left -= 1
        foot = foot_on_line(left, x, y, rows)
    while (
        foot.lever.share > 1.0 - _NEAR and left < last - 1 and not is_before(left + 1, x, y, rows)
    ):
        left += 1
        foot = foot_on_line(left, x, y, rows)
    return foot


@inlined
def lever_at(x, bodies):
    """Return the :class:`Lever` of the place on the surface above or below ``x`` (m).

    Parameters
    ----------
    x : float
        Place (m).
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    Lever
    """
    return lever_among(x, bodies.rows, bodies.rock + 1, bodies.end - 1)


@kernel
def lever_among(x, rows, first, last):
    """Return the :class:`Lever` of a place, from all lines between the outermost discs.

    Parameters
    ----------
    x : float
        Place (m).
    rows : ndarray of float64
        Rows of all bodies.
    first, last : int
        Numbers of the outermost beam discs.

    Returns
    -------
    Lever
    """
    if first == last:
        return Lever(first, first, 0.0)
    left = line_at(x, rows, first, last)
    left_x, _ = top_of(left, rows)
    while left > first and x < left_x:
        left -= 1
        left_x, _ = top_of(left, rows)
    right_x, _ = top_of(left + 1, rows)
    while left < last - 1 and x >= right_x:
        left += 1
        left_x = right_x
        right_x, _ = top_of(left + 1, rows)
    return Lever(left, left + 1, (x - left_x) / (right_x - left_x))


@inlined
def surface_height(lever, bodies):
    """Return the height (m) of the surface at a place.

    Parameters
    ----------
    lever : Lever
        Place on the beam.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    float
        Height (m).
    """
    _, left = top_of(lever.left, bodies.rows)
    _, right = top_of(lever.right, bodies.rows)
    return (1.0 - lever.share) * left + lever.share * right


@kernel
def mean_level(left, right, rows, first, last):
    """Return the mean height of the surface between two places.

    The first and the last line go on beyond the outermost tops.

    Parameters
    ----------
    left, right : float
        Places, left < right (m).
    rows : ndarray of float64
        Rows of all bodies.
    first, last : int
        Numbers of the outermost beam discs.

    Returns
    -------
    float
        Height (m).
    """
    _, level = top_of(first, rows)
    area = 0.0
    for b in range(first, last):
        begin_x, begin_y = top_of(b, rows)
        end_x, end_y = top_of(b + 1, rows)
        begin = left if b == first else max(left, begin_x)
        end = right if b == last - 1 else min(right, end_x)
        middle = 0.5 * (begin + end)
        height = begin_y + (middle - begin_x) / (end_x - begin_x) * (end_y - begin_y)
        if end > begin:
            area += (end - begin) * (height - level)
    return level + area / (right - left)


@inlined
def surface_velocity(lever, bodies):
    """Return the velocity (m/s) of the surface at a place, to the right and upwards.

    Parameters
    ----------
    lever : Lever
        Place on the beam.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    tuple of float
        Velocity (m/s).
    """
    left, right, share = lever.left, lever.right, lever.share
    vx = (1.0 - share) * (bodies.vx[left] - bodies.spin[left]) + share * (
        bodies.vx[right] - bodies.spin[right]
    )
    return vx, (1.0 - share) * bodies.vy[left] + share * bodies.vy[right]


@inlined
def load_top(b, share, fx, fy, bodies):
    """Give beam disc b its share of a force (N) at the surface.

    Parameters
    ----------
    b : int
        Number of the beam disc.
    share : float
        Of the force.
    fx : float
        Force to the right (N).
    fy : float
        Force upwards (N).
    bodies : Bodies
        Columns of all bodies.
    """
    bodies.force_x[b] += share * fx
    bodies.force_y[b] += share * fy
    bodies.turn[b] -= share * fx


@inlined
def load_surface(lever, fx, fy, bodies):
    """Hand a force (N) at a place of the surface to the two discs beside it.

    Parameters
    ----------
    lever : Lever
        Place on the beam.
    fx : float
        Force to the right (N).
    fy : float
        Force upwards (N).
    bodies : Bodies
        Columns of all bodies.
    """
    load_top(lever.left, 1.0 - lever.share, fx, fy, bodies)
    if lever.right != lever.left:
        load_top(lever.right, lever.share, fx, fy, bodies)
