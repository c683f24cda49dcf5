"""Accounts of every scheme: soil, head, envelopes."""

from ..common.kernels import kernel, view
from ..common.smith_soil import Soil, drag, stored, stretched
from .declarations import LAYOUT, SOIL

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def shaft_soil(i, w, x, k):
    """The soil at node i, the lower end of segment i - 1. The head and the ground below the toe have none."""
    stretch, n = view(x, k, A.soil), k[A.impedance + 1]
    at = min(max(i - 1, 0), n - 1)
    resistance = view(w, k, A.shaft_resistance)[at] if 0 < i <= n else 0.0
    return Soil(
        stretch[i], view(w, k, A.shaft_quake)[at], resistance, view(w, k, A.shaft_damping)[at], True
    )


@kernel
def toe_soil(at_toe, w, x, k):
    """The soil under the toe; elsewhere one without resistance."""
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
    """Move the soil at node i with the node, and account for the work done on it in the step dt (s)."""
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
    """Account for the force on the head (N) that moves with velocity (m/s) over the step dt (s)."""
    w[V.head_contact_force] = force
    w[V.energy_head] += force * velocity * dt
    w[V.energy_transferred] = max(w[V.energy_transferred], w[V.energy_head])


@kernel
def envelope(i, force, w, x, k):
    """Take the force (N, compression positive) in segment i into the largest stresses."""
    stress = force / view(x, k, A.cell_area)[i]
    compression, tension = view(w, k, A.stress_compression), view(w, k, A.stress_tension)
    compression[i] = max(compression[i], stress)
    tension[i] = max(tension[i], -stress)
