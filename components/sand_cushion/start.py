"""The start of the sand cushion: discs are packed, come to rest, and may be compacted."""

import math

from ..common.component import OK
from ..common.kernels import kernel, view
from ..common.substeps import are_too_many
from .bodies import bodies_of
from .boundaries import describe_boundaries
from .contact_search import clear_partners, divide, forget, is_stale, rebuild
from .declarations import BEAM_DISCS, FLOOR, KIND, LAW, LAYOUT, LEVELLED, PREPARED, SUM
from .faults import (
    BEAM_GAPS,
    BEAM_TOO_NARROW,
    BEAM_UNORDERED,
    DISC_TOO_WIDE,
    LIST_FULL,
    SETTLING_TOO_LONG,
    SMOOTH_BUT_COHESIVE,
    TOO_DENSE,
    TOO_LOOSE,
)
from .forces import advance_discs, contact_forces, forget_forces
from .laws import boundary_stiffness, sand_stiffness, set_laws, stable_step_of
from .levelling import level
from .motion import set_boundaries
from .packing import mean_base, pack

V, A = LAYOUT.scalar, LAYOUT.array

GAP = 0.02
"""Gap between two beam discs, in diameters, that passes as none."""
INSTANT = 1e-9
"""Internal steps that pass while the forces at the start are computed: no time, but not a division
by zero either."""
_FAR = 1e6
"""Height (m) at which the rock waits while the sand settles."""
_SETTLING_STEP = 0.4
"""Step of the settling, in stable steps."""
_SETTLING_RATE = 30.0
"""Damping of all motion while settling (1/s)."""
_LOOSE_FRICTION = 2.0
"""Coefficient of friction with which a prepared layer first settles."""
_LOOSE_ROLLING = 1.0
"""Rolling resistance with which a prepared layer first settles."""
_PREPARATION_STEP = 0.8
"""Step of the preparation of a layer, in stable steps."""
_PREPARATION_RATE = 0.7
"""Damping of all motion while a layer is prepared, in 1 / sqrt(r/g)."""
_PREPARATION_TIME = 100.0
"""Time in sqrt(r/g) that a prepared layer may take to settle, and again to lose its friction."""
_NEARLY_AT_REST = 1e-2
"""Ratio of unbalanced force with which a layer counts as settled while it is prepared."""
_DENSITY_TOLERANCE = 0.01
"""Solid fraction by which a layer may be too loose when it was compacted all it can."""
_COLLAPSE = 0.04
"""Solid fraction by which a layer at rest may be too dense; capillary forces press it, too."""
_AT_REST = 1e-6
"""Ratio of unbalanced force of sand at rest."""
_CHECK_EVERY = 50
"""Steps between two looks whether the sand is at rest."""


@kernel
def advance(dt, w, x, k):
    """Advance the discs by one internal step, with rock and beam where they are.

    Parameters
    ----------
    dt : float
        Internal step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    tuple
        Status, kinetic and potential energy (J) at the beginning of the step.
    """
    if is_stale(w, x, k) and not rebuild(w, x, k):
        return LIST_FULL, 0.0, 0.0
    kinetic, potential = advance_discs(dt, w, x, k)
    return OK, kinetic, potential


@kernel
def unbalanced_force_ratio(w, x, k):
    """Return how far the sand is from rest.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    float
        Largest force on a disc / its weight, or largest speed / sqrt(g r) if that is more.
    """
    contact_forces(INSTANT * w[V.stable_step], w, x, k)
    bodies = bodies_of(x, k)
    gravity = w[V.gravity]
    g = max(gravity, 1e-12)
    largest = 0.0
    for i in range(bodies.rock):
        ax = bodies.force_x[i] * bodies.inverse_mass[i]
        ay = bodies.force_y[i] * bodies.inverse_mass[i] - gravity
        v2 = bodies.vx[i] * bodies.vx[i] + bodies.vy[i] * bodies.vy[i]
        unbalanced = math.sqrt(ax * ax + ay * ay) / g
        largest = max(largest, unbalanced, math.sqrt(v2 / (g * w[V.disc_radius])))
    forget_forces(x, k)
    return largest


@kernel
def slow_down(factor, x, k):
    """Multiply all velocities of the discs.

    Parameters
    ----------
    factor : float
        Without unit.
    x, k : ndarray
        State and integers of the instance.
    """
    bodies = bodies_of(x, k)
    for i in range(bodies.rock):
        bodies.vx[i] *= factor
        bodies.vy[i] *= factor
        bodies.spin[i] *= factor


