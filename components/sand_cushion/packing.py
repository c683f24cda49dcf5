"""Where the discs lie before they settle: square and hexagonal lattices, and a loose random heap."""

import math

from ..common.counter_random import uniform
from ..common.kernels import kernel, view
from .contact_search import base_top, beam_count, disc_count
from .declarations import (
    BEAM_DISCS,
    HALF_ROOT,
    HEXAGONAL,
    INVERSE_MASS,
    LAYER,
    LAYOUT,
    RADIUS,
    RANDOM,
    ROW,
    SPIN,
)

V, A = LAYOUT.scalar, LAYOUT.array

_FIT = 1e-9
"""A disc fits into a gap that is too narrow by this part of its diameter."""
_LOOSE = 1.05
"""Spacing of the random heap before it falls, in largest diameters."""


@kernel
def disc_mass(radius, w):
    """Mass (kg) of a disc: a cylinder of the cushion's depth."""
    density = w[V.unit_weight] / (w[V.solid_fraction] if w[V.unit_weight_of] == LAYER else 1.0)
    return density * math.pi * radius * radius * w[V.depth]


@kernel
def set_disc(body, i, x, y, radius, w):
    """Place disc i at rest."""
    mass = disc_mass(radius, w)
    body[ROW * i], body[ROW * i + 1] = x, y
    body[ROW * i + 2], body[ROW * i + 3], body[ROW * i + SPIN] = 0.0, 0.0, 0.0
    body[ROW * i + RADIUS], body[ROW * i + INVERSE_MASS], body[ROW * i + HALF_ROOT] = (
        radius,
        1.0 / mass,
        0.5 * math.sqrt(mass),
    )


@kernel
def columns_of(width, diameter):
    """Number of discs side by side in a row of ``width`` (m); at least 1."""
    return max(1, int(width / diameter * (1.0 + _FIT)))


@kernel
def foundation(w, body, n, m):
    """Height (m) on which the lowest row is placed."""
    if w[V.base] == BEAM_DISCS:
        top = -math.inf
        for b in range(n + 1, n + m + 1):
            top = max(top, body[ROW * b + 1] + body[ROW * b + RADIUS])
        return top
    return base_top(w, body, n, m)


@kernel
def mean_base(w, body, n, m):
    """Mean height (m) of what the sand lies on; between beam discs it lies deeper than their tops."""
    valleys = (1.0 - 0.25 * math.pi) * w[V.beam_radius] if w[V.base] == BEAM_DISCS else 0.0
    return foundation(w, body, n, m) - valleys


@kernel
def square_lattice(w, body, n, bottom, stiffness, base_stiffness):
    """Columns of discs, each compressed by its own weight: at rest when they stand on a flat base."""
    radius = w[V.disc_radius]
    columns = columns_of(w[V.box_width], 2.0 * radius)
    margin = 0.5 * (w[V.box_width] - columns * 2.0 * radius)
    weight = disc_mass(radius, w) * w[V.gravity]
    for i in range(n):
        line, column = i // columns, i % columns
        height = (n - column + columns - 1) // columns  # discs in this column
        y = bottom + radius - height * weight / base_stiffness
        for below in range(1, line + 1):
            y += 2.0 * radius - (height - below) * weight / stiffness
        set_disc(body, i, w[V.box_left] + margin + (2 * column + 1) * radius, y, radius, w)


@kernel
def hexagonal_lattice(w, body, n, bottom):
    """Rows of c and c - 1 discs in turn."""
    radius = w[V.disc_radius]
    columns = columns_of(w[V.box_width], 2.0 * radius)
    margin = 0.5 * (w[V.box_width] - columns * 2.0 * radius)
    line, column = 0, 0
    for i in range(n):
        odd = line % 2
        x = w[V.box_left] + margin + (2 * column + 1 + odd) * radius
        set_disc(body, i, x, bottom + radius * (1.0 + math.sqrt(3.0) * line), radius, w)
        column += 1
        if column >= max(1, columns - odd):
            line, column = line + 1, 0


@kernel
def random_heap(w, body, n, bottom):
    """Discs of random size, loosely spread over a grid wide enough for the largest."""
    largest = w[V.disc_radius] * (1.0 + w[V.disc_spread])
    cell = 2.0 * largest * _LOOSE
    columns = columns_of(w[V.box_width], cell)
    pitch = w[V.box_width] / columns
    for i in range(n):
        radius = w[V.disc_radius] * (
            1.0 + w[V.disc_spread] * (2.0 * uniform(w[V.seed], 3 * i) - 1.0)
        )
        slack_x, slack_y = 0.5 * pitch - radius, 0.5 * cell - radius
        x = (i % columns + 0.5) * pitch + slack_x * (2.0 * uniform(w[V.seed], 3 * i + 1) - 1.0)
        y = (i // columns + 0.5) * cell + slack_y * (2.0 * uniform(w[V.seed], 3 * i + 2) - 1.0)
        set_disc(body, i, w[V.box_left] + x, bottom + y, radius, w)


@kernel
def shift(w, body, n):
    """Move each disc of a lattice by up to ``lattice_shift`` diameters in both directions."""
    reach = 2.0 * w[V.disc_radius] * w[V.lattice_shift]
    for i in range(n):
        body[ROW * i] += reach * (2.0 * uniform(w[V.seed], 2 * i) - 1.0)
        body[ROW * i + 1] += reach * (2.0 * uniform(w[V.seed], 2 * i + 1) - 1.0)


@kernel
def pack(w, x, k, stiffness, base_stiffness):
    """Place all discs as the parameter ``packing`` says; k_n between discs and of the base (N/m) give a lattice its overlaps."""
    n, m = disc_count(k), beam_count(k)
    body = view(x, k, A.body)
    bottom = foundation(w, body, n, m)
    if w[V.packing] >= RANDOM:
        random_heap(w, body, n, bottom)
        return
    if w[V.packing] == HEXAGONAL:
        hexagonal_lattice(w, body, n, bottom)
    else:
        square_lattice(w, body, n, bottom, stiffness, base_stiffness)
    if w[V.lattice_shift] > 0.0:
        shift(w, body, n)
