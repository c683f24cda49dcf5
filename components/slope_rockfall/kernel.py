"""Life of the rock as an FMU: start, motion from event to event, motion in the receiver.

In the receiver outside forces move the rock.
"""

import math

from ..common.component import OK
from ..common.counter_random import stream
from ..common.kernels import kernel, view
from ..common.rigid_body import Load, Motion, moved
from ..common.stepping import TOO_MANY_STEPS
from ..common.substeps import are_too_many, substep_count, substep_length
from .declarations import BODY, CLOCK, GROUND, LAYOUT, LEAVE, NEVER, PATH, RECEIVED
from .events import begin, happen, inertia, losses, plan, world
from .faults import (
    DIVERGED,
    FORCE_OUTSIDE,
    LEFT_BELOW,
    NEVER_RECEIVED,
    RESTLESS,
    START_BELOW,
)
from .flight import move
from .geometry import build_path, height_above, line_below
from .refusals import first_fault, problems

__all__ = ["evaluate", "initialise", "problems", "step"]

V, A = LAYOUT.scalar, LAYOUT.array

UNBOUNDED_STEP = 1e6
"""Published as stable step (s): without outside forces that depend on the motion, every step is
stable."""
TOUCHING = 1e-9
"""Depth (m) below the path that is rounding."""
MOST_EVENTS = 1_000_000
"""Events in one communication step after which something must be wrong."""
_GRID = 1e12
"""Times are taken in whole picoseconds, so that the rounding of a tool's clock does not reach the
outputs."""
_COARSE = 2.0**52 / _GRID
"""Time (s) beyond which numbers are too far apart to tell picoseconds."""


@kernel
def on_grid(time):
    """Return a time (s) in whole picoseconds.

    Parameters
    ----------
    time : float
        Time (s).

    Returns
    -------
    float
        Time (s).
    """
    return math.floor(time * _GRID + 0.5) / _GRID


@kernel
def grid_after(time):
    """Return the first whole picosecond (s) that is not before a time (s).

    A step that ends there has what happens then behind it.

    Parameters
    ----------
    time : float
        Time (s).

    Returns
    -------
    float
        Time (s).
    """
    if time > _COARSE:
        return time
    number = math.floor(time * _GRID)
    while number / _GRID < time:
        number += 1
    return number / _GRID


# --- start ---


@kernel
def lay_ground(w, x, k):
    """Copy the materials, cell by cell.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.
    """
    ground = view(x, k, A.ground)
    for c in range(k[A.end_x + 1]):
        at = c * len(GROUND)
        ground[at + GROUND.strength] = view(w, k, A.strength)[c]
        ground[at + GROUND.stiffness] = view(w, k, A.stiffness)[c]
        ground[at + GROUND.hardening] = view(w, k, A.hardening)[c]
        ground[at + GROUND.friction] = view(w, k, A.friction)[c]
        ground[at + GROUND.resistance] = view(w, k, A.resistance)[c]
        ground[at + GROUND.tilt] = view(w, k, A.tilt)[c]
        ground[at + GROUND.tilt_deviation] = view(w, k, A.tilt_deviation)[c]
        ground[at + GROUND.roughness] = view(w, k, A.roughness)[c]
        ground[at + GROUND.roughness_deviation] = view(w, k, A.roughness_deviation)[c]
        ground[at + GROUND.undulation] = view(w, k, A.undulation)[c]
        ground[at + GROUND.by_coefficients] = view(w, k, A.by_coefficients)[c]
        ground[at + GROUND.normal_restitution] = view(w, k, A.normal_restitution)[c]
        ground[at + GROUND.tangential_restitution] = view(w, k, A.tangential_restitution)[c]
        ground[at + GROUND.scaling_speed] = view(w, k, A.scaling_speed)[c]


@kernel
def prepare(w, x, k):
    """Compute path and materials from the parameters.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    int
        OK, or the first fault of the parameters.
    """
    fault = first_fault(w, k)
    if fault != OK:
        return fault
    build_path(w, x, k)
    lay_ground(w, x, k)
    return OK


