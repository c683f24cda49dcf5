"""The sand cushion in time: outputs at the start, steps, and the balance of energy."""

import math

from ..common.component import OK
from ..common.kernels import kernel, view
from ..common.stepping import TOO_MANY_STEPS
from ..common.substeps import are_too_many, substep_count, substep_length
from .beam_surface import foot_of
from .bodies import bodies_of
from .boundaries import ABSENT, boundary_of, touch, touch_disc
from .contact_search import rebuild
from .declarations import BEAM_DISCS, FLOOR, LAYOUT, LINEAR, MEAN, PLANES, SUM, UNBOUNDED
from .faults import (
    DIVERGED,
    LIST_FULL,
    ROCK_BESIDE,
    ROCK_INSIDE,
    ROCK_TOO_FAST,
    ROCK_UNDER,
)
from .forces import contact_forces, forget_forces
from .motion import collect_forces, set_boundaries
from .packing import columns_of
from .start import INSTANT, advance, beam_fault, beam_key, initialise

__all__ = ["evaluate", "initialise", "step"]

V, A = LAYOUT.scalar, LAYOUT.array

_TOUCHING = 1e-9
"""Overlap (m) of rock and sand at the start that passes as touching."""


# --- the start ---


@kernel
def surface_under_rock(w, x, k):
    """Return the highest point (m) of the sand near the rock, or anywhere if there is none near.

    Near are centres less than a rock's radius to the left or right of the rock's.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    float
        Height (m).
    """
    bodies = bodies_of(x, k)
    near, anywhere = -math.inf, -math.inf
    for i in range(bodies.rock):
        top = bodies.y[i] + bodies.radius[i]
        anywhere = max(anywhere, top)
        if abs(bodies.x[i] - w[V.rock_position_x]) < w[V.rock_radius]:
            near = max(near, top)
    return near if near > -math.inf else anywhere


@kernel
def surface_level(w, x, k):
    """Return the mean height of the surface between the walls, from the highest disc in columns.

    The columns are as wide as the largest disc, so that full rows of a lattice have one disc in
    each: its level is its top. Columns without a disc do not count.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance; the loads of the discs are 0 and stay it.

    Returns
    -------
    float
        Height (m).
    """
    bodies = bodies_of(x, k)
    largest = 2.0 * w[V.disc_radius] * (1.0 + w[V.disc_spread])
    columns = min(bodies.rock, columns_of(w[V.box_width], largest))
    tops, counted = bodies.force_x, bodies.force_y
    for i in range(bodies.rock):
        place = math.floor((bodies.x[i] - w[V.box_left]) / w[V.box_width] * columns)
        column = min(columns - 1, max(0, place))
        top = bodies.y[i] + bodies.radius[i]
        tops[column] = max(tops[column], top) if counted[column] else top
        counted[column] = 1.0
    level, number = 0.0, 0.0
    for column in range(columns):
        level, number = level + tops[column], number + counted[column]
    forget_forces(x, k)
    return level / number


@kernel
def rock_fault(w, x, k):
    """Return the fault of a rock inside the sand, in a side wall or under the base, or 0.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    int
        Status.
    """
    bodies, table = bodies_of(x, k), view(k, k, A.boundary)
    rock = bodies.rock
    for wall in (bodies.end, bodies.end + 1):
        surface = touch(rock, wall, boundary_of(wall, rock, table), w, bodies)
        if surface.gap < -_TOUCHING:
            return ROCK_BESIDE
    for i in range(rock):
        dx, dy = bodies.x[rock] - bodies.x[i], bodies.y[rock] - bodies.y[i]
        if math.sqrt(dx * dx + dy * dy) < w[V.rock_radius] + bodies.radius[i] - _TOUCHING:
            return ROCK_INSIDE
    return ROCK_UNDER if is_under_base(w, x, k) else OK


@kernel
def is_under_base(w, x, k):
    """Tell whether the rock is in or under the floor or the beam.

    A rock on or beyond walls with an upper end is beside the sand.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    bool
    """
    bodies, table = bodies_of(x, k), view(k, k, A.boundary)
    rock = bodies.rock
    base = boundary_of(bodies.end + PLANES - 1, rock, table)
    if base.geometry != ABSENT:
        return touch(rock, bodies.end + PLANES - 1, base, w, bodies).gap < -_TOUCHING
    for b in range(rock + 1, bodies.end):
        if touch_disc(rock, b, bodies).gap < -_TOUCHING:
            return True
    inside = 0.0 <= bodies.x[rock] - w[V.box_left] <= w[V.box_width]
    if not inside and w[V.box_wall_height] != UNBOUNDED:
        return False
    over = foot_of(bodies.x[rock], bodies.y[rock], bodies).height
    return over < -bodies.radius[rock + 1]  # its centre lies under the beam's axis


