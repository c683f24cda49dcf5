"""Mechanics of the chain: hinges, axial springs, supports, and one step of its discs.

Arrays over the discs have one more place at each end: the mirror image of the end disc in the
support. With it every disc has the same formula, and the end half-bar has the angle
(v[1] - v[0]) / R like any other. Hidden arrays, n discs:

* ``u`` to the right and ``v`` upwards, shape (n + 2): displacements (m); ``u_rate``, ``v_rate``:
  their rates (m/s);
* ``u_shape``, ``v_shape``, shape (n + 2): the shape under which the springs are evaluated;
  ``hinge_moment`` (N m): what follows from it;
* ``mass``, shape (n): mass of the discs (kg); ``kick``: their change of rate in a step under a unit
  force (m/s/N);
* ``load.x``, ``load.y``, shape (n): held forces with the couples of the torques (N);
* ``support.height``, shape (supports): heights of the supports (m); ``reaction``: forces of the
  beam on them (N, upwards);
* ``end.height``, ``end.rate``, ``end.force``, shape (2): of the ends on elastic supports (m, m/s)
  and what accelerates them (N, upwards); on others the ends are the supports.

A section that yields has more of them: :mod:`.yielding`.
"""

from collections import namedtuple

from ..common.kernels import kernel, view
from .declarations import CRACKING, FIXED, LAYOUT, SPRUNG, YIELDING
from .yielding import locked_and_elastic_energy, rate_energy, relieve, slip

V, A = LAYOUT.scalar, LAYOUT.array

WALL_HINGE, END_HINGE = 4.0, 4.0 / 3.0
"""Stiffness of the hinges at a fixed support and at the disc next to it, in units of EI/R.

The beam's length that bends in them is R/4 and 3R/4 (all others: R)."""
BEARING = 16.0
"""Stiffness of an inner support, in units of EI/R3: that of the chain's own stiffest shape.

What it yields is of the third order in R, below the error of the chain."""

PLATE = 0.5
"""Mass of the end on an elastic support, as a part of that of a disc without the box: that of the
half-bar. It has no weight."""

Chain = namedtuple(
    "Chain",
    "n supports fixed spacing bending axial bearing spring plate drag viscosity gravity yielding "
    "cracking",
)
"""Constants: numbers of discs and supports, whether the outer ones are fixed, R (m), EI/R2 (N),
EA/R (N/m), stiffness of an inner support (N/m), of the spring under an end (N/m, 0: rigid) and the
mass of that end (kg), Rayleigh factors of mass (1/s) and stiffness (s),
gravity (m/s2), whether the section yields, and whether its first corner is cracking."""


@kernel
def chain(w, k):
    """Return the constants that follow from the parameters."""
    n = k[A.force_x + 1]
    spacing = w[V.span] / n
    bending = w[V.elastic_modulus] * w[V.section_second_moment] / (spacing * spacing)
    return Chain(
        n,
        k[A.support_height + 1],
        w[V.supports] == FIXED,
        spacing,
        bending,
        w[V.elastic_modulus] * w[V.section_area] / spacing,
        BEARING * bending / spacing,
        w[V.support_stiffness] if w[V.supports] == SPRUNG else 0.0,
        PLATE * disc_mass(w, spacing),
        w[V.damping_mass],
        w[V.damping_stiffness],
        w[V.gravity],
        w[V.section_bending] == YIELDING,
        w[V.section_corner1_kind] == CRACKING,
    )


@kernel
def disc_mass(w, spacing):
    """Return the mass of beam and deck on the length of a disc (kg), without the box."""
    return (w[V.density] * w[V.section_area] + w[V.deck_mass]) * spacing


@kernel
def springs_fit_supports(w):
    """Return whether there is a stiffness for elastic supports, and for no others."""
    return (w[V.supports] == SPRUNG) == (w[V.support_stiffness] > 0.0)