@kernel
def initialise(w, x, k):
    """Put the rock to its start, or to ``lead_time`` before its first hand-over, and plan ahead.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    int
        Status.
    """
    clock, b = view(x, k, A.clock), view(x, k, A.body)
    view(k, k, A.started)[0] = 0
    clock[CLOCK.origin], clock[CLOCK.begun] = 0.0, 0.0
    w[V.stable_step] = UNBOUNDED_STEP
    status = prepare(w, x, k)
    if status != OK:
        return status
    constants, seed, trial = world(w, x, k), int(w[V.seed]), int(w[V.trial])
    clear = begin(constants, seed, trial, w, b)
    if clear and w[V.lead_time] < NEVER:
        status = skip(constants, seed, trial, w, b, clock)
    w[V.energy_start] = 0.0
    publish(clock[CLOCK.begun], w, x, k)
    w[V.energy_start], w[V.energy_residual] = w[V.energy_residual], 0.0
    w[V.fault_cell] = 0.0 if clear else w[V.cell]
    return status if clear else START_BELOW


@kernel
def skip(world, seed, trial, w, b, clock):
    """Bring the trial to ``lead_time`` before its first hand-over, and return the status.

    The trial runs once to learn when that is, and once again up to there.

    Parameters
    ----------
    world : World
        Constants of the trial.
    seed : int
        Number of the sample.
    trial : int
        Number of the trial in the sample.
    w : ndarray of float64
        Variables of the instance.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    clock : ndarray of float64, shape (len(CLOCK),)
        Origin and beginning of the time (s).

    Returns
    -------
    int
        Status.
    """
    entry = first_entry(world, stream(seed, trial), b)
    begin(world, seed, trial, w, b)
    if entry == NEVER:
        return NEVER_RECEIVED
    clock[CLOCK.begun] = on_grid(max(0.0, entry - w[V.lead_time]))
    clock[CLOCK.origin] = -clock[CLOCK.begun]
    return advance(world, stream(seed, trial), clock[CLOCK.begun], b)


@kernel
def first_entry(world, source, b):
    """Return the time (s) at which the rock is handed over for the first time; NEVER if it is not.

    The rock is moved to there.

    Parameters
    ----------
    world : World
        Constants of the trial.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    float
        Time (s).
    """
    for _ in range(MOST_EVENTS):
        if b[BODY.handovers] > 0.0:
            return b[BODY.handover_time]
        if b[BODY.next_time] >= NEVER:
            return NEVER
        happen(world, source, b)
    return NEVER


@kernel
def evaluate(w, x, k):
    """Accept the inputs: :func:`initialise` has set the outputs, and they do not depend on them.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    int
        Status: OK.
    """
    return OK


# --- steps ---


@kernel
def step(t, h, w, x, k):
    """Advance by h (s): from event to event, or under constant load where the rock is handed over.

    Parameters
    ----------
    t, h : float
        Start and length of the step (s).
    w, x, k : ndarray
        Variables, state and table of arrays.

    Returns
    -------
    int
        Status.
    """
    started, clock, b = view(k, k, A.started), view(x, k, A.clock), view(x, k, A.body)
    if started[0] == 0:
        started[0], clock[CLOCK.origin] = 1, t - clock[CLOCK.begun]
    now, end = on_grid(t - clock[CLOCK.origin]), on_grid(t + h - clock[CLOCK.origin])
    constants = world(w, x, k)
    if w[V.force_x] == 0.0 and w[V.force_y] == 0.0 and w[V.torque] == 0.0:
        status = advance(constants, stream(int(w[V.seed]), int(w[V.trial])), end, b)
    elif b[BODY.mode] == RECEIVED:
        status = push(constants, now, end, h, w, b)
    else:
        status = FORCE_OUTSIDE
    publish(end, w, x, k)
    return status


@kernel
def advance(world, source, end, b):
    """Let everything happen up to the time ``end`` (s), and return the status.

    Parameters
    ----------
    world : World
        Constants of the trial.
    source : int
        Stream of random numbers of the trial.
    end : float
        Time (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    int
        Status: OK, LEFT_BELOW or RESTLESS.
    """
    for _ in range(MOST_EVENTS):
        if not b[BODY.next_time] <= end:
            return OK
        event = b[BODY.next_event]
        happen(world, source, b)
        if (
            event == LEAVE
            and height_above(int(b[BODY.line]), b[BODY.x], b[BODY.y], world.path) < -TOUCHING
        ):
            return LEFT_BELOW
    return RESTLESS


