"""Mechanics of the chain: hinges, axial springs, supports, and one step of its discs.

Arrays over the discs have one more place at each end: the mirror image of the end disc in the support. With it every disc has the
same formula, and the end half-bar has the angle (v[1] - v[0]) / R like any other.
"""

from collections import namedtuple

from ..compilation import kernel
from ..ports import view
from .declarations import FIXED, LAYOUT

V, A = LAYOUT.scalar, LAYOUT.array

WALL_HINGE, END_HINGE = 4.0, 4.0 / 3.0
"""Stiffness of the hinges at a fixed support and at the disc beside it, in units of EI/R: the beam's length that bends in them is
R/4 and 3R/4 (all others: R)."""

Chain = namedtuple("Chain", (
    "n", "u", "v", "u_rate", "v_rate",      # displacements (m) to the right and upwards, and their rates (m/s)
    "u_felt", "v_felt", "moment",           # what the springs respond to, and the moments that follow; ends: mirror images
    "load_x", "load_y", "torque",           # held forces on the discs, couples included in load_y (N); torque (N m)
    "height", "speed",                      # of the supports (m, m/s)
    "spacing", "mass", "bending", "axial",  # R, mass of a disc, EI/R2 (N), EA/R (N/m)
    "fixed", "drag", "viscosity", "gravity"))
"""A beam's arrays (views of its buffers) and constants."""


@kernel
def chain(w, x, k):
    """The chain in the buffers of a component."""
    n = k[A.force_x + 1]
    spacing = w[V.span] / n
    return Chain(
        n, view(x, k, A.u), view(x, k, A.v), view(x, k, A.u_rate), view(x, k, A.v_rate),
        view(x, k, A.u_felt), view(x, k, A.v_felt), view(x, k, A.hinge_moment),
        view(x, k, A.load_x), view(x, k, A.load_y), view(w, k, A.torque),
        view(x, k, A.support_height), view(w, k, A.support_velocity_y),
        spacing, (w[V.density] * w[V.section_area] + w[V.added_mass]) * spacing,
        w[V.elastic_modulus] * w[V.section_second_moment] / (spacing * spacing),
        w[V.elastic_modulus] * w[V.section_area] / spacing,
        w[V.supports] == FIXED, w[V.damping_mass], w[V.damping_stiffness], w[V.gravity])


@kernel
def feel(c, displacement_factor, rate_factor):
    """Moments of the hinges under displacement_factor * displacement + rate_factor * rate, the supports included.

    (1, 0) gives the elastic moments, (0, 1) their rate, (1, viscosity) the elastic and viscous ones together.
    """
    n, felt_u, felt_v, moment = c.n, c.u_felt, c.v_felt, c.moment
    for i in range(n + 2):
        felt_u[i] = displacement_factor * c.u[i] + rate_factor * c.u_rate[i]
        felt_v[i] = displacement_factor * c.v[i] + rate_factor * c.v_rate[i]
    felt_u[0] = -felt_u[1]
    felt_u[n + 1] = -felt_u[n] if c.fixed else felt_u[n]
    felt_v[0] = 2.0 * (displacement_factor * c.height[0] + rate_factor * c.speed[0]) - felt_v[1]
    felt_v[n + 1] = 2.0 * (displacement_factor * c.height[1] + rate_factor * c.speed[1]) - felt_v[n]
    for i in range(n):
        moment[i + 1] = c.bending * ((felt_v[i + 2] + felt_v[i]) - 2.0 * felt_v[i + 1])
    if c.fixed:
        moment[1] *= END_HINGE
        moment[n] *= END_HINGE
    left, right = wall_moments(c)
    moment[0] = 2.0 * left - moment[1]
    moment[n + 1] = 2.0 * right - moment[n]


@kernel
def wall_moments(c):
    """Moments at the left and right support (N m): of the wall hinge on the end half-bar's rotation, or none."""
    if not c.fixed:
        return 0.0, 0.0
    n, stiffness = c.n, WALL_HINGE * c.bending
    return stiffness * (c.v_felt[1] - c.v_felt[0]), stiffness * (c.v_felt[n] - c.v_felt[n + 1])


