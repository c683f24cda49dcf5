"""Balances that every scheme keeps: soil, head, envelopes of stress."""

from ..common.kernels import kernel, view
from ..common.smith_soil import Soil, drag, stored, stretched
from .declarations import LAYOUT, SOIL

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def shaft_soil(i, w, x, k):
    """Return the soil at the shaft beside node i.

    Node i is the lower end of segment i - 1. The head and the ground below the toe have no shaft:
    their soil is without resistance.

    Parameters
    ----------
    i : int
        Node; 0 is the head, or the ram of masses and springs.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    Soil
        State and constants.
    """
    stretch = view(x, k, A.soil)
    n = k[A.impedance + 1]
    at = min(max(i - 1, 0), n - 1)
    resistance = view(w, k, A.shaft_resistance)[at] if 0 < i <= n else 0.0
    return Soil(
        stretch[i], view(w, k, A.shaft_quake)[at], resistance, view(w, k, A.shaft_damping)[at], True
    )


@kernel
def toe_soil(at_toe, w, x, k):
    """Return the soil under the toe; elsewhere one without resistance.

    Parameters
    ----------
    at_toe : bool
        Whether the node in question is the toe.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    Soil
        State and constants.
    """
    there = at_toe and w[V.toe_condition] == SOIL
    return Soil(
        view(x, k, A.toe_soil)[0],
        w[V.toe_quake],
        w[V.toe_resistance] if there else 0.0,
        w[V.toe_damping],
        False,
    )


@kernel
def book_soil(i, shaft, toe, grip, dt, w, x, k):
    """Move the soil at node i with the node, and add up the work done on it in a step.

    Parameters
    ----------
    i : int
        Node.
    shaft, toe : Soil
        Soil at the shaft and under the toe at the start of the step.
    grip : Grip
        Velocity of the node and resistances, means over the step.
    dt : float
        Length of the step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    way = grip.velocity * dt
    resting = stored(shaft, shaft.stretch, shaft.stretch) + stored(toe, toe.stretch, toe.stretch)
    on_shaft, under_toe = stretched(shaft, way), stretched(toe, way)
    view(x, k, A.soil)[i] = on_shaft
    if toe.ultimate > 0.0:
        view(x, k, A.toe_soil)[0] = under_toe
        w[V.toe_contact_force] = grip.toe + drag(toe, grip.toe) * grip.velocity
    kept = stored(shaft, on_shaft, on_shaft) + stored(toe, under_toe, under_toe)
    w[V.energy_plastic] += (grip.shaft + grip.toe) * way - (kept - resting)
    w[V.energy_damping] += grip.drag * grip.velocity * way


@kernel
def book_head(force, velocity, dt, w):
    """Add up the work done on the head in a step.

    Parameters
    ----------
    force : float
        On the head (N, downwards), mean over the step.
    velocity : float
        Of the head (m/s, downwards), mean over the step.
    dt : float
        Length of the step (s).
    w : ndarray of float64
        Variables.
    """
    w[V.head_contact_force] = force
    w[V.energy_head] += force * velocity * dt
    w[V.energy_transferred] = max(w[V.energy_transferred], w[V.energy_head])


@kernel
def envelope(i, force, w, x, k):
    """Take the stress in segment i into the largest stresses so far.

    Parameters
    ----------
    i : int
        Segment, from 0.
    force : float
        In the segment (N, compression positive).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    stress = force / view(x, k, A.cell_area)[i]
    compression, tension = view(w, k, A.stress_compression), view(w, k, A.stress_tension)
    compression[i] = max(compression[i], stress)
    tension[i] = max(tension[i], -stress)
