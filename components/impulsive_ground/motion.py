"""Motion of the ground in a stretch of time, for each port and law.

Quantities count downwards, loads include the preload.

Functions that move the ground change the state ``b``, add dissipated energies to ``w`` and return
the impulse of the load (N s) on the ground and its work (J), preload included. Their parameters are
the same throughout:

* ``g``: constants, :class:`Ground`;
* ``load``: c (N); ``impedance``: Z (N s/m). The load of a rod is c - Z v, a held force has Z = 0;
* ``toe``: velocity of the toe (m/s);
* ``dt``: stretch of time (s); ``left``: what is left of it (s);
* ``w``, ``b``: variables, and state at the places :data:`BODY`.
"""

from collections import namedtuple

from ..common.kernels import kernel
from ..common.smith_soil import Spring, mean_resistance, press, relax
from .declarations import BODY, LAYOUT
from .plate import slide, stop, work_of_load

V = LAYOUT.scalar

Ground = namedtuple("Ground", "mass stiffness ultimate damping r0 r1 rise contact preload")
"""Constants: mass of plate and sand (kg), k = R_u/Q (N/m), R_u (N), J (s/m), R0, R1 (N), t_f (s),
contact spring (N/m), preload (N)."""

_PIECES = 64
"""Most pieces of motion in one internal step: more means that nothing moves but rounding."""
_BISECTIONS = 60


@kernel
def resistance(g, clock):
    """Return the resistance (N) at a time (s) since the onset, (2), held from t_f on."""
    return g.r0 + (g.r1 - g.r0) * min(1.0, clock / g.rise)


# --- Mogami's plate ---


@kernel
def push_plate(g, load, impedance, dt, w, b):
    """Move the plate for dt under the load c - Z v.

    At rest it sticks until c exceeds the resistance it has reached; unloaded below R0, it begins
    anew with R0.

    Parameters
    ----------
    g : Ground
        Constants.
    load, impedance : float
        c (N) and Z (N s/m).
    dt : float
        Time (s).
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.

    Returns
    -------
    tuple of float
        Impulse (N s) and work (J) of the load.
    """
    left, impulse, work = dt, 0.0, 0.0
    for _ in range(_PIECES):
        now = resistance(g, b[BODY.clock])
        if b[BODY.velocity] <= 0.0 and load <= now:
            b[BODY.velocity] = 0.0
            if load <= g.r0:
                b[BODY.clock] = 0.0
            return impulse + load * left, work
        rising = b[BODY.clock] < g.rise
        rate = (g.r1 - g.r0) / g.rise if rising else 0.0
        span = min(left, g.rise - b[BODY.clock]) if rising else left
        v = b[BODY.velocity]
        time = stop(span, v, g.mass, load, impedance, now, rate)
        end, way, lost = slide(time, v, g.mass, load, impedance, now, rate)
        work += work_of_load(time, v, g.mass, load, impedance, now, rate)
        impulse += load * time - impedance * way
        w[V.energy_plastic] += lost
        b[BODY.velocity] = max(0.0, end) if time == span else 0.0
        b[BODY.settlement] += way
        b[BODY.clock] = (
            g.rise if rising and time == g.rise - b[BODY.clock] else b[BODY.clock] + time
        )
        left -= time
        if left <= 0.0:
            return impulse, work
    return impulse + load * left, work


@kernel
def strike_plate(g, load, impedance, dt, w, b):
    """Move the plate for dt under a rod that hands out c and Z.

    The rod only pushes: where c - Z v < 0 it leaves the plate, moves with c/Z, and strikes it again
    when the gap is closed.

    Parameters
    ----------
    g : Ground
        Constants.
    load, impedance : float
        c (N) and Z (N s/m).
    dt : float
        Time (s).
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.

    Returns
    -------
    tuple of float
        Impulse (N s) and work (J) on the toe.
    """
    left, impulse, work = dt, 0.0, 0.0
    for _ in range(_PIECES):
        if b[BODY.gap] <= 0.0 and load >= impedance * b[BODY.velocity]:
            b[BODY.gap] = 0.0
            more, done = push_plate(g, load, impedance, left, w, b)
            return impulse + more, work + done
        toe = load / impedance
        time = closing(g, toe, left, b)
        before = b[BODY.settlement]
        push_plate(g, 0.0, 0.0, time, w, b)
        b[BODY.gap] += b[BODY.settlement] - before - toe * time
        if time >= left:
            return impulse, work
        b[BODY.gap] = 0.0
        left -= time
    return impulse, work


