"""Whole trials without FMI, from the start to rest or to the profile's end, with their records.

A trial is a function of the prepared buffers, the seed and its number alone, so trials may be
computed in any order, on any number of threads; each needs its own ``body``.
"""

import math

from ..common.counter_random import stream
from ..common.kernels import kernel, released
from .declarations import BODY, LAYOUT, NEVER, PATH, REST
from .events import begin, happen, world
from .flight import move, passing
from .geometry import build_path, height_above, line_below
from .records import (
    ARRIVAL,
    BARRIER,
    BELOW,
    KNOT,
    OUTCOME,
    PASSAGE,
    PASSED_LEFT,
    PASSED_RIGHT,
    PEAK,
    RESTED,
    ROCK,
    STOPPED,
    UNFINISHED,
)

V, A = LAYOUT.scalar, LAYOUT.array

MOST_EVENTS = 100_000


@kernel
def trial(
    seed,
    number,
    left,
    right,
    lines,
    barriers,
    first_station,
    station_distance,
    w,
    x,
    k,
    body,
    passages,
    peaks,
    outcome,
):
    """Compute one trial from the buffers of a prepared instance (:func:`.kernel.prepare`).

    Parameters
    ----------
    seed, number : int
        Number of the sample, and of the trial in it.
    left, right : float
        x (m) at which the trial ends.
    lines : ndarray of float64, shape (n, 4)
        Search lines x1, y1, x2, y2 (m).
    barriers : ndarray of float64, shape (n, len(BARRIER))
        The search lines as barriers.
    first_station, station_distance : float
        Stations are vertical lines at x = first_station + i * station_distance (m).
    w, x, k : ndarray
        Buffers of the instance, which are not changed.
    body : ndarray of float64, shape (len(BODY),)
        Scratch.
    passages : ndarray of float64, shape (n, len(PASSAGE))
        First passages of the search lines; overwritten.
    peaks : ndarray of float64, shape (m, len(PEAK))
        Largest values at the stations; overwritten.
    outcome : ndarray of float64, shape (len(OUTCOME),)
        Columns of the trial; overwritten.
    """
    constants = world(w, x, k)
    source = stream(seed, number)
    clear_records(passages, peaks, outcome)
    outcome[OUTCOME.end] = BELOW
    if not begin(constants, seed, number, w, body):
        return
    outcome[OUTCOME.limit_speed] = body[BODY.limit_speed]
    events, end = 0, UNFINISHED
    while end == UNFINISHED and events < MOST_EVENTS:
        wait, end = stretch(left, right, body)
        until, barrier = first_stop(constants, lines, barriers, wait, body)
        if barrier >= 0:
            wait, end, outcome[OUTCOME.barrier] = until, STOPPED, barrier
            note_passage(constants, barrier, until, body, passages)
        record_lines(constants, lines, wait, body, passages)
        record_stations(constants, first_station, station_distance, wait, body, peaks)
        record_peaks(constants, wait, body, outcome)
        events += 1
        if end == UNFINISHED:
            happen(constants, source, body)
        else:
            place(wait, body, outcome)
    note_end(end, events, body, outcome)


@kernel
def note_end(end, events, b, outcome):
    """Note how the trial ends, after how many events and impacts.

    Parameters
    ----------
    end : int
        One of the ends of a trial, as RESTED.
    events : int
        Number of events.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    outcome : ndarray of float64, shape (len(OUTCOME),)
        Columns of the trial.
    """
    if end == UNFINISHED:
        place(0.0, b, outcome)
    outcome[OUTCOME.end] = end
    outcome[OUTCOME.events] = events
    outcome[OUTCOME.impacts] = b[BODY.impacts]


@kernel
def clear_records(passages, peaks, outcome):
    """Set all records to those of a rock that has not moved.

    Parameters
    ----------
    passages : ndarray of float64, shape (n, len(PASSAGE))
        First passages of the search lines.
    peaks : ndarray of float64, shape (m, len(PEAK))
        Largest values at the stations.
    outcome : ndarray of float64, shape (len(OUTCOME),)
        Columns of the trial.
    """
    for i in range(passages.shape[0]):
        for q in range(passages.shape[1]):
            passages[i, q] = 0.0
    for i in range(peaks.shape[0]):
        for q in range(peaks.shape[1]):
            peaks[i, q] = -1.0
    for q in range(outcome.size):
        outcome[q] = 0.0
    outcome[OUTCOME.barrier] = -1.0


