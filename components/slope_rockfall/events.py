"""From event to event: what the rock does until the next one, and what happens there. Equations (29)-(31).

The state at an event decides everything up to the next; nothing is accumulated in between. So a trial is the same whoever asks
for it, and however often outputs are read on the way.
"""

import math
from collections import namedtuple

import numpy as np

from ..common.counter_random import draw, mix, shuffled, stream
from ..common.kernels import kernel, view
from .declarations import (
    ABSOLUTE,
    BODY,
    DISC,
    ENTER,
    FLIGHT,
    GRIP,
    GROUND,
    HALT,
    IMPACT,
    LAYOUT,
    LEAVE,
    NEVER,
    NODE,
    PATH,
    RECEIVED,
    REST,
    ROLLING,
    SLIDING,
    SPHERE,
    SPINNING,
    TAKE_OFF,
)
from .flight import landing, move, travel
from .geometry import height_above, line_below, path_y
from .receiver import departure, entrance, inside
from .restitution import collide, restitution
from .sampling import normal_tail, variate
from .sliding_rolling import Loads, Touch, law, slip_of, start

V, A = LAYOUT.scalar, LAYOUT.array

SMALLEST_JUMP = 1e-9
"""Height of a jump (m) below which even a rock without roughness stays in line motion: bouncing ends after a finite time."""
REST_SPEED = 1e-6
"""A rock that comes slower (m/s) than this to a node from which it can only climb rests there."""
STALLED = 100
"""A rock with this many events in a row within rounding of one time (wedged in an inner corner) rests there."""
_INSTANT = 1e-12
"""Time (s) between two events that counts as none."""
_STEEPEST = 0.5 * math.pi - 1e-3
"""Inclination (rad) up to which K_s may tilt a cell."""
_ORDERS = 1 << 32
"""Streams of random numbers from here on, beyond those of all trials, are orders of the strata of Latin hypercubes."""
_SAME = 1e-12
"""Turn (rad) at a node that is none."""

World = namedtuple(
    "World",
    "lines path ground radius mass ratio gravity area treatment capped absolute limit_mean limit_deviation "
    "limit_kind roughness_kind tilt_kind tail hypercube receiver left right bottom top",
)
"""Constants of a trial; ratio is I / (m r^2), area the loaded area A (m2), tail that of the truncated
normal. hypercube: trials of a Latin hypercube, or 0."""


@kernel
def inertia(w):
    """Moment of inertia in use (kg m2)."""
    if w[V.shape] == SPHERE:
        return 0.4 * w[V.mass] * w[V.radius] * w[V.radius]
    return (
        0.5 * w[V.mass] * w[V.radius] * w[V.radius]
        if w[V.shape] == DISC
        else w[V.moment_of_inertia]
    )


@kernel
def world(w, x, k):
    """The constants that follow from the parameters and the path."""
    ratio = inertia(w) / (w[V.mass] * w[V.radius] * w[V.radius])
    return World(
        view(k, k, A.lines)[0],
        view(x, k, A.path),
        view(x, k, A.ground),
        w[V.radius],
        w[V.mass],
        ratio,
        w[V.gravity],
        math.pi * w[V.radius] * w[V.radius] * w[V.area_factor],
        int(w[V.restitution_gravity]),
        w[V.tilt_cap] != 0.0,
        w[V.tilt_meaning] == ABSOLUTE,
        w[V.limit_speed_mean],
        w[V.limit_speed_deviation],
        int(w[V.limit_speed_distribution]),
        int(w[V.roughness_distribution]),
        int(w[V.tilt_distribution]),
        normal_tail(w[V.truncation]),
        int(w[V.hypercube]),
        w[V.receiver_present] != 0.0,
        w[V.receiver_left],
        w[V.receiver_right],
        w[V.receiver_bottom],
        w[V.receiver_top],
    )


# --- chance ---


@kernel
def sample(world, kind, mean, deviation, source, b):
    """The trial's next variate. source: its stream of random numbers."""
    number = b[BODY.draws]
    b[BODY.draws] = number + 1.0
    return variate(
        kind, mean, deviation, world.tail, stratified(world, number, draw(source, number), b)
    )