@kernel
def come_to_rest(duration, dt, rate, rest, w, x, k):
    """Let the discs come to rest under gravity, base and walls at rest and the rock away.

    Parameters
    ----------
    duration : float
        Longest time (s).
    dt : float
        Time step (s).
    rate : float
        Damping of all motion (1/s).
    rest : float
        Ratio of unbalanced force at which the discs are at rest.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status.
    """
    if are_too_many(max(duration, dt), dt):
        return SETTLING_TOO_LONG
    for s in range(int(duration / dt)):
        status, _, _ = advance(dt, w, x, k)
        if status != OK:
            return status
        if s % _CHECK_EVERY == 0 and unbalanced_force_ratio(w, x, k) < rest:
            break
        slow_down(1.0 - rate * dt, x, k)
    return OK


@kernel
def settle(w, x, k):
    """Let the discs come to rest and publish how far they are from it; returns the status.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    int
        Status.
    """
    dt = _SETTLING_STEP * w[V.stable_step]
    status = come_to_rest(w[V.settling_time], dt, _SETTLING_RATE, _AT_REST, w, x, k)
    w[V.unbalanced_force_ratio] = unbalanced_force_ratio(w, x, k)
    slow_down(0.0, x, k)
    return status


@kernel
def smooth(w, x, k):
    """Level the surface of the layer; returns the status.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    int
        Status.
    """
    level(w, x, k)
    return OK if rebuild(w, x, k) else LIST_FULL


@kernel
def prepare(w, x, k):
    """Bring the layer to ``solid_fraction``.

    It settles as loosely as it can, with discs that hardly slide or roll, and then they slide more
    and more easily until it is dense enough. From there on it has the friction and the cohesion of
    the sand. A surface that is to be level is made so twice: while the layer is loose, and when it
    is dense enough.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status.
    """
    law = view(x, k, A.law)
    friction, rolling, pull = law[LAW.friction], law[LAW.rolling], law[LAW.pull]
    unit = math.sqrt(w[V.disc_radius] / max(w[V.gravity], 1e-12))
    rate, duration = _PREPARATION_RATE / unit, _PREPARATION_TIME * unit
    dt = _PREPARATION_STEP * w[V.stable_step]
    law[LAW.friction], law[LAW.rolling], law[LAW.pull] = _LOOSE_FRICTION, _LOOSE_ROLLING, 0.0
    status = come_to_rest(duration, dt, rate, _NEARLY_AT_REST, w, x, k)
    if status == OK and w[V.surface] == LEVELLED:
        status = smooth(w, x, k)
        if status == OK:
            status = come_to_rest(duration, dt, rate, _NEARLY_AT_REST, w, x, k)
    for s in range(int(duration / dt)):
        if status != OK or solid_fraction(w, x, k) >= w[V.solid_fraction]:
            break
        law[LAW.friction] = _LOOSE_FRICTION * (1.0 - s * dt / duration)
        law[LAW.rolling] = _LOOSE_ROLLING * (1.0 - s * dt / duration)
        status, _, _ = advance(dt, w, x, k)
        slow_down(1.0 - rate * dt, x, k)
    law[LAW.friction], law[LAW.rolling], law[LAW.pull] = friction, rolling, pull
    if status == OK and w[V.surface] == LEVELLED:
        status = smooth(w, x, k)
    return status


