"""From event to event: what the rock does until the next one, and what happens there.

Equations (29)-(31) of Ushiro. The state at an event decides everything up to the next; nothing is
accumulated in between. So a trial is the same whoever asks for it, and however often outputs are
read on the way.
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
    ELLIPSE,
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
from .restitution import Approach, collide, rebound_by_coefficients, restitution, slowing
from .sampling import normal_tail, variate
from .shape import ellipse_contact
from .sliding_rolling import Loads, Touch, law, slip_of, start

V, A = LAYOUT.scalar, LAYOUT.array

SMALLEST_JUMP = 1e-9
"""Height of a jump (m) below which even a rock without roughness stays in line motion: bouncing
ends after a finite time."""
REST_SPEED = 1e-6
"""A rock that comes slower (m/s) than this to a node from which it can only climb rests there."""
STALLED = 100
"""A rock with this many events in a row within rounding of one time (wedged in an inner corner)
rests there."""
_INSTANT = 1e-12
"""Time (s) between two events that counts as none."""
_STEEPEST = 0.5 * math.pi - 1e-3
"""Inclination (rad) up to which K_s may tilt a cell."""
_ORDERS = 1 << 32
"""Streams of random numbers from here on, beyond those of all trials, are orders of the strata of
Latin hypercubes."""
_SAME = 1e-12
"""Turn (rad) at a node that is none."""

World = namedtuple(
    "World",
    "lines path ground radius mass ratio gravity area treatment capped absolute limit_mean "
    "limit_deviation limit_kind roughness_kind tilt_kind tail hypercube receiver left right "
    "bottom top elongation",
)
"""Constants of a trial; ratio is I / (m r^2), area the loaded area A (m2), tail that of the
truncated normal. hypercube: trials of a Latin hypercube, or 0. elongation: a / b of an ellipse,
1 for any other shape."""


@kernel
def inertia(w):
    """Return the moment of inertia in use (kg m2).

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        Moment of inertia (kg m2).
    """
    if w[V.shape] == SPHERE:
        return 0.4 * w[V.mass] * w[V.radius] * w[V.radius]
    if w[V.shape] == ELLIPSE:
        longer = w[V.elongation] + 1.0 / w[V.elongation]
        return 0.2 * w[V.mass] * w[V.radius] * w[V.radius] * longer
    return (
        0.5 * w[V.mass] * w[V.radius] * w[V.radius]
        if w[V.shape] == DISC
        else w[V.moment_of_inertia]
    )


@kernel
def world(w, x, k):
    """Return the :class:`World`: constants that follow from the parameters and the path.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    World
    """
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
        w[V.elongation] if w[V.shape] == ELLIPSE else 1.0,
    )


# --- chance ---


@kernel
def sample(world, kind, mean, deviation, source, b):
    """Return the trial's next variate of a distribution, and count it.

    Parameters
    ----------
    world : World
        Constants of the trial.
    kind : int
        NORMAL, UNIFORM, LOGNORMAL or TRIANGULAR.
    mean, deviation : float
        Mean and standard deviation, in the unit of the variate.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock; ``draws`` grows by one.

    Returns
    -------
    float
        The variate.
    """
    number = b[BODY.draws]
    b[BODY.draws] = number + 1.0
    return variate(
        kind, mean, deviation, world.tail, stratified(world, number, draw(source, number), b)
    )


@kernel
def stratified(world, number, u, b):
    """Return u, or u moved into the trial's stratum of the Latin hypercube.

    Of the ``hypercube`` trials of one hypercube each has a stratum of its own, in an order of its
    own for every number.

    Parameters
    ----------
    world : World
        Constants of the trial.
    number : float
        Which of the trial's random numbers it is, from 0.
    u : float
        Uniform number in [0, 1).
    b : ndarray of float64, shape (len(BODY),)
        The rock.

    Returns
    -------
    float
        Uniform number in [0, 1).
    """
    if world.hypercube == 0:
        return u
    block, member = int(b[BODY.trial]) // world.hypercube, int(b[BODY.trial]) % world.hypercube
    key = stream(int(b[BODY.seed]), _ORDERS + block)
    return (shuffled(member, world.hypercube, key + mix(np.uint64(number))) + u) / world.hypercube


@kernel
def sample_roughness(world, j, source, b):
    """Draw R_o for the arrival on line j, between 0 and 2; it holds until the next arrival.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
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
    """Return the change (rad) of the inclination of line j for an impact.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    float
        Change of the inclination (rad).
    """
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
    """Return where the material of line j begins in ``ground``.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.

    Returns
    -------
    int
    """
    return int(world.path[j * len(PATH) + PATH.cell]) * len(GROUND)


# --- start of a trial ---