@kernel
def is_too_fast(h, dt, w):
    """Tell whether the rock moves on by more than a disc's radius between two looks at contacts.

    Parameters
    ----------
    h, dt : float
        Communication step and internal step (s).
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    bool
    """
    look = dt if w[V.kinematics] == LINEAR else h
    speed = math.sqrt(w[V.rock_velocity_x] ** 2 + w[V.rock_velocity_y] ** 2)
    return speed * look > w[V.disc_radius]


@kernel
def evaluate(w, x, k):
    """Compute the outputs at the start; packs anew when the beam was moved since.

    A place of rock or beam that is refused may still change before the first step, which asks
    again.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status, 0 or one of the faults.
    """
    status = begin(w, x, k)
    view(x, k, A.sums)[SUM.unready] = status
    return status


@kernel
def begin(w, x, k):
    """Bring sand, rock and beam to the start, with the inputs as they are; returns the status."""
    sums = view(x, k, A.sums)
    if w[V.base] != FLOOR:
        status = beam_fault(w, k)
        if status == OK and sums[SUM.beam_key] != beam_key(w, k):
            status = initialise(w, x, k)
        if status != OK:
            return status
    set_boundaries(0.0, w, x, k)
    w[V.surface_height] = surface_under_rock(w, x, k)
    w[V.surface_level] = surface_level(w, x, k)
    sums[SUM.touched] = 0.0
    w[V.rock_above_surface] = w[V.rock_position_y] - w[V.rock_radius] - w[V.surface_level]
    w[V.penetration] = 0.0
    w[V.clearance] = clearance(w, x, k)
    status = rock_fault(w, x, k)
    if status != OK:
        return status
    if not rebuild(w, x, k):
        return LIST_FULL
    contact_forces(INSTANT * w[V.internal_step], w, x, k)
    start_balance(w, x, k)
    collect_forces(1.0, True, w, x, k)
    forget_forces(x, k)
    publish_way(0.0, w, sums)
    return OK


# --- energy ---


@kernel
def start_balance(w, x, k):
    """Begin the balance of energy: nothing dissipated, no work done, all that is stored at hand.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.
    """
    sums = view(x, k, A.sums)
    for q in (
        SUM.normal_dashpot,
        SUM.tangential_dashpot,
        SUM.sliding,
        SUM.rolling,
        SUM.plastic,
        SUM.rock,
        SUM.beam,
    ):
        sums[q] = 0.0
    w[V.energy_start] = 0.0
    publish_energies(kinetic_energy(x, k), potential_energy(w, x, k), w, sums)
    w[V.energy_start] = stored_energy(w)
    w[V.energy_residual] = 0.0


@kernel
def kinetic_energy(x, k):
    """Return the kinetic energy of all discs (J).

    Parameters
    ----------
    x, k : ndarray
        State and integers of the instance.

    Returns
    -------
    float
        Energy (J).
    """
    bodies = bodies_of(x, k)
    total = 0.0
    for i in range(bodies.rock):
        vx, vy, spin = bodies.vx[i], bodies.vy[i], bodies.spin[i]
        total += 0.5 * (vx * vx + vy * vy + 0.5 * spin * spin) / bodies.inverse_mass[i]
    return total


@kernel
def potential_energy(w, x, k):
    """Return the energy of all discs in gravity (J).

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    float
        Energy (J), zero at y = 0.
    """
    bodies = bodies_of(x, k)
    total = 0.0
    for i in range(bodies.rock):
        total += bodies.y[i] / bodies.inverse_mass[i]
    return total * w[V.gravity]


@kernel
def stored_energy(w):
    """Return the energy (J) that discs and contacts hold, from the outputs.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        Energy (J).
    """
    return w[V.energy_kinetic] + w[V.energy_elastic] + w[V.energy_capillary] + w[V.energy_gravity]