@kernel
def stratified(world, number, u, b):
    """The trial's uniform number ``number`` from u in [0, 1): u itself, or moved into the trial's stratum of the Latin hypercube.

    Of the ``hypercube`` trials of one hypercube each has a stratum of its own, in an order of its own for every number.
    """
    if world.hypercube == 0:
        return u
    block, member = int(b[BODY.trial]) // world.hypercube, int(b[BODY.trial]) % world.hypercube
    key = stream(int(b[BODY.seed]), _ORDERS + block)
    return (shuffled(member, world.hypercube, key + mix(np.uint64(number))) + u) / world.hypercube


@kernel
def sample_roughness(world, j, source, b):
    """R_o for the arrival on line j, between 0 and 2; it holds until the next arrival."""
    at = ground_of(world, j)
    rough = sample(
        world,
        world.roughness_kind,
        world.ground[at + GROUND.roughness],
        world.ground[at + GROUND.roughness_deviation],
        source,
        b,
    )
    b[BODY.roughness] = min(max(rough, 0.0), 2.0)


@kernel
def sample_tilt(world, j, source, b):
    """Change (rad) of the inclination of line j for an impact."""
    at = ground_of(world, j)
    tilt = sample(
        world,
        world.tilt_kind,
        world.ground[at + GROUND.tilt],
        world.ground[at + GROUND.tilt_deviation],
        source,
        b,
    )
    angle = world.path[j * len(PATH) + PATH.angle]
    turned = angle + (tilt if world.absolute else tilt * angle)
    return min(max(turned, -_STEEPEST), _STEEPEST) - angle if abs(angle) < _STEEPEST else 0.0


@kernel
def ground_of(world, j):
    """Where the material of line j begins in ``ground``."""
    return int(world.path[j * len(PATH) + PATH.cell]) * len(GROUND)


# --- start of a trial ---


@kernel
def begin(world, seed, trial, w, b):
    """The rock at its start; returns whether it starts clear of the slope (or on it)."""
    for i in range(b.size):
        b[i] = 0.0
    b[BODY.x], b[BODY.y], b[BODY.angle] = w[V.position0_x], w[V.position0_y], w[V.angle0]
    b[BODY.vx], b[BODY.vy], b[BODY.omega] = (
        w[V.velocity0_x],
        w[V.velocity0_y],
        w[V.angular_velocity0],
    )
    b[BODY.handover_time], b[BODY.seed], b[BODY.trial] = NEVER, seed, trial
    source = stream(seed, trial)
    limit = sample(world, world.limit_kind, world.limit_mean, world.limit_deviation, source, b)
    b[BODY.limit_speed] = max(limit, 0.0)
    j = line_below(b[BODY.x], world.lines, world.path)
    b[BODY.line] = j
    if w[V.on_slope] != 0.0:
        b[BODY.y] = path_y(j, b[BODY.x], world.path)
    height = height_above(j, b[BODY.x], b[BODY.y], world.path)
    if inside(world, b[BODY.x], b[BODY.y]):
        receive(b)
    else:
        b[BODY.mode] = FLIGHT
        if height <= SMALLEST_JUMP:
            settle_on_slope(world, j, source, b)
    plan(world, b)
    return height >= -SMALLEST_JUMP


@kernel
def settle_on_slope(world, j, source, b):
    """A rock that starts in contact: line motion if it moves along the cell, an impact if into it, else flight."""
    at = j * len(PATH)
    u, v = components(world, j, b)
    if v < -1e-12 * abs(u):
        strike(world, j, source, b)
    else:
        sample_roughness(world, j, source, b)
        if v * v <= 2.0 * world.gravity * world.path[at + PATH.cos] * jump_floor(world, b):
            run_along(world, j, u, b)


@kernel
def receive(b):
    """The rock is handed over now."""
    b[BODY.mode] = RECEIVED
    b[BODY.handovers] += 1.0
    b[BODY.handover_time] = b[BODY.time]


# --- frames ---


@kernel
def components(world, j, b):
    """Velocity (m/s) along line j, to the right, and along its outward normal."""
    s, c = world.path[j * len(PATH) + PATH.sin], world.path[j * len(PATH) + PATH.cos]
    return b[BODY.vx] * c - b[BODY.vy] * s, b[BODY.vx] * s + b[BODY.vy] * c


@kernel
def set_velocity(world, j, u, v, b):
    """The velocity (m/s) with these components along line j and its normal."""
    s, c = world.path[j * len(PATH) + PATH.sin], world.path[j * len(PATH) + PATH.cos]
    b[BODY.vx], b[BODY.vy] = u * c + v * s, v * c - u * s