@kernel
def begin(world, seed, trial, w, b):
    """Put the rock to its start and plan its first event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    seed, trial : int
        Number of the sample, and of the trial in it.
    w : ndarray of float64
        Parameters.
    b : ndarray of float64, shape (len(BODY),)
        The rock; overwritten.

    Returns
    -------
    bool
        Whether it starts clear of the slope or on it.
    """
    for i in range(b.size):
        b[i] = 0.0
    b[BODY.x], b[BODY.y], b[BODY.angle] = w[V.position0_x], w[V.position0_y], w[V.angle0]
    b[BODY.vx], b[BODY.vy] = w[V.velocity0_x], w[V.velocity0_y]
    b[BODY.omega] = w[V.angular_velocity0]
    b[BODY.handover_time] = NEVER
    b[BODY.seed], b[BODY.trial] = seed, trial
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
    """Start a rock that touches line j.

    It begins line motion if it moves along the line, strikes if it moves into it, and else flies.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
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
    """Hand the rock over at its last event.

    Parameters
    ----------
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
    b[BODY.mode] = RECEIVED
    b[BODY.handovers] += 1.0
    b[BODY.handover_time] = b[BODY.time]


# --- frames ---


@kernel
def components(world, j, b):
    """Return the velocity (m/s) along line j, to the right, and along its outward normal.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    tuple of float
        Along the line and along its normal (m/s).
    """
    s, c = world.path[j * len(PATH) + PATH.sin], world.path[j * len(PATH) + PATH.cos]
    return b[BODY.vx] * c - b[BODY.vy] * s, b[BODY.vx] * s + b[BODY.vy] * c


@kernel
def set_velocity(world, j, u, v, b):
    """Set the velocity (m/s) from its components u along line j and v along its normal.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    u : float
        Velocity along the line, to the right (m/s).
    v : float
        Velocity along its outward normal (m/s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
    s, c = world.path[j * len(PATH) + PATH.sin], world.path[j * len(PATH) + PATH.cos]
    b[BODY.vx], b[BODY.vy] = u * c + v * s, v * c - u * s


@kernel
def jump_floor(world, b):
    """Return the height (m) of a jump up to which the motion stays one along the line.

    It is R_o r, equations (30) and (31).

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    float
        Height (m).
    """
    return max(b[BODY.roughness] * world.radius, SMALLEST_JUMP)


@kernel
def kinetic(world, b):
    """Return the kinetic energy (J) at the last event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    float
        Energy (J).
    """
    spin = world.radius * b[BODY.omega]
    return (
        0.5
        * world.mass
        * (b[BODY.vx] * b[BODY.vx] + b[BODY.vy] * b[BODY.vy] + world.ratio * spin * spin)
    )


# --- what the rock does until the next event ---


@kernel
def run_along(world, j, u, b):
    """Begin line motion along line j, or go on with it, equations (1)-(14).

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    u : float
        Speed along it, to the right (m/s).
    b : ndarray of float64, shape (len(BODY),)
        The rock; its mode becomes rolling, sliding, spinning or rest.
    """
    at = j * len(PATH)
    on = ground_of(world, j)
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
    b[BODY.line] = j
    b[BODY.mode] = motion.mode
    b[BODY.direction] = d
    b[BODY.sin], b[BODY.cos] = s, c
    b[BODY.normal_force], b[BODY.shear_force] = motion.normal_force, motion.shear_force
    b[BODY.drag] = drag
    set_velocity(world, j, u, 0.0, b)
    b[BODY.ax] = d * motion.acceleration * world.path[at + PATH.cos]
    b[BODY.ay] = -d * motion.acceleration * world.path[at + PATH.sin]
    b[BODY.alpha] = -d * motion.shear_force / (world.ratio * world.mass * world.radius)


@kernel
def plan(world, b):
    """Set the accelerations of free motion, and kind and time of the next event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
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
        event = IMPACT
        b[BODY.next_line] = j
    elif mode == RECEIVED:
        event = LEAVE
        wait = departure(world, b)
    elif mode == REST:
        event = 0
        wait = NEVER
    else:
        event, wait = end_of_line_motion(world, b)
    if mode != RECEIVED:
        enters = entrance(world, b)
        if enters <= wait and enters < NEVER:
            event = ENTER
            wait = enters
    b[BODY.next_event] = event
    b[BODY.next_time] = min(NEVER, b[BODY.time] + wait)


