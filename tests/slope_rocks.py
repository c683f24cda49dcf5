"""Rocks on slopes for the tests: without chance unless it is asked for."""

import math

import numpy as np
from numba import njit

from rockshed.components.catalogue import component
from rockshed.components.common.counter_random import stream
from rockshed.components.slope_rockfall.declarations import BODY
from rockshed.components.slope_rockfall.events import begin, happen, world
from rockshed.components.slope_rockfall.records import BARRIER, OUTCOME, PASSAGE, PEAK, ROCK
from rockshed.components.slope_rockfall.trajectory import trials

SLOPE = component("SlopeRockfall")
G = 9.80665
NO_CHANCE = {
    "limit_speed.mean": 1e6,
    "limit_speed.deviation": 0.0,
    "tilt": 0.0,
    "tilt_deviation": 0.0,
    "roughness": 0.0,
    "roughness_deviation": 0.0,
    "resistance": 0.0,
}
MODES = ("flight", "rolling", "sliding", "spinning", "rest", "received")


def slope(points, start=True, **values):
    """An instance over these nodes, without chance. Double underscores in names stand for dots."""
    points = np.asarray(points, float)
    instance = SLOPE.instance(cells=len(points) - 1)
    instance["profile.x"], instance["profile.y"] = points[0]
    instance["end.x"][:], instance["end.y"][:] = points[1:].T
    for name, value in {
        **NO_CHANCE,
        **{name.replace("__", "."): value for name, value in values.items()},
    }.items():
        if name in instance.references or isinstance(value, str):
            instance[name] = value
        else:
            instance[name][:] = value
    if start:
        instance.initialise()
    return instance


def plane(angle, speed=0.0, spin=0.0, length=1000.0, **values):
    """A rock on a plane that descends to the right by ``angle`` (rad), with this speed down the plane; spin = omega r (m/s)."""
    across, down = length * math.cos(angle), length * math.sin(angle)
    radius = values.get("radius", 0.5)
    return slope(
        [(-across, down), (across, -down)],
        on_slope=1.0,
        position0__x=0.0,
        velocity0__x=speed * math.cos(angle),
        velocity0__y=-speed * math.sin(angle),
        angular_velocity0=spin / radius,
        **values,
    )


def mode(instance):
    return MODES[int(instance["mode"]) - 1]


def along(instance, angle):
    """Speed down a plane."""
    return instance["velocity.x"] * math.cos(angle) - instance["velocity.y"] * math.sin(angle)


def run_trials(
    instance,
    count,
    first=0,
    seed=1,
    left=-1e9,
    right=1e9,
    lines=(),
    barriers=None,
    stations=0,
    station_distance=1.0,
    rocks=None,
):
    """Passages, peaks and outcomes of consecutive trials."""
    lines = np.array(lines, float).reshape(-1, 4)
    passages, peaks = (
        np.zeros((count, len(lines), len(PASSAGE))),
        np.zeros((count, stations, len(PEAK))),
    )
    outcomes = np.zeros((count, len(OUTCOME)))
    stops = (
        np.full((len(lines), len(BARRIER)), -1.0) if barriers is None else np.array(barriers, float)
    )
    trials(
        seed,
        first,
        left,
        right,
        lines,
        stops,
        instance["profile.x"],
        station_distance,
        np.empty((0, len(ROCK))) if rocks is None else rocks,
        instance.w,
        instance.x,
        instance.k,
        np.zeros(len(BODY)),
        passages,
        peaks,
        outcomes,
    )
    return passages, peaks, outcomes


# Kernels count no references to arrays (_nrt=False). A function that counted them would give back
# those that a kernel returns, which nobody took: it frees memory that is in use, and the process
# crashes somewhere, later.
_uncounted = njit(error_model="numpy", _nrt=False)


@_uncounted
def clearance(nodes, x, y, radius):
    """Distance (m) between a rock at (x, y) and the polygon; negative inside."""
    nearest = 1e30
    for i in range(len(nodes) - 1):
        dx, dy = nodes[i + 1, 0] - nodes[i, 0], nodes[i + 1, 1] - nodes[i, 1]
        share = ((x - nodes[i, 0]) * dx + (y - nodes[i, 1]) * dy) / (dx * dx + dy * dy)
        share = min(1.0, max(0.0, share))
        nearest = min(
            nearest, math.hypot(x - nodes[i, 0] - share * dx, y - nodes[i, 1] - share * dy)
        )
    return nearest - radius


@_uncounted
def deepest(nodes, radius, count, first, left, right, most_events, w, x, k, body):
    """Replay trials; smallest clearance (m) at 8 instants of every stretch, number of NaN, number of events, and that of trials
    with more than ``most_events``.
    """
    least, nans, events, endless = 1e30, 0, 0, 0
    constants, seed = world(w, x, k), 1
    for number in range(first, first + count):
        begin(constants, seed, number, w, body)
        source = stream(seed, number)
        own = 0
        while body[BODY.next_time] < 1e29 and left < body[BODY.x] < right and own < most_events:
            span = body[BODY.next_time] - body[BODY.time]
            for q in range(9):
                time = span * q / 8
                px = body[BODY.x] + time * (body[BODY.vx] + 0.5 * time * body[BODY.ax])
                py = body[BODY.y] + time * (body[BODY.vy] + 0.5 * time * body[BODY.ay])
                if left < px < right:
                    own_clearance = clearance(nodes, px, py, radius)
                    if not own_clearance > -1e300:
                        nans += 1
                    least = min(least, own_clearance)
            happen(constants, source, body)
            own += 1
        events += own
        endless += own == most_events
    return least, nans, events, endless
