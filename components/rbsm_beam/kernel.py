"""Life of the beam: start at rest, advance with held forces, publish."""

from ..compilation import kernel
from ..component import OK
from ..ports import view
from ..stepping import substep_count
from .chain import axial_energy, bending_energy, chain, dissipation, feel, hold, kinetic_energy, move, potential, reactions
from .declarations import LAYOUT
from .statics import rest, stable_step

V, A = LAYOUT.scalar, LAYOUT.array

DIVERGED = 1


@kernel
def initialise(w, x, k):
    """What follows from the parameters alone."""
    c = chain(w, x, k)
    w[V.radius] = 0.5 * c.spacing
    w[V.stable_step] = stable_step(c)
    return OK


@kernel
def evaluate(w, x, k):
    """The state at the start: at rest, in equilibrium with the weight, on the supports as they stand. Forces act from then on."""
    c = chain(w, x, k)
    height, mean, force = view(w, k, A.support_position_y), view(w, k, A.support_mean_force_y), view(w, k, A.support_force_y)
    c.height[0], c.height[1] = height[0], height[1]
    rest(c)
    hold(c, view(w, k, A.force_x), view(w, k, A.force_y))
    w[V.energy_damping], w[V.energy_work_contact], w[V.energy_work_support], w[V.energy_start] = 0.0, 0.0, 0.0, 0.0
    status = publish(w, x, k)
    mean[0], mean[1] = force[0], force[1]
    w[V.energy_start], w[V.energy_residual] = w[V.energy_residual], 0.0
    return status


@kernel
def step(t, h, w, x, k):
    """Advance by h (s) with constant forces and torques, the supports moving with constant velocity."""
    n = substep_count(h, w[V.internal_step])
    advance(n, h / n, w, x, k)
    return publish(w, x, k)


@kernel
def advance(n, dt, w, x, k):
    """n steps of dt (s) with the inputs in w. Of the outputs only the works and support.mean_force are brought up to date.

    For programs that couple at every internal step: n calls with one step give the same motion to the bit as one call with n.
    """
    c = chain(w, x, k)
    hold(c, view(w, k, A.force_x), view(w, k, A.force_y))
    before = potential(c)
    settle(c, view(w, k, A.support_position_y), w)
    damped = c.drag > 0.0 or c.viscosity > 0.0
    left, right = 0.0, 0.0
    for _ in range(n):
        if damped:
            w[V.energy_damping] += dt * dissipation(c)
        feel(c, 1.0, c.viscosity)
        at_left, at_right = reactions(c)
        left += at_left
        right += at_right
        move(c, dt)
    w[V.energy_work_contact] += potential(c) - before
    w[V.energy_work_support] -= dt * (left * c.speed[0] + right * c.speed[1])
    mean = view(w, k, A.support_mean_force_y)
    mean[0], mean[1] = left / n, right / n


@kernel
def settle(c, height, w):
    """Put the supports at these heights (m). The work of the jump is exact, as the elastic force is linear in it."""
    left, right = height[0] - c.height[0], height[1] - c.height[1]
    if left == 0.0 and right == 0.0:
        return
    for _ in range(2):
        feel(c, 1.0, 0.0)
        at_left, at_right = reactions(c)
        w[V.energy_work_support] -= 0.5 * (left * at_left + right * at_right)
        c.height[0], c.height[1] = height[0], height[1]


@kernel
def publish(w, x, k):
    """Refresh the outputs from the state. Returns the status: OK, or DIVERGED."""
    c = chain(w, x, k)
    _publish_forces(c, w, k)
    _publish_rates(c, w, k)
    feel(c, 1.0, 0.0)
    _publish_places(c, w, k)
    _publish_midspan(c, w)
    _publish_energies(c, w)
    return OK if _within(c, 0.5 * w[V.span]) else DIVERGED


@kernel
def _publish_forces(c, w, k):
    on_discs, on_supports = view(w, k, A.force_y), view(w, k, A.support_force_y)
    total = 0.0
    for i in range(c.n):
        total -= on_discs[i]
    w[V.transmitted_force] = total
    feel(c, 1.0, c.viscosity)
    on_supports[0], on_supports[1] = reactions(c)


@kernel
def _publish_rates(c, w, k):
    velocity_x, velocity_y, spin = view(w, k, A.velocity_x), view(w, k, A.velocity_y), view(w, k, A.angular_velocity)
    feel(c, 0.0, 1.0)
    for i in range(c.n):
        velocity_x[i], velocity_y[i] = c.u_rate[i + 1], c.v_rate[i + 1]
        spin[i] = (c.v_felt[i + 2] - c.v_felt[i]) / (2.0 * c.spacing)


@kernel
def _publish_places(c, w, k):
    position_x, position_y, angle = view(w, k, A.position_x), view(w, k, A.position_y), view(w, k, A.angle)
    moment = view(w, k, A.moment)
    for i in range(c.n):
        position_x[i] = w[V.axis_x] + (i + 0.5) * c.spacing + c.u[i + 1]
        position_y[i] = w[V.axis_y] + c.v[i + 1]
        angle[i] = (c.v_felt[i + 2] - c.v_felt[i]) / (2.0 * c.spacing)
        moment[i] = c.moment[i + 1]


@kernel
def _publish_midspan(c, w):
    """The middle disc, or for an even number the middle of the bar between the two middle discs."""
    one, other = (c.n + 1) // 2, c.n // 2 + 1
    stiffness = w[V.elastic_modulus] * w[V.section_second_moment]
    w[V.midspan_deflection] = -0.5 * (c.v[one] + c.v[other])
    w[V.midspan_moment] = 0.5 * (c.moment[one] + c.moment[other])
    w[V.midspan_strain] = w[V.midspan_moment] * 0.5 * w[V.section_height] / stiffness
    deflection = w[V.span] * w[V.span] * w[V.midspan_strain] / (6.0 * w[V.section_height])
    w[V.energy_strain_estimate] = 24.0 * stiffness / w[V.span] ** 3 * deflection * deflection


@kernel
def _publish_energies(c, w):
    height = 0.0
    for i in range(1, c.n + 1):
        height += c.v[i]
    w[V.energy_kinetic] = kinetic_energy(c)
    w[V.energy_axial], w[V.energy_bending] = axial_energy(c), bending_energy(c)
    w[V.energy_elastic] = w[V.energy_axial] + w[V.energy_bending]
    w[V.energy_gravity] = c.mass * c.gravity * height
    w[V.energy_residual] = (w[V.energy_kinetic] + w[V.energy_elastic] + w[V.energy_gravity] + w[V.energy_damping]
                            - w[V.energy_work_contact] - w[V.energy_work_support] - w[V.energy_start])


@kernel
def _within(c, limit):
    """Whether all displacements are numbers not beyond the limit (m)."""
    inside = True
    for i in range(1, c.n + 1):
        inside &= abs(c.u[i]) <= limit and abs(c.v[i]) <= limit
    return inside
