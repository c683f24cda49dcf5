"""A rigid body in the plane under constant force and torque and its weight, semi-implicit Euler."""

from collections import namedtuple

from .kernels import kernel

Motion = namedtuple("Motion", "x y angle velocity_x velocity_y angular_velocity")
"""Position of the centre (m), angle (rad), their velocities (m/s, rad/s): x to the right, y
upwards, angles counter-clockwise."""
Load = namedtuple("Load", "force_x force_y torque")
"""Force without the weight (N) and torque about the centre (N m)."""


@kernel
def moved(motion, load, mass, inertia, gravity, dt):
    """Return a body's motion after a step, and the work of the load in it.

    Velocity first, then position with the new velocity. A constant force does exactly the work
    force * mean velocity * dt on the kinetic energy.

    Parameters
    ----------
    motion : Motion
        At the start of the step.
    load : Load
        Constant in the step.
    mass, inertia : float
        Mass (kg) and moment of inertia about the centre (kg m2).
    gravity : float
        Acceleration of gravity, downwards (m/s2).
    dt : float
        Length of the step (s).

    Returns
    -------
    tuple of Motion and float
        Motion at the end, and work of force and torque (J).
    """
    velocity_x = motion.velocity_x + load.force_x / mass * dt
    velocity_y = motion.velocity_y + (load.force_y / mass - gravity) * dt
    spin = motion.angular_velocity + load.torque / inertia * dt
    work = (
        0.5
        * dt
        * (
            load.force_x * (motion.velocity_x + velocity_x)
            + load.force_y * (motion.velocity_y + velocity_y)
            + load.torque * (motion.angular_velocity + spin)
        )
    )
    x, y = motion.x + velocity_x * dt, motion.y + velocity_y * dt
    return Motion(x, y, motion.angle + spin * dt, velocity_x, velocity_y, spin), work