@kernel
def stretch(left, right, b):
    """Return the time (s) from the last event to the next or to the trial's end, and its end.

    Parameters
    ----------
    left : float
        x (m) at which the trial ends on the left.
    right : float
        x (m) at which it ends on the right.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    tuple of float and int
        Time (s) and end; UNFINISHED if an event comes first.
    """
    if b[BODY.mode] == REST:
        return 0.0, RESTED
    wait, end = b[BODY.next_time] - b[BODY.time], UNFINISHED
    beyond = passing(b[BODY.x], b[BODY.vx], b[BODY.ax], right, 1.0) if b[BODY.x] <= right else 0.0
    if beyond < wait:
        wait, end = beyond, PASSED_RIGHT
    beyond = passing(b[BODY.x], b[BODY.vx], b[BODY.ax], left, -1.0) if b[BODY.x] >= left else 0.0
    if beyond < wait:
        wait, end = beyond, PASSED_LEFT
    return (0.0, RESTED) if wait >= NEVER else (wait, end)


@kernel
def at(time, b):
    """Return place (m) and velocity (m/s) ``time`` seconds after the last event.

    Parameters
    ----------
    time : float
        Time after the last event (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    tuple of float
        x, y (m), vx, vy (m/s).
    """
    return (
        b[BODY.x] + time * (b[BODY.vx] + 0.5 * time * b[BODY.ax]),
        b[BODY.y] + time * (b[BODY.vy] + 0.5 * time * b[BODY.ay]),
        b[BODY.vx] + time * b[BODY.ax],
        b[BODY.vy] + time * b[BODY.ay],
    )


@kernel
def place(wait, b, outcome):
    """Note where and when the trial ends.

    Parameters
    ----------
    wait : float
        Time from the last event on (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    outcome : ndarray of float64, shape (len(OUTCOME),)
        Columns of the trial.
    """
    outcome[OUTCOME.x], outcome[OUTCOME.y], _, _ = at(wait, b)
    outcome[OUTCOME.time] = b[BODY.time] + wait


@kernel
def energy(world, square, omega):
    """Return the kinetic energy (J) at a squared speed (m2/s2) and angular velocity (rad/s).

    Parameters
    ----------
    world : World
        Constants of the trial.
    square : float
        Squared speed (m2/s2).
    omega : float
        Angular velocity (rad/s).

    Returns
    -------
    float
        Energy (J).
    """
    spin = world.radius * omega
    return 0.5 * world.mass * (square + world.ratio * spin * spin)


@kernel
def clearance(world, x, y):
    """Return the distance (m) of a rock with its centre at (x, y) from the cell below it.

    Parameters
    ----------
    world : World
        Constants of the trial.
    x : float
        Place of the centre (m).
    y : float
        Height of the centre (m).

    Returns
    -------
    float
        Distance (m).
    """
    return height_above(line_below(x, world.lines, world.path), x, y, world.path)


# --- search lines ---


@kernel
def record_lines(world, lines, wait, b, passages):
    """Record passages of search lines within ``wait`` seconds from the last event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    lines : ndarray of float64, shape (n, 4)
        Search lines x1, y1, x2, y2 (m).
    wait : float
        Time from the last event on (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    passages : ndarray of float64, shape (n, len(PASSAGE))
        First passages of the search lines.
    """
    x0, x1 = b[BODY.x], b[BODY.x] + wait * (b[BODY.vx] + 0.5 * wait * b[BODY.ax])
    low, high = min(x0, x1), max(x0, x1)
    for i in range(lines.shape[0]):
        if max(lines[i, 0], lines[i, 2]) >= low and min(lines[i, 0], lines[i, 2]) <= high:
            for direction in (1.0, -1.0):
                time = meeting(lines[i], direction, b)
                if time < wait:
                    note_passage(world, i, time, b, passages)


@kernel
def meeting(line, direction, b):
    """Return the time (s) from the last event at which the centre passes a search line.

    Parameters
    ----------
    line : ndarray of float64, shape (4,)
        x1, y1, x2, y2 (m).
    direction : float
        1 for passing to the right of the line, -1 for passing to its left.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    float
        The time (s); NEVER if it does not.
    """
    along_x, along_y = line[2] - line[0], line[3] - line[1]
    place = (b[BODY.x] - line[0]) * along_y - (b[BODY.y] - line[1]) * along_x
    time = passing(
        place,
        b[BODY.vx] * along_y - b[BODY.vy] * along_x,
        b[BODY.ax] * along_y - b[BODY.ay] * along_x,
        0.0,
        direction,
    )
    if time >= NEVER:
        return NEVER
    x, y, _, _ = at(time, b)
    share = (x - line[0]) * along_x + (y - line[1]) * along_y
    return time if 0.0 <= share <= along_x * along_x + along_y * along_y else NEVER