@kernel
def distribute(c, w, x, k):
    """Give each disc its mass: its length of beam and deck, and its part of the box.

    Parameters
    ----------
    c : Chain
        Constants.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    mass = view(x, k, A.mass)
    own = disc_mass(w, c.spacing)
    for i in range(c.n):
        mass[i] = own + w[V.box_mass] * box_share(c, i, w)


@kernel
def box_share(c, i, w):
    """Return the part of the box's width that stands on disc i (from 0)."""
    left, disc = w[V.box_left], w[V.axis_x] + i * c.spacing
    overlap = min(left + w[V.box_width], disc + c.spacing) - max(left, disc)
    return max(0.0, overlap) / w[V.box_width]


@kernel
def box_momentum(c, w, x, k):
    """Return the momentum of the empty box (N s, upwards), which moves with the discs under it."""
    if w[V.box_mass] == 0.0:
        return 0.0
    rate = view(x, k, A.v_rate)
    total = 0.0
    for i in range(c.n):
        total += box_share(c, i, w) * rate[i + 1]
    return w[V.box_mass] * total


@kernel
def box_stands_on_beam(w):
    """Return whether a box with mass or sand stands within the span, but for rounding.

    An empty box without mass may stand anywhere.
    """
    margin, from_left = 1e-9 * w[V.span], w[V.box_left] - w[V.axis_x]
    empty = w[V.box_mass] == 0.0 and w[V.cushion_weight] == 0.0
    return empty or (from_left >= -margin and from_left + w[V.box_width] <= w[V.span] + margin)


@kernel
def supports_have_places(w, k):
    """Return whether each inner support has a disc of its own, and the outer ones have none."""
    element = view(w, k, A.support_element)
    n = k[A.force_x + 1]
    if element[0] != 0.0 or element[1] != 0.0:
        return False
    for s in range(2, len(element)):
        if not 1.0 <= element[s] <= n or element[s] != int(element[s]):
            return False
        for other in range(2, s):
            if element[other] == element[s]:
                return False
    return True