@kernel
def reactions(c):
    """Forces of the beam on the left and right support (N, upwards), from the moment equilibrium of the end half-bars."""
    n = c.n
    return (-(c.moment[1] - c.moment[0] + c.torque[0]) / c.spacing,
            (c.moment[n + 1] - c.moment[n] + c.torque[n - 1]) / c.spacing)


@kernel
def hold(c, force_x, force_y):
    """Take over the forces on the discs, and each torque as the couple that does the same work.

    A disc's angle is (v[i+1] - v[i-1]) / 2R, so its torque T pulls the disc before it by -T / 2R and the next by T / 2R.
    """
    n, per_length = c.n, 0.5 / c.spacing
    for i in range(n):
        before, after = max(i - 1, 0), min(i + 1, n - 1)
        c.load_x[i] = force_x[i]
        c.load_y[i] = force_y[i] + (c.torque[before] - c.torque[after]) * per_length


@kernel
def potential(c):
    """Work (J) that the held loads do on the way from the undeformed beam to its present place."""
    n = c.n
    total = (c.torque[n - 1] * c.height[1] - c.torque[0] * c.height[0]) / c.spacing
    for i in range(n):
        total += c.load_x[i] * c.u[i + 1] + c.load_y[i] * c.v[i + 1]
    return total


@kernel
def move(c, dt):
    """One step dt (s), semi-implicit Euler: rates from the moments of :func:`feel`, then displacements with the new rates."""
    n, felt, moment = c.n, c.u_felt, c.moment
    kick, keep, fall, per_length = dt / c.mass, 1.0 - c.drag * dt, c.gravity * dt, 1.0 / c.spacing
    for i in range(n):
        pull = c.load_x[i] + c.axial * ((felt[i + 2] + felt[i]) - 2.0 * felt[i + 1])
        push = c.load_y[i] - per_length * ((moment[i + 2] + moment[i]) - 2.0 * moment[i + 1])
        c.u_rate[i + 1] = keep * c.u_rate[i + 1] + kick * pull
        c.v_rate[i + 1] = keep * c.v_rate[i + 1] + kick * push - fall
        c.u[i + 1] += dt * c.u_rate[i + 1]
        c.v[i + 1] += dt * c.v_rate[i + 1]
    c.height[0] += dt * c.speed[0]
    c.height[1] += dt * c.speed[1]


@kernel
def kinetic_energy(c):
    """Kinetic energy of the discs (J); their rotation is no freedom and carries none."""
    total = 0.0
    for i in range(1, c.n + 1):
        total += c.u_rate[i] * c.u_rate[i] + c.v_rate[i] * c.v_rate[i]
    return 0.5 * c.mass * total


@kernel
def axial_energy(c):
    """Energy of the axial springs (J) for what they feel: 1/2 sum k_N du2; half springs at the supports are twice as stiff."""
    n, felt = c.n, c.u_felt
    total = 0.5 * ((felt[1] - felt[0]) ** 2 + (felt[n + 1] - felt[n]) ** 2)
    for i in range(1, n):
        total += (felt[i + 1] - felt[i]) ** 2
    return 0.5 * c.axial * total


@kernel
def bending_energy(c):
    """Energy of the hinges (J) for what they feel: 1/2 sum M2 / k_M."""
    n, moment = c.n, c.moment
    total = 0.0
    for i in range(1, n + 1):
        total += moment[i] * moment[i]
    if c.fixed:
        left, right = wall_moments(c)
        total += (1.0 / END_HINGE - 1.0) * (moment[1] * moment[1] + moment[n] * moment[n])
        total += (left * left + right * right) / WALL_HINGE
    return 0.5 * total / (c.bending * c.spacing)


@kernel
def dissipation(c):
    """Power (W) that the damping takes now. Leaves the rates in what the springs feel."""
    feel(c, 0.0, 1.0)
    return 2.0 * (c.drag * kinetic_energy(c) + c.viscosity * (axial_energy(c) + bending_energy(c)))