@kernel
def jump_floor(world, b):
    """Height (m) of a jump up to which the motion stays one along the line: R_o r, eqs (30) and (31)."""
    return max(b[BODY.roughness] * world.radius, SMALLEST_JUMP)


@kernel
def kinetic(world, b):
    """Kinetic energy (J) at the last event."""
    spin = world.radius * b[BODY.omega]
    return (
        0.5
        * world.mass
        * (b[BODY.vx] * b[BODY.vx] + b[BODY.vy] * b[BODY.vy] + world.ratio * spin * spin)
    )


# --- what the rock does until the next event ---


@kernel
def run_along(world, j, u, b):
    """Line motion begins or goes on along line j with speed u (m/s, to the right), eqs (1)-(14); the mode may also be rest."""
    at, on = j * len(PATH), ground_of(world, j)
    weight = world.mass * world.gravity
    along, normal = weight * world.path[at + PATH.sin], weight * world.path[at + PATH.cos]
    drag = math.pi * world.radius * world.radius * world.ground[on + GROUND.resistance]
    s, c = math.sqrt(0.5 * b[BODY.roughness]), math.sqrt(1.0 - 0.5 * b[BODY.roughness])
    friction = world.ground[on + GROUND.friction]
    touch = Touch(world.mass, world.radius, world.ratio, friction, s, c)
    if u == 0.0:
        d, motion = start(b[BODY.omega], Loads(along, normal, drag), touch)
    else:
        d = 1.0 if u > 0.0 else -1.0
        motion = law(abs(u), d * b[BODY.omega], Loads(d * along, normal, drag), touch)
    b[BODY.line], b[BODY.mode], b[BODY.direction], b[BODY.sin], b[BODY.cos] = (
        j,
        motion.mode,
        d,
        s,
        c,
    )
    b[BODY.normal_force], b[BODY.shear_force] = motion.normal_force, motion.shear_force
    b[BODY.drag] = drag
    set_velocity(world, j, u, 0.0, b)
    b[BODY.ax], b[BODY.ay] = (
        d * motion.acceleration * world.path[at + PATH.cos],
        -d * motion.acceleration * world.path[at + PATH.sin],
    )
    b[BODY.alpha] = -d * motion.shear_force / (world.ratio * world.mass * world.radius)


@kernel
def plan(world, b):
    """Accelerations of free motion, and kind and time of the next event."""
    mode = b[BODY.mode]
    b[BODY.next_line] = b[BODY.line]
    if mode in (FLIGHT, RECEIVED):
        b[BODY.ax], b[BODY.ay], b[BODY.alpha] = 0.0, -world.gravity, 0.0
    if mode == FLIGHT:
        wait, j = landing(
            int(b[BODY.line]),
            b[BODY.x],
            b[BODY.y],
            b[BODY.vx],
            b[BODY.vy],
            world.gravity,
            world.lines,
            world.path,
        )
        event, b[BODY.next_line] = IMPACT, j
    elif mode == RECEIVED:
        event, wait = LEAVE, departure(world, b)
    elif mode == REST:
        event, wait = 0, NEVER
    else:
        event, wait = end_of_line_motion(world, b)
    if mode != RECEIVED:
        enters = entrance(world, b)
        if enters <= wait and enters < NEVER:
            event, wait = ENTER, enters
    b[BODY.next_event], b[BODY.next_time] = event, min(NEVER, b[BODY.time] + wait)


@kernel
def end_of_line_motion(world, b):
    """Kind of the event that ends a line motion, and the time (s) until then."""
    j, d = int(b[BODY.line]), b[BODY.direction]
    at = j * len(PATH)
    s, c = world.path[at + PATH.sin], world.path[at + PATH.cos]
    u, acceleration = d * (b[BODY.vx] * c - b[BODY.vy] * s), d * (b[BODY.ax] * c - b[BODY.ay] * s)
    turning, spin = d * world.radius * b[BODY.alpha], d * world.radius * b[BODY.omega]
    if b[BODY.mode] == SPINNING:
        return HALT, (-spin / turning if spin * turning < 0.0 else NEVER)
    bound = world.path[at + (PATH.right if d > 0.0 else PATH.left)]
    event, wait = NODE, travel(d * (bound - b[BODY.x]) / c, u, acceleration)
    if acceleration < 0.0 and -u / acceleration < wait:
        event, wait = HALT, -u / acceleration
    slip, rate = slip_of(u, spin), acceleration + turning
    if b[BODY.mode] == SLIDING and slip * rate < 0.0 and -slip / rate < wait:
        event, wait = GRIP, -slip / rate
    limit = take_off_speed(world, c, b)
    reaches = NEVER
    if u >= limit:
        reaches = 0.0
    elif acceleration > 0.0:
        reaches = (limit - u) / acceleration
    if reaches < wait:
        event, wait = TAKE_OFF, reaches
    return event, wait