@kernel
def note_passage(world, i, time, b, passages):
    """Note that the rock passes search line i ``time`` seconds after the last event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    i : int
        Number of the search line.
    time : float
        Time after the last event (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    passages : ndarray of float64, shape (n, len(PASSAGE))
        First passages of the search lines.
    """
    passages[i, PASSAGE.count] += 1.0
    absolute = b[BODY.time] + time
    if passages[i, PASSAGE.count] > 1.0 and absolute >= passages[i, PASSAGE.time]:
        return
    x, y, vx, vy = at(time, b)
    omega = b[BODY.omega] + time * b[BODY.alpha]
    passages[i, PASSAGE.time], passages[i, PASSAGE.x], passages[i, PASSAGE.y] = absolute, x, y
    passages[i, PASSAGE.height] = clearance(world, x, y)
    passages[i, PASSAGE.speed] = math.sqrt(vx * vx + vy * vy)
    passages[i, PASSAGE.vx], passages[i, PASSAGE.vy] = vx, vy
    passages[i, PASSAGE.omega] = omega
    passages[i, PASSAGE.kinetic] = energy(world, vx * vx + vy * vy, omega)


# --- barriers ---


@kernel
def first_stop(world, lines, barriers, wait, b):
    """Return when a barrier stops the rock, and the barrier's number.

    Parameters
    ----------
    world : World
        Constants of the trial.
    lines : ndarray of float64, shape (n, 4)
        Search lines x1, y1, x2, y2 (m).
    barriers : ndarray of float64, shape (n, len(BARRIER))
        The search lines as barriers.
    wait : float
        Time (s) from the last event within which it is looked for.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    tuple of float and int
        Time (s) from the last event, and number of the barrier; ``wait`` and -1 if none stops it.
    """
    number = -1
    for i in range(lines.shape[0]):
        if barriers[i, BARRIER.reach] >= 0.0:
            for direction in (1.0, -1.0):
                time = meeting(lines[i], direction, b)
                if time < wait and holds(world, lines[i], barriers[i], time, b):
                    wait, number = time, i
    return wait, number


@kernel
def holds(world, line, barrier, time, b):
    """Tell whether a barrier stops the rock that meets it ``time`` seconds after the last event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    line : ndarray of float64, shape (4,)
        Search line x1, y1, x2, y2 (m).
    barrier : ndarray of float64, shape (len(BARRIER),)
        The search line as a barrier.
    time : float
        Time after the last event (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    bool
    """
    x, y, vx, vy = at(time, b)
    away = math.sqrt((x - line[0]) * (x - line[0]) + (y - line[1]) * (y - line[1]))
    load = energy(world, vx * vx + vy * vy, b[BODY.omega] + time * b[BODY.alpha])
    return away <= barrier[BARRIER.reach] and load <= barrier[BARRIER.capacity]


# --- stations ---


@kernel
def record_stations(world, first, distance, wait, b, peaks):
    """Record the largest values at the stations that the rock passes before its next event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    first, distance : float
        Place of the first station, and distance between two (m).
    wait : float
        Time (s) from the last event on.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    peaks : ndarray of float64, shape (m, len(PEAK))
        Largest values at the stations.
    """
    count = peaks.shape[0]
    if count == 0 or (b[BODY.vx] == 0.0 and b[BODY.ax] == 0.0):
        return
    start, stop = b[BODY.x], b[BODY.x] + wait * (b[BODY.vx] + 0.5 * wait * b[BODY.ax])
    direction = 1.0 if stop >= start else -1.0
    low = max(0, math.ceil((min(start, stop) - first) / distance))
    high = min(count - 1, math.floor((max(start, stop) - first) / distance))
    if high < low:
        return
    j = line_below(first + low * distance, world.lines, world.path)
    for i in range(low, high + 1):
        place = first + i * distance
        while world.path[j * len(PATH) + PATH.right] <= place:
            j += 1
        time = min(wait, passing(start, b[BODY.vx], b[BODY.ax], place, direction))
        x, y, vx, vy = at(time, b)
        square = vx * vx + vy * vy
        peaks[i, PEAK.height] = max(peaks[i, PEAK.height], height_above(j, x, y, world.path))
        peaks[i, PEAK.speed] = max(peaks[i, PEAK.speed], math.sqrt(square))
        peaks[i, PEAK.kinetic] = max(
            peaks[i, PEAK.kinetic], energy(world, square, b[BODY.omega] + time * b[BODY.alpha])
        )


