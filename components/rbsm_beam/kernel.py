"""Life of the beam: start at rest, advance with held forces, publish."""

from ..common.component import OK
from ..common.kernels import kernel, view
from ..common.stepping import TOO_MANY_STEPS
from ..common.substeps import are_too_many, substep_count, substep_length
from .chain import (
    END_HINGE,
    WALL_HINGE,
    axial_energy,
    bending_energy,
    box_momentum,
    box_stands_on_beam,
    chain,
    deform,
    dissipation,
    distribute,
    follow,
    hold,
    kinetic_energy,
    move,
    potential,
    react,
    set_kicks,
    settlement,
    spring_energy,
    springs_fit_supports,
    supports_have_places,
    wall_moments,
)
from .declarations import LAYOUT
from .faults import BAD_CORNERS, BAD_SPRING, BOX_OFF_BEAM, DIVERGED, NO_PLACE, NO_REST
from .statics import rest, set_midspan_influence, stable_step
from .yielding import (
    curvature_ratio,
    permanent,
    residual_deflection,
    set_lengths,
    set_sliders,
    unslip,
)

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def initialise(w, x, k):
    """Compute the constants of the chain and its stable step from the parameters alone.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status: OK, BOX_OFF_BEAM, NO_PLACE, BAD_SPRING or BAD_CORNERS.
    """
    if not box_stands_on_beam(w):
        return BOX_OFF_BEAM
    if not supports_have_places(w, k):
        return NO_PLACE
    if not springs_fit_supports(w):
        return BAD_SPRING
    c = chain(w, k)
    if c.yielding and not set_sliders(w, x, k):
        return BAD_CORNERS
    set_lengths(c, WALL_HINGE, END_HINGE, x, k)
    unslip(x, k)
    distribute(c, w, x, k)
    w[V.radius] = 0.5 * c.spacing
    w[V.stable_step] = stable_step(c, w, x, k)
    if c.yielding:
        set_midspan_influence(c, w, x, k)
    return OK


@kernel
def evaluate(w, x, k):
    """Compute state and outputs at the start: at rest, in equilibrium with all weights.

    The supports stand where their inputs say. Forces act from then on.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status, OK, NO_REST or DIVERGED.
    """
    c = chain(w, k)
    _place(view(x, k, A.support_height), view(w, k, A.support_position_y))
    if not rest(c, w, x, k):
        return NO_REST
    hold(c, w, x, k)
    w[V.energy_damping], w[V.energy_work_contact] = 0.0, 0.0
    w[V.energy_plastic], w[V.curvature_ratio] = 0.0, 0.0
    w[V.energy_work_support], w[V.energy_start] = 0.0, 0.0
    w[V.box_inertia_force] = 0.0
    status = publish(w, x, k)
    w[V.midspan_start_strain], w[V.energy_strain_estimate] = w[V.midspan_strain], 0.0
    _place(view(w, k, A.support_mean_force_y), view(w, k, A.support_force_y))
    w[V.energy_start], w[V.energy_residual] = w[V.energy_residual], 0.0
    work = view(w, k, A.support_work)
    for s in range(len(work)):
        work[s] = 0.0
    return status


@kernel
def _place(target, values):
    for s in range(len(target)):
        target[s] = values[s]


@kernel
def step(t, h, w, x, k):
    """Advance by h with constant forces and torques, the supports moving with constant velocity.

    Parameters
    ----------
    t, h : float
        Start and length of the communication step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status, OK or DIVERGED.
    """
    if are_too_many(h, w[V.internal_step]):
        return TOO_MANY_STEPS
    n = substep_count(h, w[V.internal_step])
    dt = substep_length(h, n, w[V.internal_step])
    c = chain(w, k)
    before = box_momentum(c, w, x, k)
    advance(n, dt, w, x, k)
    w[V.box_inertia_force] = (before - box_momentum(c, w, x, k)) / (n * dt)
    return publish(w, x, k)