@kernel
def take_off_speed(world, c, b):
    """Speed (m/s) at which line motion ends in a jump: V_lim, eq. (29), but at least that whose jump is none after eq. (31)."""
    rough = b[BODY.roughness]
    if rough * world.radius <= SMALLEST_JUMP:
        return NEVER
    lifted = rough * rough / (1.0 + rough * rough)
    return max(
        b[BODY.limit_speed],
        math.sqrt(2.0 * world.gravity * c * rough * world.radius / lifted) * (1.0 + 1e-9),
    )


# --- what happens ---


@kernel
def happen(world, source, b):
    """Bring the rock to its next event, let that happen, and plan what follows."""
    waited = b[BODY.next_time] - b[BODY.time]
    b[BODY.stalled] = b[BODY.stalled] + 1.0 if waited < _INSTANT else 0.0
    dissipate(world, waited, b)
    move(b, b[BODY.next_time])
    event, j, before = b[BODY.next_event], int(b[BODY.next_line]), kinetic(world, b)
    if event == ENTER:
        receive(b)
    elif event == LEAVE:
        b[BODY.mode], b[BODY.line] = FLIGHT, line_below(b[BODY.x], world.lines, world.path)
    elif b[BODY.stalled] > STALLED:
        stop(world, b)
        b[BODY.impact] += before
    elif event == IMPACT:
        touch(world, j, b)
        strike(world, j, source, b)
    elif event == NODE:
        pass_node(world, source, b)
    elif event == TAKE_OFF:
        take_off(world, b)
    else:
        change_line_motion(world, event, b)
    plan(world, b)


@kernel
def stop(world, b):
    """The rock rests where it is."""
    b[BODY.mode], b[BODY.vx], b[BODY.vy], b[BODY.omega] = REST, 0.0, 0.0, 0.0
    b[BODY.ax], b[BODY.ay], b[BODY.alpha] = 0.0, 0.0, 0.0


@kernel
def touch(world, j, b):
    """Take the rounding out of the place of an impact: the rock touches line j."""
    height = height_above(j, b[BODY.x], b[BODY.y], world.path)
    b[BODY.x] -= height * world.path[j * len(PATH) + PATH.sin]
    b[BODY.y] -= height * world.path[j * len(PATH) + PATH.cos]


@kernel
def strike(world, j, source, b):
    """Impact on line j, eqs (19)-(28), tilted by K_s; then line motion if the jump is lower than the roughness, eq. (31).

    The rock must leave the true cell: a velocity into it after the impact on the tilted one is turned along it. A tilt by which
    the rock would not even approach the tilted cell is left out.
    """
    before, at = kinetic(world, b), j * len(PATH)
    tilt = sample_tilt(world, j, source, b)
    sample_roughness(world, j, source, b)
    u, v = components(world, j, b)
    s, c = math.sin(tilt), math.cos(tilt)
    if u * s + v * c >= 0.0:
        s, c = 0.0, 1.0
    normal = max(0.0, world.path[at + PATH.cos] * c - world.path[at + PATH.sin] * s)
    tilted_u, tilted_v, omega = bounce(
        world, j, u * c - v * s, min(0.0, u * s + v * c), b[BODY.omega], world.gravity * normal
    )
    u, v = tilted_u * c + tilted_v * s, max(0.0, tilted_v * c - tilted_u * s)
    b[BODY.omega], b[BODY.mode], b[BODY.line] = omega, FLIGHT, j
    b[BODY.impacts] += 1.0
    if v * v <= 2.0 * world.gravity * world.path[at + PATH.cos] * jump_floor(world, b):
        run_along(world, j, u, b)
    else:
        set_velocity(world, j, u, v, b)
    b[BODY.impact] += before - kinetic(world, b)