# --- largest values ---


@kernel
def record_peaks(world, wait, b, outcome):
    """Record the largest height, speed and energy until the next event.

    Speed and energy are largest at the events, the height where the rock moves parallel to a cell,
    equation (18).

    Parameters
    ----------
    world : World
        Constants of the trial.
    wait : float
        Time from the last event on (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    outcome : ndarray of float64, shape (len(OUTCOME),)
        Columns of the trial.
    """
    for time in (0.0, wait):
        _, _, vx, vy = at(time, b)
        square = vx * vx + vy * vy
        outcome[OUTCOME.speed] = max(outcome[OUTCOME.speed], math.sqrt(square))
        outcome[OUTCOME.kinetic] = max(
            outcome[OUTCOME.kinetic], energy(world, square, b[BODY.omega] + time * b[BODY.alpha])
        )
    if b[BODY.ay] == -world.gravity and wait < NEVER:
        outcome[OUTCOME.height] = max(outcome[OUTCOME.height], highest(world, wait, b))


@kernel
def highest(world, wait, b):
    """Return the largest distance (m) of a rock in flight from the cell below it.

    Parameters
    ----------
    world : World
        Constants of the trial.
    wait : float
        Time from the last event on (s).
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.

    Returns
    -------
    float
        Distance (m).
    """
    x, y, vx, vy = b[BODY.x], b[BODY.y], b[BODY.vx], b[BODY.vy]
    end = x + wait * vx
    peak = 0.0
    for j in range(
        line_below(min(x, end), world.lines, world.path),
        line_below(max(x, end), world.lines, world.path) + 1,
    ):
        at_j = j * len(PATH)
        from_time, to_time = 0.0, wait
        if vx != 0.0:
            one = (world.path[at_j + PATH.left] - x) / vx
            two = (world.path[at_j + PATH.right] - x) / vx
            from_time, to_time = max(0.0, min(one, two)), min(wait, max(one, two))
        s, c = world.path[at_j + PATH.sin], world.path[at_j + PATH.cos]
        parallel = (vx * s + vy * c) / (world.gravity * c)
        time = min(max(parallel, from_time), to_time)
        peak = max(
            peak,
            height_above(
                j, x + time * vx, y + time * (vy - 0.5 * time * world.gravity), world.path
            ),
        )
    return peak


# --- the way itself ---


@kernel
def trace(seed, number, left, right, lines, barriers, w, x, k, body, knots):
    """Compute one trial, note its events, and return their number.

    Parameters are those of :func:`trial`; a trial of more events than ``knots`` has rows is cut
    off there.

    Parameters
    ----------
    knots : ndarray of float64, shape (n, len(KNOT))
        A row for the start, each event and the end; overwritten.

    Returns
    -------
    int
        Number of rows that are used.
    """
    constants = world(w, x, k)
    source = stream(seed, number)
    if not begin(constants, seed, number, w, body):
        return 0
    count = 0
    end = UNFINISHED
    while end == UNFINISHED and count < knots.shape[0] - 1:
        note_knot(constants, body, knots[count])
        count += 1
        wait, end = stretch(left, right, body)
        until, barrier = first_stop(constants, lines, barriers, wait, body)
        if barrier >= 0:
            wait, end = until, STOPPED
        if end == UNFINISHED:
            happen(constants, source, body)
        elif wait > 0.0:
            move(body, body[BODY.time] + wait)
            note_knot(constants, body, knots[count])
            count += 1
    return count


@kernel
def note_knot(world, b, knot):
    """Note the motion of the rock at its last event.

    Parameters
    ----------
    world : World
        Constants of the trial.
    b : ndarray of float64, shape (len(BODY),)
        The rock at its last event.
    knot : ndarray of float64, shape (len(KNOT),)
        Overwritten.
    """
    knot[KNOT.time], knot[KNOT.x], knot[KNOT.y] = b[BODY.time], b[BODY.x], b[BODY.y]
    knot[KNOT.angle] = b[BODY.angle]
    knot[KNOT.vx], knot[KNOT.vy], knot[KNOT.omega] = b[BODY.vx], b[BODY.vy], b[BODY.omega]
    knot[KNOT.ax], knot[KNOT.ay], knot[KNOT.alpha] = b[BODY.ax], b[BODY.ay], b[BODY.alpha]
    knot[KNOT.mode] = b[BODY.mode]
    j = line_below(b[BODY.x], world.lines, world.path)
    knot[KNOT.cell] = world.path[j * len(PATH) + PATH.cell] + 1.0