@kernel
def deform(c, displacement_factor, rate_factor, w, x, k):
    """Set the shape of the springs, the supports included, and the moments that follow from it.

    The shape is displacement_factor * displacement + rate_factor * rate: (1, 0) gives the elastic
    moments, (0, 1) their rates, (1, viscosity) the elastic and viscous ones together.

    Parameters
    ----------
    c : Chain
        Constants.
    displacement_factor : float
        Dimensionless.
    rate_factor : float
        Time (s), or dimensionless where the displacements do not count.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    if c.yielding:
        _relieve(c, displacement_factor, rate_factor, w, x, k)
    _shape_axis(c, displacement_factor, rate_factor, x, k)
    _shape_bending(c, displacement_factor, rate_factor, w, x, k)
    _bend(c, x, k)
    v, height = view(x, k, A.v_shape), view(x, k, A.support_height)
    element, reaction = view(w, k, A.support_element), view(x, k, A.reaction)
    speed = view(w, k, A.support_velocity_y)
    for s in range(2, c.supports):
        below = displacement_factor * height[s] + rate_factor * speed[s]
        reaction[s] = c.bearing * (v[int(element[s])] - below)


@kernel
def _shape_axis(c, displacement_factor, rate_factor, x, k):
    """Set the shape along the axis, the supports included."""
    u = view(x, k, A.u_shape)
    n = c.n
    _shape_discs(n, displacement_factor, rate_factor, view(x, k, A.u), view(x, k, A.u_rate), u)
    u[0] = -u[1]
    u[n + 1] = -u[n] if c.fixed else u[n]


@kernel
def _shape_bending(c, displacement_factor, rate_factor, w, x, k):
    """Set the shape across the axis, the supports included."""
    v = view(x, k, A.v_shape)
    n = c.n
    _shape_discs(n, displacement_factor, rate_factor, view(x, k, A.v), view(x, k, A.v_rate), v)
    height, speed = view(x, k, A.support_height), view(w, k, A.support_velocity_y)
    if c.spring > 0.0:
        height, speed = view(x, k, A.end_height), view(x, k, A.end_rate)
    v[0] = 2.0 * (displacement_factor * height[0] + rate_factor * speed[0]) - v[1]
    v[n + 1] = 2.0 * (displacement_factor * height[1] + rate_factor * speed[1]) - v[n]


@kernel
def _shape_discs(n, displacement_factor, rate_factor, displacement, rate, shape):
    for i in range(n + 2):
        shape[i] = displacement_factor * displacement[i] + rate_factor * rate[i]


@kernel
def _bend(c, x, k):
    """Set the moments in the present shape, with their mirror images in the supports."""
    moment, relief = view(x, k, A.hinge_moment), view(x, k, A.relief)
    n = c.n
    _bend_discs(c, moment, x, k)
    if c.yielding:
        for i in range(1, n + 1):
            moment[i] -= relief[i]
    left, right = wall_moments(c, x, k)
    moment[0] = 2.0 * left - moment[1]
    moment[n + 1] = 2.0 * right - moment[n]


@kernel
def _bend_discs(c, moment, x, k):
    """Set the elastic moments at the discs in the present shape."""
    v = view(x, k, A.v_shape)
    n = c.n
    for i in range(n):
        moment[i + 1] = c.bending * ((v[i + 2] + v[i]) - 2.0 * v[i + 1])
    if c.fixed:
        moment[1] *= END_HINGE
        moment[n] *= END_HINGE


@kernel
def wall_moments(c, x, k):
    """Return the moments at the left and right support (N m).

    Each is that of the wall hinge on the end half-bar's rotation; it is 0 for simple supports.
    """
    if not c.fixed:
        return 0.0, 0.0
    left, right = _elastic_wall_moments(c, x, k)
    if c.yielding:
        relief = view(x, k, A.relief)
        left, right = left - relief[0], right - relief[c.n + 1]
    return left, right


@kernel
def _elastic_wall_moments(c, x, k):
    v = view(x, k, A.v_shape)
    n, stiffness = c.n, WALL_HINGE * c.bending
    return stiffness * (v[1] - v[0]), stiffness * (v[n] - v[n + 1])


@kernel
def _bend_elastic(c, moment, x, k):
    """Set the elastic moments in the present shape, those at the walls in the first and last."""
    _bend_discs(c, moment, x, k)
    moment[0] = moment[c.n + 1] = 0.0
    if c.fixed:
        moment[0], moment[c.n + 1] = _elastic_wall_moments(c, x, k)


@kernel
def _relieve(c, displacement_factor, rate_factor, w, x, k):
    """Set what a yielding section takes from the elastic moments of a shape."""
    if rate_factor != 0.0:
        _shape_bending(c, 0.0, 1.0, w, x, k)
        _bend_elastic(c, view(x, k, A.moment_rate), x, k)
    relieve(c, displacement_factor, rate_factor, x, k)


@kernel
def follow(c, w, x, k):
    """Let a section that yields follow the present displacements.

    Before each :func:`deform` with them; calls that follow without a motion in between change
    nothing.

    Parameters
    ----------
    c : Chain
        Constants.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    if not c.yielding:
        return
    _shape_bending(c, 1.0, 0.0, w, x, k)
    _bend_elastic(c, view(x, k, A.elastic_moment), x, k)
    slip(c, w, x, k)


@kernel
def react(c, w, x, k):
    """Set the forces of the beam on the outer supports, in the present shape.

    They follow from the moment equilibrium of the end half-bars; on elastic supports those forces
    and the springs move the ends. The forces on inner supports are set with the shape.
    """
    moment, torque = view(x, k, A.hinge_moment), view(w, k, A.torque)
    reaction = view(x, k, A.reaction)
    n = c.n
    reaction[0] = -(moment[1] - moment[0] + torque[0]) / c.spacing
    reaction[1] = (moment[n + 1] - moment[n] + torque[n - 1]) / c.spacing
    if c.spring > 0.0:
        _press(c, x, k)


