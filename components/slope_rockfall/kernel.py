"""Life of the rock as an FMU: start, event-driven motion on the slope, motion under outside forces in the receiver."""

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
"""Published as stable step (s): without outside forces that depend on the motion, every step is stable."""
TOUCHING = 1e-9
"""Depth (m) below the path that is rounding."""
MOST_EVENTS = 1_000_000
"""Events in one communication step after which something must be wrong."""
_GRID = 1e12
"""Times are taken in whole picoseconds, so that the rounding of a tool's clock does not reach the outputs."""
_COARSE = 2.0**52 / _GRID
"""Time (s) beyond which numbers are too far apart to tell picoseconds."""


@kernel
def on_grid(time):
    """The time (s) in whole picoseconds."""
    return math.floor(time * _GRID + 0.5) / _GRID


@kernel
def grid_after(time):
    """The first whole picosecond (s) that is not before the time (s): a step that ends there has what happens then behind it."""
    if time > _COARSE:
        return time
    number = math.floor(time * _GRID)
    while number / _GRID < time:
        number += 1
    return number / _GRID


# --- start ---


@kernel
def lay_ground(w, x, k):
    """The materials, cell by cell."""
    ground = view(x, k, A.ground)
    for c in range(k[A.end_x + 1]):
        at = c * len(GROUND)
        ground[at + GROUND.strength], ground[at + GROUND.stiffness] = (
            view(w, k, A.strength)[c],
            view(w, k, A.stiffness)[c],
        )
        ground[at + GROUND.hardening], ground[at + GROUND.friction] = (
            view(w, k, A.hardening)[c],
            view(w, k, A.friction)[c],
        )
        ground[at + GROUND.resistance] = view(w, k, A.resistance)[c]
        ground[at + GROUND.tilt], ground[at + GROUND.tilt_deviation] = (
            view(w, k, A.tilt)[c],
            view(w, k, A.tilt_deviation)[c],
        )
        ground[at + GROUND.roughness] = view(w, k, A.roughness)[c]
        ground[at + GROUND.roughness_deviation] = view(w, k, A.roughness_deviation)[c]


@kernel
def prepare(w, x, k):
    """Path and materials from the parameters. Returns the status: OK, or the first fault of the parameters."""
    fault = first_fault(w, k)
    if fault != OK:
        return fault
    build_path(w, x, k)
    lay_ground(w, x, k)
    return OK


@kernel
def initialise(w, x, k):
    """The rock at its start, or ``lead_time`` before it is handed over, and what it will do first."""
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
    """Bring the trial to ``lead_time`` before its first hand-over: once to learn when that is, and once again up to there."""
    entry = first_entry(world, stream(seed, trial), b)
    begin(world, seed, trial, w, b)
    if entry == NEVER:
        return NEVER_RECEIVED
    clock[CLOCK.begun] = on_grid(max(0.0, entry - w[V.lead_time]))
    clock[CLOCK.origin] = -clock[CLOCK.begun]
    return advance(world, stream(seed, trial), clock[CLOCK.begun], b)


@kernel
def first_entry(world, source, b):
    """Time (s) at which the rock is handed over for the first time; NEVER if it is not. The rock is elsewhere then."""
    for _ in range(MOST_EVENTS):
        if b[BODY.handovers] > 0.0:
            return b[BODY.handover_time]
        if b[BODY.next_time] >= NEVER:
            return NEVER
        happen(world, source, b)
    return NEVER


@kernel
def evaluate(w, x, k):
    """Outputs at the start: :func:`initialise` has set them, and they do not depend on the inputs."""
    return OK


# --- steps ---


@kernel
def step(t, h, w, x, k):
    """Advance by h (s): from event to event, or with constant force and torque where the rock is handed over."""
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
    """Let everything happen up to the time ``end`` (s). Returns the status."""
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
    """Move the rock for h (s) in the receiver, as FallingRock does, and return the status."""
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
    """Outputs at a time (s) not after the next event, from the last event's state."""
    constants, b = world(w, x, k), view(x, k, A.body)
    span = max(0.0, time - b[BODY.time])
    w[V.position_x] = b[BODY.x] + span * (b[BODY.vx] + 0.5 * span * b[BODY.ax])
    w[V.position_y] = b[BODY.y] + span * (b[BODY.vy] + 0.5 * span * b[BODY.ay])
    w[V.angle] = b[BODY.angle] + span * (b[BODY.omega] + 0.5 * span * b[BODY.alpha])
    w[V.velocity_x] = b[BODY.vx] + span * b[BODY.ax]
    w[V.velocity_y] = b[BODY.vy] + span * b[BODY.ay]
    w[V.angular_velocity] = b[BODY.omega] + span * b[BODY.alpha]
    publish_place(constants, b, w, x, k)
    publish_energies(constants, span, b, w)


@kernel
def publish_place(world, b, w, x, k):
    """Mode, cell, height, next event and hand-over."""
    origin = view(x, k, A.clock)[CLOCK.origin]
    j = line_below(w[V.position_x], world.lines, world.path)
    w[V.mode] = b[BODY.mode]
    w[V.cell] = world.path[j * len(PATH) + PATH.cell] + 1.0
    w[V.height] = height_above(j, w[V.position_x], w[V.position_y], world.path)
    w[V.next_event_time] = min(NEVER, origin + grid_after(b[BODY.next_time]))
    w[V.impacts], w[V.handovers] = b[BODY.impacts], b[BODY.handovers]
    w[V.received] = 1.0 if b[BODY.mode] == RECEIVED else 0.0
    w[V.handover_time] = min(NEVER, origin + b[BODY.handover_time])


@kernel
def publish_energies(world, span, b, w):
    """Energies ``span`` seconds after the last event, and the residual."""
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