# --- the way to the receiver ---


@kernel
def arrival(seed, number, left, right, lines, barriers, w, x, k, body, arrived):
    """Compute one trial up to its first hand-over.

    Parameters are those of :func:`trial`. What happens until then has the bits of the whole trial,
    and of the FMU.

    Parameters
    ----------
    arrived : ndarray of float64, shape (len(ARRIVAL),)
        Overwritten; all zero where the trial ends before.
    """
    arrived[:] = 0.0
    constants, source = world(w, x, k), stream(seed, number)
    if not begin(constants, seed, number, w, body):
        return
    for _ in range(MOST_EVENTS):
        if body[BODY.handovers] > 0.0:
            arrived[ARRIVAL.arrived], arrived[ARRIVAL.time] = 1.0, body[BODY.time]
            arrived[ARRIVAL.x], arrived[ARRIVAL.y] = body[BODY.x], body[BODY.y]
            arrived[ARRIVAL.vx], arrived[ARRIVAL.vy] = body[BODY.vx], body[BODY.vy]
            arrived[ARRIVAL.omega] = body[BODY.omega]
            square = body[BODY.vx] * body[BODY.vx] + body[BODY.vy] * body[BODY.vy]
            arrived[ARRIVAL.kinetic] = energy(constants, square, body[BODY.omega])
            return
        wait, end = stretch(left, right, body)
        _, barrier = first_stop(constants, lines, barriers, wait, body)
        if barrier >= 0 or end != UNFINISHED:
            return
        happen(constants, source, body)


@released
def arrivals(seed, first, left, right, lines, barriers, rocks, w, x, k, body, arrived):
    """Compute the first hand-overs of trials number ``first`` on.

    Parameters are those of :func:`arrival`, but ``arrived`` has a row for each trial; ``rocks`` is
    that of :func:`trials`.
    """
    for i in range(arrived.shape[0]):
        if rocks.shape[0] > 0:
            set_rock(rocks[i], w, x, k)
        where = (left, right, lines, barriers)
        arrival(seed, first + i, *where, w, x, k, body, arrived[i])


# --- campaigns ---


@kernel
def set_rock(rock, w, x, k):
    """Give an instance of its own another rock and start; the path is laid anew for another radius.

    Parameters
    ----------
    rock : ndarray of float64, shape (len(ROCK),)
        The rock.
    w, x, k : ndarray
        Buffers of the instance, which are changed.
    """
    is_other = w[V.radius] != rock[ROCK.radius]
    w[V.mass], w[V.radius] = rock[ROCK.mass], rock[ROCK.radius]
    w[V.moment_of_inertia], w[V.elongation] = rock[ROCK.moment_of_inertia], rock[ROCK.elongation]
    w[V.position0_x], w[V.position0_y] = rock[ROCK.x], rock[ROCK.y]
    w[V.velocity0_x], w[V.velocity0_y] = rock[ROCK.vx], rock[ROCK.vy]
    w[V.angular_velocity0], w[V.angle0] = rock[ROCK.omega], rock[ROCK.angle]
    if is_other:
        build_path(w, x, k)


@released
def trials(
    seed,
    first,
    left,
    right,
    lines,
    barriers,
    first_station,
    station_distance,
    rocks,
    w,
    x,
    k,
    body,
    passages,
    peaks,
    outcomes,
):
    """Compute trials number ``first`` on, as many as ``outcomes`` has rows.

    Parameters are those of :func:`trial`, but passages, peaks and outcomes have a row for each
    trial.

    Parameters
    ----------
    rocks : ndarray of float64, shape (trials, len(ROCK)) or (0, len(ROCK))
        Rock of each trial; then w, x and k must be the thread's own. Without rows it is that of
        the instance.
    """
    for i in range(outcomes.shape[0]):
        if rocks.shape[0] > 0:
            set_rock(rocks[i], w, x, k)
        trial(
            seed,
            first + i,
            left,
            right,
            lines,
            barriers,
            first_station,
            station_distance,
            w,
            x,
            k,
            body,
            passages[i],
            peaks[i],
            outcomes[i],
        )