@kernel
def _press(c, x, k):
    """Let the springs under the ends bear what they are pressed together for; they never pull."""
    reaction, net = view(x, k, A.reaction), view(x, k, A.end_force)
    for s in range(2):
        borne = -c.spring * settlement(c, s, x, k)
        net[s] = reaction[s] - borne
        reaction[s] = borne


@kernel
def settlement(c, s, x, k):
    """Return the way by which the spring under an end is pressed together (m)."""
    return max(view(x, k, A.support_height)[s] - view(x, k, A.end_height)[s], 0.0)


@kernel
def hold(c, w, x, k):
    """Hold the input forces, and each torque as the couple that does the same work.

    A disc's angle is (v[i+1] - v[i-1]) / 2R, so its torque T pulls the disc before it by -T / 2R
    and the next by T / 2R.

    Parameters
    ----------
    c : Chain
        Constants.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    load_x, load_y = view(x, k, A.load_x), view(x, k, A.load_y)
    per_length = 0.5 / c.spacing
    force_x, force_y, torque = view(w, k, A.force_x), view(w, k, A.force_y), view(w, k, A.torque)
    for i in range(c.n):
        before, after = max(i - 1, 0), min(i + 1, c.n - 1)
        load_x[i] = force_x[i]
        load_y[i] = force_y[i] + (torque[before] - torque[after]) * per_length


@kernel
def potential(c, w, x, k):
    """Return the work (J) of the held loads from the undeformed beam to its present place."""
    u, v = view(x, k, A.u), view(x, k, A.v)
    load_x, load_y = view(x, k, A.load_x), view(x, k, A.load_y)
    torque, height = view(w, k, A.torque), view(x, k, A.support_height)
    if c.spring > 0.0:
        height = view(x, k, A.end_height)
    total = (torque[c.n - 1] * height[1] - torque[0] * height[0]) / c.spacing
    for i in range(c.n):
        total += load_x[i] * u[i + 1] + load_y[i] * v[i + 1]
    return total


@kernel
def set_kicks(c, dt, x, k):
    """Set the change of each disc's rate per force in a step dt (s), for :func:`move`."""
    mass, kick = view(x, k, A.mass), view(x, k, A.kick)
    for i in range(c.n):
        kick[i] = dt / mass[i]


