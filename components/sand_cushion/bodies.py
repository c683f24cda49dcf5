"""Bodies of the cushion as columns of one table, and their numbers.

Discs come first, 0 .. N-1, then the rock, N, then the beam discs, N+1 .. N+M. Behind them lies a
body far away for each part of the discs: partner in pairs that fill up a block.
"""

from collections import namedtuple

from ..common.kernels import inlined, kernel, view
from .declarations import (
    ANGLE,
    FORCE_ROW,
    HALF_ROOT,
    INVERSE_MASS,
    LAYOUT,
    RADIUS,
    ROW,
    SPIN,
)

A = LAYOUT.array

Bodies = namedtuple(
    "Bodies",
    "x y vx vy spin radius inverse_mass half_root angle force_x force_y turn rock end rows loads",
)
"""Columns of the bodies, an element a body: position (m), velocity (m/s), surface speed omega r
(m/s), radius (m), 1/mass (1/kg), sqrt(mass)/2 (kg^0.5), angle (rad; of rock and beam discs, in the
place of 1/mass), contact force (N), torque / radius (N). ``rock`` is the number of the rock,
``end`` the one behind the last beam disc; ``rows`` and ``loads`` hold all these numbers body by
body."""


@kernel
def disc_count(k):
    """Return the number N of sand discs.

    Parameters
    ----------
    k : ndarray of int64
        Integers of the instance.

    Returns
    -------
    int
    """
    return k[A.angle + 1]


@kernel
def beam_count(k):
    """Return the number M of beam discs.

    Parameters
    ----------
    k : ndarray of int64
        Integers of the instance.

    Returns
    -------
    int
    """
    return k[A.beam_position_x + 1]


@inlined
def bodies_of(x, k):
    """Return the :class:`Bodies` of a state, views of its buffer.

    Parameters
    ----------
    x, k : ndarray
        State and integers of the instance.

    Returns
    -------
    Bodies
    """
    rows, loads = view(x, k, A.body), view(x, k, A.load)
    rock = disc_count(k)
    return Bodies(
        rows[0::ROW],
        rows[1::ROW],
        rows[2::ROW],
        rows[3::ROW],
        rows[SPIN::ROW],
        rows[RADIUS::ROW],
        rows[INVERSE_MASS::ROW],
        rows[HALF_ROOT::ROW],
        rows[ANGLE::ROW],
        loads[0::FORCE_ROW],
        loads[1::FORCE_ROW],
        loads[2::FORCE_ROW],
        rock,
        rock + 1 + beam_count(k),
        rows,
        loads,
    )
