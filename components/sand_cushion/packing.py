"""Places of the discs before they settle: square and hexagonal lattices, a loose random heap."""

import math

from ..common.counter_random import uniform
from ..common.kernels import kernel
from .beam_surface import mean_level
from .bodies import bodies_of
from .contact_search import base_top
from .declarations import BEAM_DISCS, BEAM_SURFACE, HEXAGONAL, LAYER, LAYOUT, RANDOM

V = LAYOUT.scalar

_FIT = 1e-9
"""Part of its diameter by which a disc may be wider than a gap, and still fit into it."""
_LOOSE = 1.05
"""Spacing of the random heap before it falls, in largest diameters."""


@kernel
def disc_mass(radius, w):
    """Return the mass (kg) of a disc, a cylinder as long as the cushion is thick.

    Parameters
    ----------
    radius : float
        Radius of the body (m).
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        Mass (kg).
    """
    density = w[V.density] / (w[V.solid_fraction] if w[V.density_of] == LAYER else 1.0)
    return density * math.pi * radius * radius * w[V.thickness]


@kernel
def set_disc(bodies, i, x, y, radius, w):
    """Place disc i at rest, with centre and radius in m.

    Parameters
    ----------
    bodies : Bodies
        Columns of all bodies.
    i : int
        Number of the disc, or of the rock.
    x : float
        To the right (m).
    y : float
        Upwards (m).
    radius : float
        Radius of the body (m).
    w : ndarray of float64
        Variables of the instance.
    """
    mass = disc_mass(radius, w)
    bodies.x[i], bodies.y[i] = x, y
    bodies.vx[i], bodies.vy[i], bodies.spin[i] = 0.0, 0.0, 0.0
    bodies.radius[i] = radius
    bodies.inverse_mass[i] = 1.0 / mass
    bodies.half_root[i] = 0.5 * math.sqrt(mass)


@kernel
def columns_of(width, diameter):
    """Return the number of discs side by side in a row of ``width`` (m); at least 1.

    Parameters
    ----------
    width : float
        Width (m).
    diameter : float
        Of a disc (m).

    Returns
    -------
    int
    """
    return max(1, int(width / diameter * (1.0 + _FIT)))


@kernel
def mean_base(w, x, k):
    """Return the mean height (m) of the base between the side walls.

    A bent surface lies lower there than its highest top; beam discs lie deeper between their tops.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    float
        Height (m).
    """
    if w[V.base] == BEAM_SURFACE:
        bodies = bodies_of(x, k)
        left = w[V.box_left]
        first, last = bodies.rock + 1, bodies.end - 1
        return mean_level(left, left + w[V.box_width], bodies.rows, first, last)
    valleys = 0.0
    if w[V.base] == BEAM_DISCS:
        valleys = (1.0 - 0.25 * math.pi) * w[V.beam_radius]
    return base_top(w, x, k) - valleys


@kernel
def square_lattice(w, bodies, bottom, stiffness, base_stiffness):
    """Place columns of discs, each compressed by its own weight: at rest on a flat base.

    Parameters
    ----------
    w : ndarray of float64
        Parameters.
    bodies : Bodies
        Columns of all bodies.
    bottom : float
        Height of the base (m).
    stiffness, base_stiffness : float
        k_n between two discs, and of a disc on the base (N/m).
    """
    n, radius = bodies.rock, w[V.disc_radius]
    columns = columns_of(w[V.box_width], 2.0 * radius)
    margin = 0.5 * (w[V.box_width] - columns * 2.0 * radius)
    weight = disc_mass(radius, w) * w[V.gravity]
    for i in range(n):
        line, column = i // columns, i % columns
        height = (n - column + columns - 1) // columns  # discs in this column
        y = bottom + radius - height * weight / base_stiffness
        for below in range(1, line + 1):
            y += 2.0 * radius - (height - below) * weight / stiffness
        set_disc(bodies, i, w[V.box_left] + margin + (2 * column + 1) * radius, y, radius, w)


@kernel
def hexagonal_lattice(w, bodies, bottom):
    """Place rows of c and c - 1 discs in turn on the height ``bottom`` (m).

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.
    bottom : float
        Height of the base (m).
    """
    radius = w[V.disc_radius]
    columns = columns_of(w[V.box_width], 2.0 * radius)
    margin = 0.5 * (w[V.box_width] - columns * 2.0 * radius)
    line, column = 0, 0
    for i in range(bodies.rock):
        odd = line % 2
        x = w[V.box_left] + margin + (2 * column + 1 + odd) * radius
        set_disc(bodies, i, x, bottom + radius * (1.0 + math.sqrt(3.0) * line), radius, w)
        column += 1
        if column >= max(1, columns - odd):
            line += 1
            column = 0


@kernel
def random_heap(w, bodies, bottom):
    """Spread discs of random size loosely over a grid wide enough for the largest.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.
    bottom : float
        Height of the base (m).
    """
    largest = w[V.disc_radius] * (1.0 + w[V.disc_spread])
    cell, seed = 2.0 * largest * _LOOSE, w[V.seed]
    columns = columns_of(w[V.box_width], cell)
    pitch = w[V.box_width] / columns
    for i in range(bodies.rock):
        size = 1.0 + w[V.disc_spread] * (2.0 * uniform(seed, 3 * i) - 1.0)
        radius = w[V.disc_radius] * size
        slack_x, slack_y = 0.5 * pitch - radius, 0.5 * cell - radius
        x = (i % columns + 0.5) * pitch + slack_x * (2.0 * uniform(seed, 3 * i + 1) - 1.0)
        y = (i // columns + 0.5) * cell + slack_y * (2.0 * uniform(seed, 3 * i + 2) - 1.0)
        set_disc(bodies, i, w[V.box_left] + x, bottom + y, radius, w)


@kernel
def shift(w, bodies):
    """Move each disc of a lattice by up to ``lattice_shift`` diameters in both directions.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.
    """
    reach = 2.0 * w[V.disc_radius] * w[V.lattice_shift]
    for i in range(bodies.rock):
        bodies.x[i] += reach * (2.0 * uniform(w[V.seed], 2 * i) - 1.0)
        bodies.y[i] += reach * (2.0 * uniform(w[V.seed], 2 * i + 1) - 1.0)


@kernel
def pack(w, x, k, stiffness, base_stiffness):
    """Place all discs as the parameter ``packing`` says.

    Parameters
    ----------
    w, x : ndarray of float64
        Parameters and state.
    k : ndarray of int64
        Integer state.
    stiffness, base_stiffness : float
        k_n between two discs, and of a disc on the base (N/m); they give a lattice its overlaps.
    """
    bodies, bottom = bodies_of(x, k), base_top(w, x, k)
    if w[V.packing] >= RANDOM:
        random_heap(w, bodies, bottom)
        return
    if w[V.packing] == HEXAGONAL:
        hexagonal_lattice(w, bodies, bottom)
    else:
        square_lattice(w, bodies, bottom, stiffness, base_stiffness)
    if w[V.lattice_shift] > 0.0:
        shift(w, bodies)