@kernel
def closing(g, toe, left, b):
    """Return the time (s), at most ``left``, at which the toe has caught up with the free plate."""
    if free_gap(g, toe, left, b) > 0.0 or toe <= 0.0:
        return left
    before, after = 0.0, left
    for _ in range(_BISECTIONS):
        middle = 0.5 * (before + after)
        if free_gap(g, toe, middle, b) > 0.0:
            before = middle
        else:
            after = middle
    return after


@kernel
def free_gap(g, toe, time, b):
    """Return the gap (m) after a time (s) of free motion."""
    now = resistance(g, b[BODY.clock])
    rate = (g.r1 - g.r0) / g.rise if b[BODY.clock] < g.rise else 0.0
    first = min(time, g.rise - b[BODY.clock]) if b[BODY.clock] < g.rise else time
    end, way, _ = slide(
        stop(first, b[BODY.velocity], g.mass, 0.0, 0.0, now, rate),
        b[BODY.velocity],
        g.mass,
        0.0,
        0.0,
        now,
        rate,
    )
    if first < time and end > 0.0 and g.r1 > 0.0:
        rest = min(time - first, end * g.mass / g.r1)
        way += (end - 0.5 * g.r1 / g.mass * rest) * rest
    return b[BODY.gap] + way - toe * time


@kernel
def drag_plate(g, toe, dt, w, b):
    """Move the plate for dt under a spring whose other end is the toe. Semi-implicit Euler.

    Parameters
    ----------
    g : Ground
        Constants.
    toe : float
        Velocity of the toe (m/s).
    dt : float
        Time (s).
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.

    Returns
    -------
    tuple of float
        Impulse (N s) and work (J) of the spring.
    """
    before = contact_force(g, b)
    now = resistance(g, b[BODY.clock])
    v = b[BODY.velocity] + (before - now) / g.mass * dt
    if b[BODY.velocity] <= 0.0 and before <= now:
        v = 0.0
        if before <= g.r0:
            b[BODY.clock] = 0.0
    else:
        b[BODY.clock] += dt
    b[BODY.velocity] = max(0.0, v)
    way = b[BODY.velocity] * dt
    b[BODY.settlement] += way
    b[BODY.gap] += way - toe * dt
    w[V.energy_plastic] += now * way
    mean = 0.5 * (before + contact_force(g, b))
    return mean * dt, mean * toe * dt


@kernel
def contact_force(g, b):
    """Return the force (N) between toe and plate; at gap 0 it is the preload."""
    return max(0.0, g.preload - g.contact * b[BODY.gap])


# --- Smith's soil ---


@kernel
def spring_under(g, b):
    """Return the static part of the soil under the toe."""
    return Spring(b[BODY.spring], b[BODY.slack], g.stiffness, g.ultimate)


@kernel
def move_toe(g, way, w, b):
    """Move the toe by a way into the soil or out of it.

    Parameters
    ----------
    g : Ground
        Constants.
    way : float
        Way (m).
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.

    Returns
    -------
    float
        Area under the spring force (J).
    """
    b[BODY.spring], b[BODY.slack], slid, area = press(way, spring_under(g, b))
    b[BODY.settlement] += way
    w[V.energy_plastic] += g.ultimate * slid
    return area


@kernel
def lead_toe(g, toe, dt, w, b):
    """Move the toe with an imposed velocity.

    Parameters
    ----------
    g : Ground
        Constants.
    toe : float
        Velocity (m/s); the way (m) of a jump.
    dt : float
        Time (s), 0 for a jump.
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.

    Returns
    -------
    tuple of float
        Impulse (N s) and work (J) of the force on the toe.
    """
    jump = dt == 0.0
    area = move_toe(g, toe if jump else toe * dt, w, b)
    if jump:
        return 0.0, area
    factor = max(0.0, 1.0 + g.damping * toe)
    w[V.energy_damping] += (factor - 1.0) * area
    impulse = factor * (area / toe if toe != 0.0 else b[BODY.spring] * dt)
    b[BODY.velocity] = toe
    return impulse, factor * area


@kernel
def strike_soil(g, load, impedance, dt, w, b):
    """Move the toe for dt under a rod that hands out c and Z, piece by piece.

    The pieces are gap, spring and sliding. The damping is taken with the spring's mean force in the
    piece.

    Parameters
    ----------
    g : Ground
        Constants.
    load, impedance : float
        c (N) and Z (N s/m).
    dt : float
        Time (s).
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.

    Returns
    -------
    tuple of float
        Impulse (N s) and work (J) on the toe.
    """
    left, impulse, work = dt, 0.0, 0.0
    for _ in range(_PIECES):
        spring, slack = b[BODY.spring], b[BODY.slack]
        torn = spring > 0.0 and g.damping * load < -impedance
        damping = 0.0 if torn else g.damping * mean_spring(g, left, load, impedance, b)
        if torn:
            time, way, square = leave(g, load / impedance, left, spring)
        else:
            time, way, square = relax(left, load, impedance, damping, spring_under(g, b))
        area = move_toe(g, way, w, b)
        w[V.energy_damping] += -area if torn else damping * square
        impulse += load * time - impedance * way
        work += load * way - impedance * square
        left -= time
        if left <= 0.0:
            break
        arrive(g, load, slack, b)
    total = impedance + g.damping * b[BODY.spring]
    b[BODY.velocity] = (load - b[BODY.spring]) / total if b[BODY.slack] <= 0.0 else load / impedance
    return impulse, work


