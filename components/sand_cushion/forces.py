"""Contact forces on all bodies, and steps of the discs with them."""

from ..common.kernels import kernel, view
from .bodies import disc_count
from .boundaries import press_boundaries
from .declarations import FORCE_ROW, LAYOUT, SUM
from .pairs import press_discs, set_to_zero

A = LAYOUT.array


@kernel
def clear(begin, load, sums):
    """Forget the forces on the bodies from ``begin`` on, and sums that refer to the step before.

    Parameters
    ----------
    begin : int
        First body.
    load : ndarray of float64
        Rows of the loads (N).
    sums : ndarray of float64
        Running sums, :data:`SUM`.
    """
    set_to_zero(load[FORCE_ROW * begin :])
    sums[SUM.elastic] = 0.0
    sums[SUM.transmitted] = 0.0
    sums[SUM.capillary] = 0.0


@kernel
def contact_forces(dt, w, x, k):
    """Compute all contact forces, into the loads of the bodies. See :func:`forget_forces`.

    Parameters
    ----------
    dt : float
        Time (s) by which contact springs advance.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    clear(0, view(x, k, A.load), view(x, k, A.sums))
    press_boundaries(dt, w, x, k)
    press_discs(dt, False, w, x, k)


@kernel
def forget_forces(x, k):
    """Forget the forces on the discs, as :func:`advance_discs` needs it.

    Parameters
    ----------
    x : ndarray of float64
        State; the forces on rock and beam stay.
    k : ndarray of int64
        Integer state.
    """
    set_to_zero(view(x, k, A.load)[: FORCE_ROW * disc_count(k)])


@kernel
def advance_discs(dt, w, x, k):
    """Compute all contact forces and advance the discs with them.

    Parameters
    ----------
    dt : float
        Time step (s).
    w, x : ndarray of float64
        Variables and state; the forces on rock and beam are left in their loads.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    tuple of float
        Kinetic and potential energy (J) at the beginning of the step.
    """
    clear(disc_count(k), view(x, k, A.load), view(x, k, A.sums))
    press_boundaries(dt, w, x, k)
    return press_discs(dt, True, w, x, k)