@kernel
def advance(n, dt, w, x, k):
    """Advance by n internal steps with the inputs in w.

    Of the outputs only the works and support.mean_force are brought up to date. For programs that
    couple at every internal step: n calls with one step give the same motion to the bit as one call
    with n.

    Parameters
    ----------
    n : int
        Number of steps.
    dt : float
        Length of one step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    c = chain(w, k)
    hold(c, w, x, k)
    set_kicks(c, dt, x, k)
    before = potential(c, w, x, k)
    settle(c, w, x, k)
    _move_and_react(c, n, dt, w, x, k)
    w[V.energy_work_contact] += potential(c, w, x, k) - before
    speed, mean = view(w, k, A.support_velocity_y), view(w, k, A.support_mean_force_y)
    work = view(w, k, A.support_work)
    power = 0.0
    for s in range(c.supports):
        power += mean[s] * speed[s]
        work[s] -= dt * mean[s] * speed[s]
        mean[s] /= n
    w[V.energy_work_support] -= dt * power


@kernel
def _move_and_react(c, n, dt, w, x, k):
    """Advance by n steps of dt (s); leave the sums of the forces on the supports in their mean."""
    damped = c.drag > 0.0 or c.viscosity > 0.0
    total, reaction = view(w, k, A.support_mean_force_y), view(x, k, A.reaction)
    for s in range(c.supports):
        total[s] = 0.0
    for _ in range(n):
        follow(c, w, x, k)
        if damped:
            w[V.energy_damping] += dt * dissipation(c, w, x, k)
        deform(c, 1.0, c.viscosity, w, x, k)
        react(c, w, x, k)
        for s in range(c.supports):
            total[s] += reaction[s]
        move(c, dt, w, x, k)


@kernel
def settle(c, w, x, k):
    """Put the supports at their input heights.

    The work of the jump is exact where nothing yields in it, as the elastic force is linear in it.

    Parameters
    ----------
    c : Chain
        Constants.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    height, given = view(x, k, A.support_height), view(w, k, A.support_position_y)
    work, reaction = view(w, k, A.support_work), view(x, k, A.reaction)
    jump = view(x, k, A.jump)
    stays = True
    for s in range(c.supports):
        jump[s] = given[s] - height[s]
        stays &= jump[s] == 0.0
    if stays:
        return
    for _ in range(2):
        follow(c, w, x, k)
        deform(c, 1.0, 0.0, w, x, k)
        react(c, w, x, k)
        done = 0.0
        for s in range(c.supports):
            done += jump[s] * reaction[s]
            work[s] -= 0.5 * jump[s] * reaction[s]
        w[V.energy_work_support] -= 0.5 * done
        _place(height, given)


@kernel
def publish(w, x, k):
    """Write the outputs from the state.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status: OK, or DIVERGED where a displacement exceeds half the span or is no number.
    """
    c = chain(w, k)
    follow(c, w, x, k)
    _publish_forces(c, w, x, k)
    _publish_rates(c, w, x, k)
    deform(c, 1.0, 0.0, w, x, k)
    _publish_places(c, w, x, k)
    _publish_yielding(c, w, x, k)
    _publish_midspan(c, w, x, k)
    _publish_energies(c, w, x, k)
    limit = 0.5 * w[V.span]
    return (
        OK
        if _within(c.n, limit, view(x, k, A.u)) and _within(c.n, limit, view(x, k, A.v))
        else DIVERGED
    )


@kernel
def _publish_forces(c, w, x, k):
    on_discs, on_supports = view(w, k, A.force_y), view(w, k, A.support_force_y)
    total = 0.0
    for i in range(c.n):
        total -= on_discs[i]
    w[V.transmitted_force] = total
    deform(c, 1.0, c.viscosity, w, x, k)
    react(c, w, x, k)
    _place(on_supports, view(x, k, A.reaction))
    _publish_shears(c, w, x, k)


@kernel
def _publish_shears(c, w, x, k):
    """Write the shear forces in the joints: what the discs left of them push up with.

    A torque on a disc is a couple of forces at its neighbours: half of it acts in either joint.
    """
    moment, torque = view(x, k, A.hinge_moment), view(w, k, A.torque)
    shear, at_support = view(w, k, A.shear), view(w, k, A.support_shear)
    element, reaction = view(w, k, A.support_element), view(x, k, A.reaction)
    for i in range(c.n):
        couple = 0.5 * (torque[max(i - 1, 0)] + torque[i])
        shear[i] = (moment[i + 1] - moment[i] + couple) / c.spacing
    net = view(x, k, A.end_force)
    at_support[0], at_support[1] = -(reaction[0] + net[0]), reaction[1] + net[1]
    for s in range(2, c.supports):
        disc = int(element[s]) - 1
        left = shear[disc]
        right = at_support[1] if disc == c.n - 1 else shear[disc + 1]
        at_support[s] = left if abs(left) > abs(right) else right


@kernel
def _publish_rates(c, w, x, k):
    deform(c, 0.0, 1.0, w, x, k)
    _publish_axis(c.n, 0.0, 0.0, view(x, k, A.u_rate), view(w, k, A.velocity_x))
    _publish_axis(c.n, 0.0, 0.0, view(x, k, A.v_rate), view(w, k, A.velocity_y))
    _publish_slopes(c.n, 0.5 / c.spacing, view(x, k, A.v_shape), view(w, k, A.angular_velocity))