@kernel
def publish_energies(kinetic, potential, w, sums):
    """Write the energies at the start of the last internal step, and the error of their balance.

    Parameters
    ----------
    kinetic, potential : float
        Energies of the discs (J).
    w : ndarray of float64
        Variables.
    sums : ndarray of float64
        Running sums, :data:`SUM`.
    """
    w[V.energy_kinetic] = kinetic
    w[V.energy_gravity] = potential
    w[V.energy_elastic] = sums[SUM.elastic]
    w[V.energy_capillary] = sums[SUM.capillary]
    w[V.energy_normal_dashpot] = sums[SUM.normal_dashpot]
    w[V.energy_tangential_dashpot] = sums[SUM.tangential_dashpot]
    w[V.energy_sliding] = sums[SUM.sliding]
    w[V.energy_rolling] = sums[SUM.rolling]
    w[V.energy_plastic] = sums[SUM.plastic]
    w[V.energy_work_rock] = sums[SUM.rock]
    w[V.energy_work_beam] = sums[SUM.beam]
    dissipated = (
        w[V.energy_normal_dashpot]
        + w[V.energy_tangential_dashpot]
        + w[V.energy_sliding]
        + w[V.energy_rolling]
        + w[V.energy_plastic]
    )
    work = w[V.energy_work_rock], w[V.energy_work_beam]
    balance = stored_energy(w) + dissipated - work[0] - work[1]
    w[V.energy_residual] = balance - w[V.energy_start]


# --- steps ---


@kernel
def penetration(above, touching, sums):
    """Return the depth of the rock's lowest point, 0 until the rock first touches.

    Parameters
    ----------
    above : float
        Height (m) of the rock's lowest point above the mean level of the surface at the start.
    touching : bool
        Whether a force acts on the rock.
    sums : ndarray of float64
        Running sums, :data:`SUM`.

    Returns
    -------
    float
        Depth (m), 0 above the level.
    """
    if touching:
        sums[SUM.touched] = 1.0
    return max(0.0, -above) if sums[SUM.touched] != 0.0 else 0.0


@kernel
def publish_way(ahead, w, sums):
    """Write where the rock's lowest point is, beside the surface at the start.

    The rock goes on for the time ``ahead`` (s) from where the inputs have it.

    Parameters
    ----------
    ahead : float
        Time after that of the variables (s).
    w : ndarray of float64
        Variables of the instance.
    sums : ndarray of float64
        Running sums, :data:`SUM`.
    """
    lowest = w[V.rock_position_y] + w[V.rock_velocity_y] * ahead - w[V.rock_radius]
    above = lowest - w[V.surface_level]
    touching = w[V.rock_force_x] != 0.0 or w[V.rock_force_y] != 0.0
    w[V.rock_above_surface] = above
    w[V.penetration] = penetration(above, touching, sums)


@kernel
def clearance(w, x, k):
    """Return the distance (m) of the rock's surface from the base, as its contact is computed.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    float
        Distance (m), negative where they overlap. The base goes on beside the walls.
    """
    bodies = bodies_of(x, k)
    rock = bodies.rock
    if w[V.base] == FLOOR:
        return bodies.y[rock] - bodies.radius[rock] - w[V.base_y]
    if w[V.base] != BEAM_DISCS:
        return foot_of(bodies.x[rock], bodies.y[rock], bodies).height - bodies.radius[rock]
    least = math.inf
    for disc in range(rock + 1, bodies.end):
        least = min(least, touch_disc(rock, disc, bodies).gap)
    return least


@kernel
def step(t, h, w, x, k):
    """Advance by a communication step.

    Parameters
    ----------
    t, h : float
        Time at its beginning and its length (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status, 0 or one of the faults.
    """
    if are_too_many(h, w[V.internal_step]):
        return TOO_MANY_STEPS
    if view(x, k, A.sums)[SUM.unready] != OK:
        status = evaluate(w, x, k)
        if status != OK:
            return status
    n = substep_count(h, w[V.internal_step])
    dt = substep_length(h, n, w[V.internal_step])
    if is_too_fast(h, dt, w):
        return ROCK_TOO_FAST
    linear, mean = w[V.kinematics] == LINEAR, w[V.forces] == MEAN
    kinetic, potential = 0.0, 0.0
    for s in range(n):
        if s == 0 or linear:
            set_boundaries(s * dt if linear else 0.0, w, x, k)
        status, kinetic, potential = advance(dt, w, x, k)
        if status != OK:
            return status
        if mean:
            collect_forces(1.0 / n, s == 0, w, x, k)
    if not mean:
        collect_forces(1.0, True, w, x, k)
    sums = view(x, k, A.sums)
    publish_energies(kinetic, potential, w, sums)
    publish_way(h if linear else 0.0, w, sums)
    w[V.clearance] = clearance(w, x, k)
    return OK if math.isfinite(w[V.energy_residual]) else DIVERGED