@kernel
def end_of_line_motion(world, b):
    """Return the kind of the event that ends a line motion, and the time (s) until then.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    tuple of int and float
        Event, and time from the last one (s).
    """
    d = b[BODY.direction]
    at = int(b[BODY.line]) * len(PATH)
    s, c = world.path[at + PATH.sin], world.path[at + PATH.cos]
    u, acceleration = d * (b[BODY.vx] * c - b[BODY.vy] * s), d * (b[BODY.ax] * c - b[BODY.ay] * s)
    turning, spin = d * world.radius * b[BODY.alpha], d * world.radius * b[BODY.omega]
    if b[BODY.mode] == SPINNING:
        return HALT, (-spin / turning if spin * turning < 0.0 else NEVER)
    bound = world.path[at + (PATH.right if d > 0.0 else PATH.left)]
    event = NODE
    wait = travel(d * (bound - b[BODY.x]) / c, u, acceleration)
    if acceleration < 0.0 and -u / acceleration < wait:
        event = HALT
        wait = -u / acceleration
    slip = slip_of(u, spin)
    rate = acceleration + turning
    if b[BODY.mode] == SLIDING and slip * rate < 0.0 and -slip / rate < wait:
        event = GRIP
        wait = -slip / rate
    limit = take_off_speed(world, c, b)
    reaches = NEVER
    if u >= limit:
        reaches = 0.0
    elif acceleration > 0.0:
        reaches = (limit - u) / acceleration
    if reaches < wait:
        return TAKE_OFF, reaches
    return event, wait


@kernel
def take_off_speed(world, c, b):
    """Return the speed (m/s) at which line motion ends in a jump.

    It is V_lim, equation (29), but at least that whose jump is none after equation (31).

    Parameters
    ----------
    world : World
        Constants of the trial.
    c : float
        Cosine of the line's inclination.
    b : ndarray of float64, shape (len(BODY),)
        The rock.

    Returns
    -------
    float
        Speed (m/s); NEVER on ground without roughness.
    """
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
    """Bring the rock to its next event, let that happen, and plan what follows.

    Parameters
    ----------
    world : World
        Constants of the trial.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
    waited = b[BODY.next_time] - b[BODY.time]
    b[BODY.stalled] = b[BODY.stalled] + 1.0 if waited < _INSTANT else 0.0
    dissipate(world, waited, b)
    move(b, b[BODY.next_time])
    event = b[BODY.next_event]
    j = int(b[BODY.next_line])
    before = kinetic(world, b)
    if event == ENTER:
        receive(b)
    elif event == LEAVE:
        b[BODY.mode] = FLIGHT
        b[BODY.line] = line_below(b[BODY.x], world.lines, world.path)
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
    """Let the rock rest where it is.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
    b[BODY.mode] = REST
    b[BODY.vx], b[BODY.vy], b[BODY.omega] = 0.0, 0.0, 0.0
    b[BODY.ax], b[BODY.ay], b[BODY.alpha] = 0.0, 0.0, 0.0