@kernel
def push(world, now, end, h, w, b):
    """Move the rock for h (s) in the receiver, as FallingRock does, and return the status.

    Parameters
    ----------
    world : World
        Constants of the trial.
    now : float
        Time at the start of the step (s).
    end : float
        Time at the end of the step (s).
    h : float
        Length of the step (s).
    w : ndarray of float64
        Variables of the instance.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    int
        Status: OK or DIVERGED.
    """
    move(b, now)
    if are_too_many(h, w[V.internal_step]):
        return TOO_MANY_STEPS
    n = substep_count(h, w[V.internal_step])
    dt = substep_length(h, n, w[V.internal_step])
    load = Load(w[V.force_x], w[V.force_y], w[V.torque])
    motion = Motion(b[BODY.x], b[BODY.y], b[BODY.angle], b[BODY.vx], b[BODY.vy], b[BODY.omega])
    for _ in range(n):
        motion, work = moved(motion, load, w[V.mass], inertia(w), world.gravity, dt)
        b[BODY.work] += work
    b[BODY.x], b[BODY.y], b[BODY.angle] = motion.x, motion.y, motion.angle
    b[BODY.vx], b[BODY.vy] = motion.velocity_x, motion.velocity_y
    b[BODY.omega] = motion.angular_velocity
    b[BODY.time] = end
    plan(world, b)
    return OK if math.isfinite(b[BODY.x] + b[BODY.y] + b[BODY.angle]) else DIVERGED


# --- what the outside sees ---


@kernel
def publish(time, w, x, k):
    """Publish the outputs at a time (s) not after the next event, from the last event's state.

    Parameters
    ----------
    time : float
        Time (s).
    w, x, k : ndarray
        Variables, state and integers of the instance.
    """
    constants, b = world(w, x, k), view(x, k, A.body)
    span = max(0.0, time - b[BODY.time])
    place = (
        b[BODY.x] + span * (b[BODY.vx] + 0.5 * span * b[BODY.ax]),
        b[BODY.y] + span * (b[BODY.vy] + 0.5 * span * b[BODY.ay]),
    )
    w[V.position_x], w[V.position_y] = place[0] - w[V.frame_x], place[1] - w[V.frame_y]
    w[V.angle] = b[BODY.angle] + span * (b[BODY.omega] + 0.5 * span * b[BODY.alpha])
    w[V.velocity_x] = b[BODY.vx] + span * b[BODY.ax]
    w[V.velocity_y] = b[BODY.vy] + span * b[BODY.ay]
    w[V.angular_velocity] = b[BODY.omega] + span * b[BODY.alpha]
    publish_place(constants, place, b, w, x, k)
    publish_energies(constants, span, b, w)


@kernel
def publish_place(world, place, b, w, x, k):
    """Publish mode, cell, height, next event and hand-over.

    Parameters
    ----------
    world : World
        Constants of the trial.
    place : tuple of float
        x and y (m) of the centre in the frame of the profile.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    w, x, k : ndarray
        Variables, state and integers of the instance.
    """
    origin = view(x, k, A.clock)[CLOCK.origin]
    j = line_below(place[0], world.lines, world.path)
    w[V.mode] = b[BODY.mode]
    w[V.cell] = world.path[j * len(PATH) + PATH.cell] + 1.0
    w[V.height] = height_above(j, place[0], place[1], world.path)
    w[V.next_event_time] = min(NEVER, origin + grid_after(b[BODY.next_time]))
    w[V.impacts], w[V.handovers] = b[BODY.impacts], b[BODY.handovers]
    w[V.received] = 1.0 if b[BODY.mode] == RECEIVED else 0.0
    w[V.handover_time] = min(NEVER, origin + b[BODY.handover_time])


@kernel
def publish_energies(world, span, b, w):
    """Publish the energies ``span`` seconds after the last event, and the residual.

    Parameters
    ----------
    world : World
        Constants of the trial.
    span : float
        Time after the last event (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    w : ndarray of float64
        Variables of the instance.
    """
    spin = world.radius * w[V.angular_velocity]
    square = (
        w[V.velocity_x] * w[V.velocity_x]
        + w[V.velocity_y] * w[V.velocity_y]
        + world.ratio * spin * spin
    )
    friction, roughness, resistance = losses(world, span, b)
    w[V.energy_kinetic] = 0.5 * world.mass * square
    w[V.energy_gravity] = world.mass * world.gravity * w[V.position_y]
    w[V.energy_impact] = b[BODY.impact]
    w[V.energy_friction] = b[BODY.friction] + friction
    w[V.energy_roughness] = b[BODY.roughness_loss] + roughness
    w[V.energy_resistance] = b[BODY.resistance] + resistance
    w[V.energy_work_contact] = b[BODY.work]
    w[V.energy_residual] = (
        w[V.energy_kinetic]
        + w[V.energy_gravity]
        + w[V.energy_impact]
        + w[V.energy_friction]
        + w[V.energy_roughness]
        + w[V.energy_resistance]
        - w[V.energy_work_contact]
        - w[V.energy_start]
    )
