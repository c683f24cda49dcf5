"""The rock in time: free under gravity and outside forces, or driven with constant velocities."""

import math

from ..common.component import OK
from ..common.kernels import kernel
from ..common.rigid_body import Load, Motion, moved
from ..common.stepping import TOO_MANY_STEPS
from ..common.substeps import are_too_many, substep_count, substep_length
from .declarations import DISC, DRIVEN, LAYOUT, SPHERE
from .faults import DIVERGED

V = LAYOUT.scalar

UNBOUNDED_STEP = 1e6
"""Stable step (s) that is published.

Every step is stable without outside forces that depend on the motion.
"""


@kernel
def inertia(w):
    """Return the moment of inertia in use (kg m2)."""
    if w[V.shape] == SPHERE:
        return 0.4 * w[V.mass] * w[V.radius] * w[V.radius]
    if w[V.shape] == DISC:
        return 0.5 * w[V.mass] * w[V.radius] * w[V.radius]
    return w[V.moment_of_inertia]


@kernel
def move(load, moment_of_inertia, dt, w):
    """Move the rock freely for a step.

    Parameters
    ----------
    load : Load
        Force without the weight (N) and torque (N m).
    moment_of_inertia : float
        Of :func:`inertia` (kg m2).
    dt : float
        Length of the step (s).
    w : ndarray
        Variables of the rock.

    Returns
    -------
    float
        Work of the load (J).
    """
    motion = Motion(
        w[V.position_x],
        w[V.position_y],
        w[V.angle],
        w[V.velocity_x],
        w[V.velocity_y],
        w[V.angular_velocity],
    )
    motion, work = moved(motion, load, w[V.mass], moment_of_inertia, w[V.gravity], dt)
    w[V.position_x], w[V.position_y], w[V.angle] = motion.x, motion.y, motion.angle
    w[V.velocity_x], w[V.velocity_y] = motion.velocity_x, motion.velocity_y
    w[V.angular_velocity] = motion.angular_velocity
    return work


@kernel
def drive(dt, w):
    """Move the rock with constant velocities for a step dt (s).

    The machine undoes what force, torque and weight do to the rock.

    Parameters
    ----------
    dt : float
        Length of the step (s).
    w : ndarray of float64
        Variables.
    """
    contact = dt * (
        w[V.force_x] * w[V.velocity_x]
        + w[V.force_y] * w[V.velocity_y]
        + w[V.torque] * w[V.angular_velocity]
    )
    w[V.position_x] += w[V.velocity_x] * dt
    w[V.position_y] += w[V.velocity_y] * dt
    w[V.angle] += w[V.angular_velocity] * dt
    w[V.energy_work_contact] += contact
    w[V.energy_work_drive] += w[V.mass] * w[V.gravity] * w[V.velocity_y] * dt - contact


@kernel
def energies(w):
    """Write kinetic and potential energy and the residual."""
    speed2 = w[V.velocity_x] * w[V.velocity_x] + w[V.velocity_y] * w[V.velocity_y]
    spin2 = w[V.angular_velocity] * w[V.angular_velocity]
    w[V.energy_kinetic] = 0.5 * w[V.mass] * speed2 + 0.5 * inertia(w) * spin2
    w[V.energy_gravity] = w[V.mass] * w[V.gravity] * w[V.position_y]
    works = w[V.energy_work_contact] + w[V.energy_work_drive]
    w[V.energy_residual] = w[V.energy_kinetic] + w[V.energy_gravity] - works - w[V.energy_start]


@kernel
def initialise(w, x, k):
    """Set the state at the start from the parameters.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status, OK.
    """
    w[V.position_x], w[V.position_y], w[V.angle] = w[V.position0_x], w[V.position0_y], w[V.angle0]
    w[V.velocity_x], w[V.velocity_y] = w[V.velocity0_x], w[V.velocity0_y]
    w[V.angular_velocity] = w[V.angular_velocity0]
    w[V.stable_step] = UNBOUNDED_STEP
    w[V.energy_work_contact], w[V.energy_work_drive] = 0.0, 0.0
    w[V.energy_start] = 0.0
    energies(w)
    w[V.energy_start] = w[V.energy_kinetic] + w[V.energy_gravity]
    w[V.energy_residual] = 0.0
    return OK


@kernel
def evaluate(w, x, k):
    """Leave the outputs at the start: :func:`initialise` has set them, whatever the inputs are."""
    return OK


@kernel
def step(t, h, w, x, k):
    """Advance by h with constant force and torque, or with constant velocities.

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
    moment_of_inertia = inertia(w)
    load = Load(w[V.force_x], w[V.force_y], w[V.torque])
    for _ in range(n):
        if w[V.motion] == DRIVEN:
            drive(dt, w)
        else:
            w[V.energy_work_contact] += move(load, moment_of_inertia, dt, w)
    energies(w)
    return (
        OK
        if math.isfinite(w[V.position_x] + w[V.position_y] + w[V.angle] + w[V.energy_work_contact])
        else DIVERGED
    )