@kernel
def touch(world, j, b):
    """Take the rounding out of the place of an impact: the rock touches line j.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
    height = height_above(j, b[BODY.x], b[BODY.y], world.path)
    b[BODY.x] -= height * world.path[j * len(PATH) + PATH.sin]
    b[BODY.y] -= height * world.path[j * len(PATH) + PATH.cos]


@kernel
def strike(world, j, source, b):
    """Let the rock strike line j, tilted by K_s, equations (19)-(28).

    Line motion follows if the jump is lower than the roughness, equation (31). The rock must leave
    the true cell: a velocity into it after the impact on the tilted one is turned along it. A tilt
    by which the rock would not even approach the tilted cell is left out.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock.
    """
    before = kinetic(world, b)
    at = j * len(PATH)
    tilt, lever = contact(world, j, source, b)
    u, v = components(world, j, b)
    s, c = math.sin(tilt), math.cos(tilt)
    if u * s + v * c >= 0.0:
        s, c, lever = 0.0, 1.0, world.radius
    normal = max(0.0, world.path[at + PATH.cos] * c - world.path[at + PATH.sin] * s)
    tilted = Approach(
        u * c - v * s, min(0.0, u * s + v * c), b[BODY.omega], world.gravity * normal, lever
    )
    tilted_u, tilted_v, omega = bounce(world, j, tilted)
    u = tilted_u * c + tilted_v * s
    v = max(0.0, tilted_v * c - tilted_u * s)
    b[BODY.omega] = omega
    b[BODY.mode] = FLIGHT
    b[BODY.line] = j
    b[BODY.impacts] += 1.0
    if v * v <= 2.0 * world.gravity * world.path[at + PATH.cos] * jump_floor(world, b):
        run_along(world, j, u, b)
    else:
        set_velocity(world, j, u, v, b)
    b[BODY.impact] += before - kinetic(world, b)


@kernel
def contact(world, j, source, b):
    """Return by how much the surface is turned at an impact, and the lever arm of the contact.

    K_s turns the cell, the undulation S turns it by an angle uniform in +-arctan(S / r) (Pfeiffer
    and Bowen 1989), and an ellipse touches the ground beside the foot of its centre.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event; R_o is drawn too.

    Returns
    -------
    tuple of float
        Angle (rad), positive where the surface descends to the right more steeply, and distance
        (m) of the contact point from the centre.
    """
    tilt = sample_tilt(world, j, source, b)
    sample_roughness(world, j, source, b)
    lean = undulation(world, j, source, b)
    lever = world.radius
    angle = world.path[j * len(PATH) + PATH.angle]
    if world.elongation > 1.0:
        lever, side = ellipse_contact(world.radius, world.elongation, b[BODY.angle] + angle)
        lean -= side
    if lean == 0.0 or abs(angle) >= _STEEPEST:
        return tilt, lever
    return min(max(angle + tilt + lean, -_STEEPEST), _STEEPEST) - angle, lever


@kernel
def undulation(world, j, source, b):
    """Return by how much the undulation of line j turns its surface (rad) at an impact.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event; a number is drawn only where there is an undulation.

    Returns
    -------
    float
        Angle (rad).
    """
    height = world.ground[ground_of(world, j) + GROUND.undulation]
    if height == 0.0:
        return 0.0
    number = b[BODY.draws]
    b[BODY.draws] = number + 1.0
    u = stratified(world, number, draw(source, number), b)
    return (2.0 * u - 1.0) * math.atan(height / world.radius)


@kernel
def bounce(world, j, tilted):
    """Return the velocities after an impact, in the frame of the (turned) line.

    Parameters
    ----------
    world : World
        Constants of the trial.
    j : int
        Line of the path.
    tilted : Approach
        Motion before it in that frame.

    Returns
    -------
    tuple of float
        u, v (m/s) and omega (rad/s) after it.
    """
    at = ground_of(world, j)
    g = world.ground
    ratio = world.ratio
    if tilted.lever != world.radius:
        ratio *= world.radius * world.radius / (tilted.lever * tilted.lever)
    if g[at + GROUND.by_coefficients] != 0.0:
        normal = g[at + GROUND.normal_restitution] / slowing(tilted.v, g[at + GROUND.scaling_speed])
        return rebound_by_coefficients(tilted, normal, g[at + GROUND.tangential_restitution], ratio)
    d = 1.0 if tilted.u >= 0.0 else -1.0
    e, delta = restitution(
        -tilted.v,
        world.mass,
        world.radius,
        tilted.gravity,
        g[at + GROUND.strength],
        g[at + GROUND.stiffness],
        g[at + GROUND.hardening],
        world.area,
        world.treatment,
    )
    after_u, after_v, after_omega = collide(
        d * tilted.u,
        tilted.v,
        d * tilted.omega,
        e,
        min(delta, 2.0 * tilted.lever),
        world.capped,
        g[at + GROUND.friction],
        tilted.lever,
        ratio,
    )
    return d * after_u, after_v, d * after_omega


@kernel
def pass_node(world, source, b):
    """Pass from a line to the next.

    The rock jumps where the next one is steeper, equation (30), strikes where it is less steep, and
    else goes on along it. Round a corner the rock is guided and keeps its speed. Of the tangents
    that stand for a corner each is compared with the facet that follows.

    Parameters
    ----------
    world : World
        Constants of the trial.
    source : int
        Stream of random numbers of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
    old = int(b[BODY.line])
    d = b[BODY.direction]
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
        b[BODY.mode] = FLIGHT
        b[BODY.line] = new
    else:
        run_along(world, new, u, b)


@kernel
def take_off(world, b):
    """Jump with the angle rho = arctan(R_o) from the line, eq. (29); the speed is kept.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
    j = int(b[BODY.line])
    rough = b[BODY.roughness]
    u, _ = components(world, j, b)
    length = math.sqrt(1.0 + rough * rough)
    set_velocity(world, j, u / length, abs(u) * rough / length, b)
    b[BODY.mode] = FLIGHT


@kernel
def change_line_motion(world, event, b):
    """Go on after the end of slip (GRIP), or of the motion or the spin (HALT).

    Parameters
    ----------
    world : World
        Constants of the trial.
    event : int
        Event that ends the motion: GRIP or HALT.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
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
    """Return the energies (J) that line motion takes in ``span`` seconds from the last event on.

    Parameters
    ----------
    world : World
        Constants of the trial.
    span : float
        Time after the last event (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    tuple of float
        Those that friction, roughness and resistance take (J).
    """
    if not ROLLING <= b[BODY.mode] <= SPINNING:
        return 0.0, 0.0, 0.0
    along = math.sqrt(b[BODY.vx] * b[BODY.vx] + b[BODY.vy] * b[BODY.vy])
    at = int(b[BODY.line]) * len(PATH)
    s, c = world.path[at + PATH.sin], world.path[at + PATH.cos]
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
    """Book the energies that line motion takes until ``span`` seconds after the last event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    span : float
        Time after the last event (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    """
    friction, roughness, resistance = losses(world, span, b)
    b[BODY.friction] += friction
    b[BODY.roughness_loss] += roughness
    b[BODY.resistance] += resistance