@kernel
def layer_height(w, x, k):
    """Return the height (m) of a layer of even density, above the mean level of the base.

    It has the centre of gravity of the discs, at half its height.

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
    mass, moment = 0.0, 0.0
    for i in range(bodies.rock):
        area = bodies.radius[i] * bodies.radius[i]
        mass += area
        moment += area * bodies.y[i]
    return 2.0 * (moment / mass - mean_base(w, x, k))


@kernel
def solid_fraction(w, x, k):
    """Return the part of the layer that discs fill, with the height :func:`layer_height`.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    float
        From 0 to 1.
    """
    bodies = bodies_of(x, k)
    area = 0.0
    for i in range(bodies.rock):
        area += math.pi * bodies.radius[i] * bodies.radius[i]
    return area / (w[V.box_width] * layer_height(w, x, k))


@kernel
def size_boundaries(w, x, k):
    """Set radii of rock and beam discs, the roots of their masses, and the bodies far away.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.
    """
    bodies = bodies_of(x, k)
    bodies.radius[bodies.rock] = w[V.rock_radius]
    bodies.half_root[bodies.rock] = 0.5 * math.sqrt(w[V.rock_mass])
    for b in range(bodies.rock + 1, bodies.end):
        bodies.radius[b] = w[V.beam_radius]
        bodies.half_root[b] = 0.5 * math.sqrt(w[V.beam_disc_mass])
    for b in range(bodies.end, bodies.x.size):
        bodies.x[b] = _FAR


@kernel
def stand_still(x, k):
    """Bring the rock far away, and rock and beam to rest.

    Parameters
    ----------
    x, k : ndarray
        State and integers of the instance.
    """
    bodies = bodies_of(x, k)
    bodies.y[bodies.rock] = _FAR
    for b in range(bodies.rock, bodies.end):
        bodies.vx[b] = 0.0
        bodies.vy[b] = 0.0
        bodies.spin[b] = 0.0


@kernel
def initialise(w, x, k):
    """Pack the discs and let them settle.

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
    w[V.stable_step] = stable_step_of(w)
    if 2.0 * w[V.disc_radius] * (1.0 + w[V.disc_spread]) > w[V.box_width] * (1.0 + GAP):
        return DISC_TOO_WIDE
    if w[V.cohesion] > 0.0 and w[V.friction_angle] == 0.0:
        return SMOOTH_BUT_COHESIVE
    for q in range(x.size):
        x[q] = 0.0
    divide(k)
    forget(x, k)
    clear_partners(k)
    if w[V.base] != FLOOR and beam_fault(w, k) != OK:
        view(x, k, A.sums)[SUM.beam_key] = beam_key(w, k) - 1.0  # packed on no beam yet
        return OK
    set_laws(w, x, k)
    describe_boundaries(w, k)
    size_boundaries(w, x, k)
    set_boundaries(0.0, w, x, k)
    stand_still(x, k)
    pack(w, x, k, sand_stiffness(w), boundary_stiffness(KIND.base, w))
    forget(x, k)
    if not rebuild(w, x, k):
        return LIST_FULL
    status = prepare(w, x, k) if w[V.packing] == PREPARED else OK
    if status == OK:
        status = settle(w, x, k)
    w[V.layer_height] = layer_height(w, x, k)
    w[V.layer_solid_fraction] = solid_fraction(w, x, k)
    if status == OK and w[V.packing] == PREPARED:
        status = preparation_fault(w)
    sums = view(x, k, A.sums)
    for q in range(sums.size):
        sums[q] = 0.0
    sums[SUM.beam_key] = beam_key(w, k)
    return status


@kernel
def beam_fault(w, k):
    """Return the fault of a beam that does not carry the whole cushion, or 0."""
    px = view(w, k, A.beam_position_x)
    widest = 0.0
    for b in range(px.size - 1):
        if px[b + 1] <= px[b]:
            return BEAM_UNORDERED
        widest = max(widest, px[b + 1] - px[b])
    if w[V.base] == BEAM_DISCS and widest > 2.0 * w[V.beam_radius] * (1.0 + GAP):
        return BEAM_GAPS
    reach = w[V.beam_radius] * (1.0 + 1e-6)
    if px[0] - reach > w[V.box_left] or px[px.size - 1] + reach < w[V.box_left] + w[V.box_width]:
        return BEAM_TOO_NARROW
    return OK


@kernel
def preparation_fault(w):
    """Return the fault of a layer that is not as dense as it was to be.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    int
        Status.
    """
    if w[V.layer_solid_fraction] > w[V.solid_fraction] + _COLLAPSE:
        return TOO_LOOSE
    if w[V.layer_solid_fraction] < w[V.solid_fraction] - _DENSITY_TOLERANCE:
        return TOO_DENSE
    return OK


@kernel
def beam_key(w, k):
    """Return a number that changes with the beam's place, on which the sand has settled.

    Parameters
    ----------
    w, k : ndarray
        Variables and integers of the instance.

    Returns
    -------
    float
    """
    px, py = view(w, k, A.beam_position_x), view(w, k, A.beam_position_y)
    key = 0.0
    for b in range(px.size):
        key += (b + 1) * (px[b] + math.pi * py[b])
    return key