@kernel
def mean_spring(g, left, load, impedance, b):
    """Return the mean resistance (N) over the way of the next piece.

    The way is that with the damping at the beginning of the piece.
    """
    if g.damping == 0.0:
        return 0.0
    spring = spring_under(g, b)
    _, way, _ = relax(left, load, impedance, g.damping * spring.resistance, spring)
    return mean_resistance(way, spring)


@kernel
def arrive(g, load, slack, b):
    """Set the state to the bit where a piece ends before its time and another begins.

    The gap (``slack`` before the piece) is closed, or the spring is at R_u or at zero.
    """
    if slack > 0.0:
        b[BODY.slack] = 0.0
    elif load > g.ultimate:
        b[BODY.spring] = g.ultimate
    elif load < 0.0:
        b[BODY.spring] = 0.0


@kernel
def leave(g, toe, left, spring):
    """Return the motion of a toe that is torn away faster than the damped spring follows: no force.

    Parameters
    ----------
    g : Ground
        Constants.
    toe : float
        Velocity of the toe (m/s), negative.
    left : float
        Longest time (s).
    spring : float
        Force of the spring at the start (N).

    Returns
    -------
    tuple of float
        Time (s), way (m) and integral of v2 (m2/s), as of :func:`relax`.
    """
    time = min(left, spring / (-toe * g.stiffness))
    return time, toe * time, toe * toe * time


@kernel
def load_plate_on_soil(g, load, dt, w, b):
    """Move a plate with the virtual mass on Smith's soil for dt.

    The mean velocity u satisfies 2 M (u - v)/dt = load - mean force over the way u dt. Energy is
    kept to the bits of the root.

    Parameters
    ----------
    g : Ground
        Constants.
    load : float
        Held force (N).
    dt : float
        Time (s).
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.

    Returns
    -------
    tuple of float
        Impulse (N s) and work (J) of the load.
    """
    inertia = 2.0 * g.mass / dt
    free = b[BODY.velocity] + load / inertia
    u = mean_velocity(g, free, inertia, dt, b)
    mean = mean_resistance(u * dt, spring_under(g, b))
    move_toe(g, u * dt, w, b)
    w[V.energy_damping] += (max(0.0, 1.0 + g.damping * u) - 1.0) * mean * u * dt
    b[BODY.velocity] = 2.0 * u - b[BODY.velocity]
    return load * dt, load * u * dt


@kernel
def mean_velocity(g, free, inertia, dt, b):
    """Return the root u of inertia (u - free) + mean force(u) = 0.

    The left side rises with u: the root is enclosed by two bounds, which regula falsi (Illinois)
    narrows.

    Parameters
    ----------
    g : Ground
        Constants.
    free : float
        Mean velocity without the soil (m/s).
    inertia : float
        2 M/dt (kg/s).
    dt : float
        Time (s).
    b : ndarray of float64
        State at the places :data:`BODY`.

    Returns
    -------
    float
        u (m/s).
    """
    high, low = free, free - excess(g, free, free, inertia, dt, b) / inertia
    above, below = excess(g, high, free, inertia, dt, b), excess(g, low, free, inertia, dt, b)
    side = 0
    for _ in range(200):
        if above - below <= 0.0 or high <= low:
            break
        u = (low * above - high * below) / (above - below)
        value = excess(g, u, free, inertia, dt, b)
        if value == 0.0 or u <= low or u >= high:
            return u
        if value > 0.0:
            high, above = u, value
            below = 0.5 * below if side == 1 else below
            side = 1
        else:
            low, below = u, value
            above = 0.5 * above if side == -1 else above
            side = -1
    return 0.5 * (low + high)


@kernel
def excess(g, u, free, inertia, dt, b):
    """Return inertia (u - free) + mean force of the soil (N), whose root is the mean velocity."""
    mean = mean_resistance(u * dt, spring_under(g, b))
    return inertia * (u - free) + mean * max(0.0, 1.0 + g.damping * u)