@kernel
def bounce(world, j, u, v, omega, gravity):
    """Velocities after an impact in the frame of the (tilted) line; gravity: its component along the normal (m/s2)."""
    at = ground_of(world, j)
    g, d = world.ground, (1.0 if u >= 0.0 else -1.0)
    e, delta = restitution(
        -v,
        world.mass,
        world.radius,
        gravity,
        g[at + GROUND.strength],
        g[at + GROUND.stiffness],
        g[at + GROUND.hardening],
        world.area,
        world.treatment,
    )
    after_u, after_v, after_omega = collide(
        d * u,
        v,
        d * omega,
        e,
        delta,
        world.capped,
        g[at + GROUND.friction],
        world.radius,
        world.ratio,
    )
    return d * after_u, after_v, d * after_omega


@kernel
def pass_node(world, source, b):
    """From a line to the next: a jump where it is steeper, eq. (30), an impact where it is less steep, else on along it.

    Round a corner the rock is guided and keeps its speed. Of the tangents that stand for a corner each is compared with the facet
    that follows.
    """
    old, d = int(b[BODY.line]), b[BODY.direction]
    new = min(max(old + int(d), 0), world.lines - 1)
    u, _ = components(world, old, b)
    b[BODY.x] = world.path[old * len(PATH) + (PATH.right if d > 0.0 else PATH.left)]
    b[BODY.y] = path_y(old, b[BODY.x], world.path)
    at = new * len(PATH)
    turn = d * (world.path[at + PATH.angle] - world.path[old * len(PATH) + PATH.angle])
    if turn < -_SAME:
        if abs(u) < REST_SPEED and d * world.path[at + PATH.sin] <= 0.0:
            b[BODY.impact] += kinetic(world, b)
            stop(world, b)
        else:
            strike(world, new, source, b)
        return
    sample_roughness(world, new, source, b)
    ahead = d * world.path[at + (PATH.ahead_right if d > 0.0 else PATH.ahead_left)]
    away = u * math.sin(ahead - d * world.path[old * len(PATH) + PATH.angle])
    if turn > _SAME and away * away >= 2.0 * world.gravity * math.cos(ahead) * jump_floor(world, b):
        b[BODY.mode], b[BODY.line] = FLIGHT, new
    else:
        run_along(world, new, u, b)


@kernel
def take_off(world, b):
    """Jump with the angle rho = arctan(R_o) from the line, eq. (29); the speed is kept."""
    j, rough = int(b[BODY.line]), b[BODY.roughness]
    u, _ = components(world, j, b)
    length = math.sqrt(1.0 + rough * rough)
    set_velocity(world, j, u / length, abs(u) * rough / length, b)
    b[BODY.mode] = FLIGHT


@kernel
def change_line_motion(world, event, b):
    """Slip has come to its end (GRIP), or the motion, or the spin (HALT)."""
    j = int(b[BODY.line])
    u, _ = components(world, j, b)
    if event == GRIP:
        b[BODY.omega] = -u / world.radius
    elif b[BODY.mode] == SPINNING:
        b[BODY.omega] = 0.0
    else:
        u = 0.0
        if b[BODY.mode] == ROLLING:
            b[BODY.omega] = 0.0
    run_along(world, j, u, b)


# --- energy ---


@kernel
def losses(world, span, b):
    """Energies (J) that friction, roughness and resistance take in ``span`` seconds from the last event on."""
    if not ROLLING <= b[BODY.mode] <= SPINNING:
        return 0.0, 0.0, 0.0
    along = math.sqrt(b[BODY.vx] * b[BODY.vx] + b[BODY.vy] * b[BODY.vy])
    s, c = (
        world.path[int(b[BODY.line]) * len(PATH) + PATH.sin],
        world.path[int(b[BODY.line]) * len(PATH) + PATH.cos],
    )
    d = b[BODY.direction]
    way = span * (along + 0.5 * span * d * (b[BODY.ax] * c - b[BODY.ay] * s))
    turned = d * world.radius * span * (b[BODY.omega] + 0.5 * span * b[BODY.alpha])
    return (
        b[BODY.shear_force] * (way + turned),
        (b[BODY.normal_force] * b[BODY.sin] - b[BODY.shear_force] * (1.0 - b[BODY.cos])) * way,
        b[BODY.drag] * way,
    )


@kernel
def dissipate(world, span, b):
    """Book the energies that line motion takes until ``span`` seconds after the last event."""
    friction, roughness, resistance = losses(world, span, b)
    b[BODY.friction] += friction
    b[BODY.roughness_loss] += roughness
    b[BODY.resistance] += resistance