@kernel
def move(c, dt, w, x, k):
    """Advance the discs by a step, semi-implicit Euler.

    Rates follow from the shape and its moments, then displacements from the new rates.

    Parameters
    ----------
    c : Chain
        Constants.
    dt : float
        Length of the step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    kick = view(x, k, A.kick)
    keep = 1.0 - c.drag * dt
    _move_discs(
        c.n,
        dt,
        kick,
        keep,
        0.0,
        c.axial,
        view(x, k, A.u_shape),
        view(x, k, A.load_x),
        view(x, k, A.u_rate),
        view(x, k, A.u),
    )
    _move_discs(
        c.n,
        dt,
        kick,
        keep,
        c.gravity * dt,
        -1.0 / c.spacing,
        view(x, k, A.hinge_moment),
        view(x, k, A.load_y),
        view(x, k, A.v_rate),
        view(x, k, A.v),
    )
    _lift(c, dt, w, x, k)
    height, speed = view(x, k, A.support_height), view(w, k, A.support_velocity_y)
    for s in range(c.supports):
        height[s] += dt * speed[s]
    if c.spring > 0.0:
        _move_ends(c, dt, keep, x, k)


@kernel
def _move_ends(c, dt, keep, x, k):
    """Advance the ends on elastic supports by a step dt (s)."""
    height, rate, net = view(x, k, A.end_height), view(x, k, A.end_rate), view(x, k, A.end_force)
    for s in range(2):
        rate[s] = keep * rate[s] + dt / c.plate * net[s]
        height[s] += dt * rate[s]


@kernel
def _lift(c, dt, w, x, k):
    """Add what the inner supports do to the discs above them in a step dt (s)."""
    element, reaction = view(w, k, A.support_element), view(x, k, A.reaction)
    rate, v, kick = view(x, k, A.v_rate), view(x, k, A.v), view(x, k, A.kick)
    for s in range(2, c.supports):
        i = int(element[s])
        gained = -kick[i - 1] * reaction[s]
        rate[i] += gained
        v[i] += dt * gained


@kernel
def _move_discs(n, dt, kick, keep, fall, stiffness, field, load, rate, displacement):
    """Advance the discs by a step dt (s) in one direction.

    Every disc is pulled by ``stiffness`` times the second difference of ``field``.
    """
    for i in range(n):
        force = load[i] + stiffness * ((field[i + 2] + field[i]) - 2.0 * field[i + 1])
        rate[i + 1] = keep * rate[i + 1] + kick[i] * force - fall
        displacement[i + 1] += dt * rate[i + 1]


@kernel
def kinetic_energy(c, x, k):
    """Return the kinetic energy of the discs (J), and of ends on springs.

    Their rotation is no freedom and carries none.
    """
    u_rate, v_rate, mass = view(x, k, A.u_rate), view(x, k, A.v_rate), view(x, k, A.mass)
    total = 0.0
    for i in range(c.n):
        total += mass[i] * (u_rate[i + 1] * u_rate[i + 1] + v_rate[i + 1] * v_rate[i + 1])
    if c.spring > 0.0:
        rate = view(x, k, A.end_rate)
        total += c.plate * (rate[0] * rate[0] + rate[1] * rate[1])
    return 0.5 * total


@kernel
def spring_energy(c, x, k):
    """Return the energy of the springs under elastic supports (J)."""
    left, right = settlement(c, 0, x, k), settlement(c, 1, x, k)
    return 0.5 * c.spring * (left * left + right * right)


@kernel
def axial_energy(c, x, k):
    """Return the energy of the axial springs (J) in the present shape: 1/2 sum k_N du2.

    Half springs at the supports are twice as stiff.
    """
    u = view(x, k, A.u_shape)
    n = c.n
    total = 0.5 * ((u[1] - u[0]) ** 2 + (u[n + 1] - u[n]) ** 2)
    for i in range(1, n):
        total += (u[i + 1] - u[i]) ** 2
    return 0.5 * c.axial * total


@kernel
def bending_energy(c, x, k):
    """Return the energy of the hinges (J) in the present shape: 1/2 sum M2 / k_M.

    That of the inner supports is in it.
    """
    bent = locked_and_elastic_energy(c, x, k) if c.yielding else _elastic_energy(c, x, k)
    return bent + _bearing_energy(c, x, k)


@kernel
def _elastic_energy(c, x, k):
    moment = view(x, k, A.hinge_moment)
    n = c.n
    total = 0.0
    for i in range(1, n + 1):
        total += moment[i] * moment[i]
    if c.fixed:
        left, right = wall_moments(c, x, k)
        total += (1.0 / END_HINGE - 1.0) * (moment[1] * moment[1] + moment[n] * moment[n])
        total += (left * left + right * right) / WALL_HINGE
    return 0.5 * total / (c.bending * c.spacing)


@kernel
def _bearing_energy(c, x, k):
    """Return the energy of the inner supports (J) in the present shape."""
    reaction = view(x, k, A.reaction)
    held = 0.0
    for s in range(2, c.supports):
        held += reaction[s] * reaction[s]
    return 0.5 * held / c.bearing


@kernel
def dissipation(c, w, x, k):
    """Return the power (W) that the damping takes now. Leaves the rates as the shape."""
    deform(c, 0.0, 1.0, w, x, k)
    bent = rate_energy(c, x, k) if c.yielding else _elastic_energy(c, x, k)
    return 2.0 * (
        c.drag * kinetic_energy(c, x, k)
        + c.viscosity * (axial_energy(c, x, k) + (bent + _bearing_energy(c, x, k)))
    )
