"""Rock and beam where the inputs say, and the forces on them as outputs."""

from ..common.kernels import kernel, view
from .bodies import bodies_of, disc_count
from .declarations import LAYOUT, SUM

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def place(b, position, velocity, ahead, bodies):
    """Move boundary b on for a time.

    Parameters
    ----------
    b : int
        Number of the boundary.
    position, velocity : tuple of float
        To the right and upwards (m, m/s), and of the angle (rad, rad/s).
    ahead : float
        The time (s).
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    float
        Work (J) that the present contact force on the boundary does along this way.
    """
    vx, vy, omega = velocity
    x = position[0] + vx * ahead
    y = position[1] + vy * ahead
    angle = position[2] + omega * ahead
    radius = bodies.radius[b]
    work = (
        bodies.force_x[b] * (x - bodies.x[b])
        + bodies.force_y[b] * (y - bodies.y[b])
        + bodies.turn[b] * radius * (angle - bodies.angle[b])
    )
    bodies.x[b], bodies.y[b], bodies.angle[b] = x, y, angle
    bodies.vx[b], bodies.vy[b], bodies.spin[b] = vx, vy, omega * radius
    return work


@kernel
def set_boundaries(ahead, w, x, k):
    """Put rock and beam discs where the inputs say, and count the work done on the sand.

    Before the first call their radii must be known.

    Parameters
    ----------
    ahead : float
        Time (s) by which the motion goes on from the inputs.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    bodies, sums = bodies_of(x, k), view(x, k, A.sums)
    sums[SUM.rock] -= place(
        bodies.rock,
        (w[V.rock_position_x], w[V.rock_position_y], w[V.rock_angle]),
        (w[V.rock_velocity_x], w[V.rock_velocity_y], w[V.rock_angular_velocity]),
        ahead,
        bodies,
    )
    px, py = view(w, k, A.beam_position_x), view(w, k, A.beam_position_y)
    vx, vy = view(w, k, A.beam_velocity_x), view(w, k, A.beam_velocity_y)
    angle, omega = view(w, k, A.beam_angle), view(w, k, A.beam_angular_velocity)
    for q in range(px.size):
        position, velocity = (px[q], py[q], angle[q]), (vx[q], vy[q], omega[q])
        sums[SUM.beam] -= place(bodies.rock + 1 + q, position, velocity, ahead, bodies)


@kernel
def collect_forces(share, first, w, x, k):
    """Add a share of the present contact forces to the outputs.

    Parameters
    ----------
    share : float
        Part of the communication step in which the forces act.
    first : bool
        Whether the outputs begin anew.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    bodies, sums, rock = bodies_of(x, k), view(x, k, A.sums), disc_count(k)
    fx, fy = view(w, k, A.beam_force_x), view(w, k, A.beam_force_y)
    torque = view(w, k, A.beam_torque)
    keep = 0.0 if first else 1.0
    w[V.rock_force_x] = keep * w[V.rock_force_x] + share * bodies.force_x[rock]
    w[V.rock_force_y] = keep * w[V.rock_force_y] + share * bodies.force_y[rock]
    w[V.rock_torque] = keep * w[V.rock_torque] + share * bodies.turn[rock] * w[V.rock_radius]
    for q in range(fx.size):
        b = rock + 1 + q
        fx[q] = keep * fx[q] + share * bodies.force_x[b]
        fy[q] = keep * fy[q] + share * bodies.force_y[b]
        torque[q] = keep * torque[q] + share * bodies.turn[b] * w[V.beam_radius]
    w[V.transmitted_force] = keep * w[V.transmitted_force] + share * sums[SUM.transmitted]