@kernel
def _publish_places(c, w, x, k):
    _publish_axis(
        c.n, w[V.axis_x] + 0.5 * c.spacing, c.spacing, view(x, k, A.u), view(w, k, A.position_x)
    )
    _publish_axis(c.n, w[V.axis_y], 0.0, view(x, k, A.v), view(w, k, A.position_y))
    _publish_axis(c.n, 0.0, 0.0, view(x, k, A.hinge_moment), view(w, k, A.moment))
    _publish_support_moments(c, w, x, k)
    _publish_slopes(c.n, 0.5 / c.spacing, view(x, k, A.v_shape), view(w, k, A.angle))
    sunk = view(w, k, A.support_settlement)
    for s in range(2):
        sunk[s] = settlement(c, s, x, k) if c.spring > 0.0 else 0.0


@kernel
def _publish_support_moments(c, w, x, k):
    """Write the moments at the walls, and above inner supports those of their discs."""
    target, element = view(w, k, A.support_moment), view(w, k, A.support_element)
    moment = view(x, k, A.hinge_moment)
    target[0], target[1] = wall_moments(c, x, k)
    for s in range(2, c.supports):
        target[s] = moment[int(element[s])]


@kernel
def _publish_yielding(c, w, x, k):
    """Write plastic curvatures and rotations, the residual deflection, the largest curvature."""
    if not c.yielding:
        return
    length = view(x, k, A.hinge_length)
    curvature, turned = view(w, k, A.plastic_curvature), view(w, k, A.support_plastic_rotation)
    stiffness = c.bending * c.spacing * c.spacing
    for i in range(c.n):
        curvature[i] = permanent(c, i + 1, x, k) / stiffness
    turned[0] = permanent(c, 0, x, k) / stiffness * length[0] * c.spacing
    turned[1] = permanent(c, c.n + 1, x, k) / stiffness * length[c.n + 1] * c.spacing
    w[V.midspan_residual_deflection] = residual_deflection(c, x, k)
    w[V.curvature_ratio] = max(w[V.curvature_ratio], curvature_ratio(c, x, k))


@kernel
def _publish_axis(n, first, spacing, padded, target):
    """Set target[i] = first + i * spacing + value of the padded array for disc i."""
    for i in range(n):
        target[i] = first + i * spacing + padded[i + 1]


@kernel
def _publish_slopes(n, per_length, padded, target):
    for i in range(n):
        target[i] = (padded[i + 2] - padded[i]) * per_length


@kernel
def _publish_midspan(c, w, x, k):
    """Write the outputs of the midspan.

    It is at the middle disc, or for an even number in the middle of the bar between the two middle
    discs.
    """
    v, moment = view(x, k, A.v), view(x, k, A.hinge_moment)
    one, other = (c.n + 1) // 2, c.n // 2 + 1
    stiffness = w[V.elastic_modulus] * w[V.section_second_moment]
    w[V.midspan_deflection] = -0.5 * (v[one] + v[other])
    w[V.midspan_moment] = 0.5 * (moment[one] + moment[other])
    bent = w[V.midspan_moment]
    if c.yielding:
        elastic = view(x, k, A.elastic_moment)
        bent = 0.5 * (elastic[one] + elastic[other])
    w[V.midspan_strain] = bent * 0.5 * w[V.section_height] / stiffness
    gained = w[V.midspan_strain] - w[V.midspan_start_strain]
    deflection = w[V.span] * w[V.span] * gained / (6.0 * w[V.section_height])
    w[V.energy_strain_estimate] = 24.0 * stiffness / w[V.span] ** 3 * deflection * deflection


@kernel
def _publish_energies(c, w, x, k):
    v, mass = view(x, k, A.v), view(x, k, A.mass)
    lifted = 0.0
    for i in range(c.n):
        lifted += mass[i] * v[i + 1]
    w[V.energy_kinetic] = kinetic_energy(c, x, k)
    w[V.energy_axial], w[V.energy_bending] = axial_energy(c, x, k), bending_energy(c, x, k)
    w[V.energy_elastic] = w[V.energy_axial] + w[V.energy_bending]
    w[V.energy_support] = spring_energy(c, x, k) if c.spring > 0.0 else 0.0
    w[V.energy_gravity] = c.gravity * lifted
    w[V.energy_residual] = (
        w[V.energy_kinetic]
        + w[V.energy_elastic]
        + w[V.energy_support]
        + w[V.energy_gravity]
        + w[V.energy_damping]
        + w[V.energy_plastic]
        - w[V.energy_work_contact]
        - w[V.energy_work_support]
        - w[V.energy_start]
    )


@kernel
def _within(n, limit, padded):
    """Return whether all discs' values are numbers not beyond the limit."""
    inside = True
    for i in range(1, n + 1):
        inside &= abs(padded[i]) <= limit
    return inside
