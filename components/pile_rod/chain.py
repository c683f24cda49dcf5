"""Masses and springs after Smith: positions, then forces, then velocities.

Positions follow from velocities, forces from positions, and velocities from forces: eqs (2)-(5) of
Uto et al. with the sign of (5) corrected,

    V[m] = v[m] + (F[m-1] - F[m] - R[m]) dt / M[m].

Positions and forces belong to one time, velocities to half a step later. T(v) + 1/2 D(t) K D(t +
dt) is then conserved exactly, with T the kinetic energy, D the displacements, K the stiffness.
"""

from ..common.kernels import kernel, view
from ..common.smith_soil import drag, static, stored, stretched
from .bookkeeping import book_head, envelope, shaft_soil, toe_soil
from .declarations import LAYOUT, MATCHED, PORT, RAM, SMITH
from .segments import below_toe

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def advance(time, dt, head_force, toe_force, w, x, k):
    """Advance masses and springs by one internal step.

    Parameters
    ----------
    time, dt : float
        Start and length of the step (s).
    head_force, toe_force : float
        Forces of the ports (N): downwards on the head, upwards on the toe.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    place, rate = view(x, k, A.place), view(x, k, A.rate)
    n, last = k[A.impedance + 1], view(k, k, A.free)[2]
    w[V.energy_contact] += contact_energy(dt, w, x, k)
    before = _soil_energy(dt, w, x, k)
    for i in range(last + 1):
        place[i] += rate[i] * dt
    _move_soil(dt, w, x, k)
    above = 0.0
    for i in range(last + 1):
        below = spring_force(i, w, x, k)
        if i < n:
            envelope(i, below, w, x, k)
        if i == 0:
            _strike(time, dt, head_force, below, w, x, k)
        else:
            before += _push(i, above - below, dt, toe_force, w, x, k)
        above = below
    if last < n:
        w[V.toe_contact_force] = above
    w[V.energy_contact] -= contact_energy(dt, w, x, k)
    w[V.energy_plastic] += before - _soil_energy(dt, w, x, k)


@kernel
def spring_force(i, w, x, k):
    """Return the force (N, compression positive) of the spring below node i.

    Below the last node is fixed ground. The spring below a ram only pushes.
    """
    place, spring = view(x, k, A.place), view(x, k, A.spring)
    last = view(k, k, A.free)[2]
    force = spring[i] * (place[i] - (place[i + 1] if i < last else 0.0))
    return max(force, 0.0) if i == 0 and w[V.ram_mass] > 0.0 else force


@kernel
def spring_energy(i, ahead, w, x, k):
    """Return the energy (J) of the spring below node i, from force and later compression.

    It is half the force times the compression a time ``ahead`` (s) from now, at the velocities of
    now.
    """
    place, rate = view(x, k, A.place), view(x, k, A.rate)
    last = view(k, k, A.free)[2]
    compression = place[i] - (place[i + 1] if i < last else 0.0)
    closing = rate[i] - (rate[i + 1] if i < last else 0.0)
    return 0.5 * spring_force(i, w, x, k) * (compression + ahead * closing)


@kernel
def contact_energy(dt, w, x, k):
    """Return the energy (J) of the spring between ram and rod.

    It is 0 without a ram, where that spring is one like any other.
    """
    return spring_energy(0, dt, w, x, k) if w[V.ram_mass] > 0.0 else 0.0


@kernel
def _strike(time, dt, force, below, w, x, k):
    """Change the velocity of node 0, ram or head, under the spring force ``below`` it (N)."""
    rate, mass, ram = view(x, k, A.rate), view(x, k, A.mass), view(x, k, A.ram_state)
    load, was = mass[0] * w[V.gravity], rate[0]
    rate[0] += (force + load - below) / mass[0] * dt
    mean = 0.5 * (was + rate[0])
    w[V.energy_work_head] += force * mean * dt
    w[V.energy_work_gravity] += load * mean * dt
    if w[V.ram_mass] > 0.0:
        gap = view(x, k, A.place)[1] - view(x, k, A.place)[0]
        if ram[RAM.touching] > 0.0 and gap > 0.0:
            w[V.ram_separation] = time + dt - gap / (rate[1] - was)
        ram[RAM.touching] = 1.0 if below > 0.0 else 0.0
        w[V.energy_contact] += below * mean * dt
        book_head(below, mean, dt, w)
    else:
        book_head(force, mean, dt, w)


@kernel
def _push(i, net, dt, toe_force, w, x, k):
    """Change the velocity of node i under the springs' ``net`` force (N, downwards).

    Returns
    -------
    float
        Work on the static soil (J).
    """
    rate, mass = view(x, k, A.rate), view(x, k, A.mass)
    n, last = k[A.impedance + 1], view(k, k, A.free)[2]
    shaft, toe = shaft_soil(i, w, x, k), toe_soil(i == n, w, x, k)
    was = rate[i]
    on_shaft, under_toe = static(shaft, shaft.stretch), static(toe, toe.stretch)
    in_soil = drag(shaft, on_shaft) + drag(toe, under_toe)
    standing = _dashpot(w, x, k) if i == last else 0.0
    load = mass[i] * w[V.gravity] if i <= n else 0.0
    pushed = toe_force if i == n and w[V.toe_condition] == PORT else 0.0
    half = 0.5 * dt / mass[i]
    damped = half * (in_soil + standing)
    rate[i] = (was * (1.0 - damped) + 2.0 * half * (net + load - on_shaft - under_toe - pushed)) / (
        1.0 + damped
    )
    mean = 0.5 * (was + rate[i])
    w[V.energy_work_gravity] += load * mean * dt
    w[V.energy_work_toe] -= pushed * mean * dt
    w[V.energy_damping] += in_soil * mean * mean * dt
    w[V.energy_radiated] += standing * mean * mean * dt
    if i == 1 and w[V.ram_mass] > 0.0:
        w[V.energy_contact] -= spring_force(0, w, x, k) * mean * dt
    if i == n:
        w[V.toe_contact_force] = (
            under_toe + pushed + (drag(toe, under_toe) + standing) * mean + spring_force(n, w, x, k)
        )
    return (on_shaft + under_toe) * mean * dt


@kernel
def _dashpot(w, x, k):
    """Return the impedance (N s/m) of the dashpot under the last node, or 0.

    A matched toe has one, and so has the ground as a rod, which goes on below its last segment.
    """
    if w[V.toe_condition] == MATCHED:
        return view(x, k, A.impedance)[k[A.impedance + 1] - 1]
    return below_toe(w, x, k) if w[V.scheme] != SMITH else 0.0


@kernel
def _move_soil(dt, w, x, k):
    """Move the soil with the nodes of the rod, up to its quake."""
    rate, stretch = view(x, k, A.rate), view(x, k, A.soil)
    toe = view(x, k, A.toe_soil)
    n = k[A.impedance + 1]
    for i in range(1, n + 1):
        stretch[i] = stretched(shaft_soil(i, w, x, k), rate[i] * dt)
    toe[0] = stretched(toe_soil(True, w, x, k), rate[n] * dt)


@kernel
def _soil_energy(dt, w, x, k):
    """Return the elastic energy (J) in the soil."""
    rate = view(x, k, A.rate)
    n = k[A.impedance + 1]
    total = 0.0
    for i in range(1, n + 1):
        shaft = shaft_soil(i, w, x, k)
        total += stored(shaft, shaft.stretch, stretched(shaft, rate[i] * dt))
    toe = toe_soil(True, w, x, k)
    return total + stored(toe, toe.stretch, stretched(toe, rate[n] * dt))
