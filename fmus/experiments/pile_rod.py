"""Experiments on the pile rod: travelling waves, St. Venant's ram, Smith's soil at the toe."""

import numpy as np

from rockshed.components.common.ports import Sizes
from rockshed.components.pile_rod.st_venant import StVenant

from .declaration import Expected, Experiment, Purpose, near, rows

_LENGTH, _AREA, _MODULUS, _DENSITY = 10.0, 0.00058, 205783040000.0, 7850.0
"""Rod of the start values: m, m2, Pa, kg/m3."""
_IMPEDANCE = _AREA * float(np.sqrt(_MODULUS * _DENSITY))
_TRAVEL = _LENGTH * float(np.sqrt(_DENSITY / _MODULUS))
_PARTS = 5
"""Communication steps in the travel time of a wave: 390625 ns each, which tools that count time in
whole nanoseconds can make."""
_STEP = _TRAVEL / _PARTS
_FORCE = 1e4
_ROUNDING = 1e-9


def experiments(sizes: Sizes) -> tuple[Experiment, ...]:
    """Return the experiments.

    Parameters
    ----------
    sizes : mapping of str to int
        Of the FMU. There are experiments for rods of one section, and where a communication step
        is made of whole segments.
    """
    segments = sizes["segments"]
    if sizes["sections"] != 1 or segments % _PARTS:
        return ()
    return (
        _matched(segments),
        _reflected(segments, "fixed"),
        _reflected(segments, "free"),
        _ram(segments),
        _soil(segments),
        _slipping_toe(),
        _slipping_shaft(segments),
        _repaired(),
        *(_other_rod(area) for area in (0.9, 0.95, 1.05)),
    )


def _gauge(segments: int) -> tuple[float, float]:
    """Return the depth (m) of a gauge in the middle of the rod, and when waves come there (s).

    It lies in the middle of a segment that is filled between two communication points.
    """
    number = segments // 2 - segments // _PARTS // 2 - 1
    return (number + 0.5) * _LENGTH / segments, (number + 0.5) * _TRAVEL / segments


def _matched(segments: int) -> Experiment:
    steps = 2 * _PARTS
    t = rows(_STEP, steps)
    depth, arrival = _gauge(segments)
    speed = _FORCE / _IMPEDANCE
    inside = np.minimum(t, _TRAVEL)
    power = _FORCE * speed
    return Experiment(
        "step-of-force",
        Purpose.SMOKE,
        "A force on the head of a rod whose toe lets every wave out: v = F/Z from the front on, "
        "half of the energy kinetic and half elastic, radiated from L/c on. To rounding.",
        _STEP,
        steps,
        {
            "head.velocity": near(speed, _ROUNDING),
            "head.position": near((speed * t)[1:], _ROUNDING),
            "gauge.force": Expected(np.where(t > arrival, _FORCE, 0.0)[1:], _ROUNDING * _FORCE),
            "gauge.velocity": Expected(np.where(t > arrival, speed, 0.0)[1:], _ROUNDING * speed),
            "toe.position": Expected(
                speed * np.maximum(t - _TRAVEL, 0.0)[1:], _ROUNDING * speed * _TRAVEL
            ),
            "energy.kinetic": near((power * inside / 2.0)[1:], _ROUNDING),
            "energy.elastic": near((power * inside / 2.0)[1:], _ROUNDING),
            "energy.radiated": near((power * (t - inside))[1:], _ROUNDING),
            "energy.work.head": near((power * t)[1:], _ROUNDING),
            "energy.residual": Expected(0.0, _ROUNDING * power * _TRAVEL),
            "travel_time": near(_TRAVEL, _ROUNDING),
            "head.impedance": near(_IMPEDANCE, _ROUNDING),
        },
        {"toe.condition": "matched", "gauge.depth": depth},
        {"head.force": _FORCE},
        first=1,
    )


def _reflected(segments: int, toe: str) -> Experiment:
    """Force on the head, whose wave comes back from the toe."""
    steps = 3 * _PARTS - 1
    t = rows(_STEP, steps, 1)
    depth, arrival = _gauge(segments)
    speed = _FORCE / _IMPEDANCE
    back = -1.0 if toe == "fixed" else 1.0
    there = np.where(t > arrival, 1.0, 0.0)
    returned = np.where(t > 2.0 * _TRAVEL - arrival, 1.0, 0.0)
    # at 2 L/c the wave is at the head, and is sent down again with the other sign of its force
    again = np.where(t > 2.0 * _TRAVEL + arrival, 1.0, 0.0)
    late = np.maximum(t - 2.0 * _TRAVEL, 0.0)
    force = there - back * returned + back * again
    velocity = there + back * returned + back * again
    moved = speed * (t + 2.0 * back * late)
    head = speed * np.where(t > (2.0 + 0.5 / _PARTS) * _TRAVEL, 1.0 + 2.0 * back, 1.0)
    return Experiment(
        f"{toe}-toe",
        Purpose.VALIDATION,
        f"The wave of a force on the head comes back from a {toe} toe: "
        + ("the force doubles, the velocity goes to zero. " if back < 0 else "")
        + ("the force goes to zero, the velocity doubles. " if back > 0 else "")
        + "To rounding, as waves are handed on from segment to segment unchanged.",
        _STEP,
        steps,
        {
            "gauge.force": Expected(_FORCE * force, _ROUNDING * _FORCE),
            "gauge.velocity": Expected(speed * velocity, _ROUNDING * speed),
            "head.position": near(moved, _ROUNDING),
            "head.velocity": near(head, _ROUNDING),
            "energy.work.head": near(_FORCE * moved, _ROUNDING),
            "energy.residual": Expected(0.0, _ROUNDING * _FORCE * speed * _TRAVEL),
        },
        {"toe.condition": toe, "gauge.depth": depth},
        {"head.force": _FORCE},
        first=1,
    )


def _ram(segments: int) -> Experiment:
    mass, speed = 63.5, 3.8353
    exact = StVenant(mass, speed, _IMPEDANCE, _TRAVEL, 0.5)
    # until the second reflection, before ram and rod separate
    steps = min(4 * _PARTS - 1, int((exact.separation() or 1.0) / _STEP) - 1)
    t = rows(_STEP, steps, 1)
    within = _TRAVEL / segments
    tolerance = 0.05 / segments**2
    return Experiment(
        "st-venant",
        Purpose.VALIDATION,
        "A rigid ram strikes a rod whose toe sends half of every wave back: St. Venant's problem "
        "in closed form with its reflections. The midpoint rule is of second order; at the fronts "
        "a mean over a segment's travel time is compared with a mean of two values.",
        _STEP,
        steps,
        {
            "ram.speed": Expected(exact.velocity(t * (1 - 1e-12)), tolerance * speed),
            "head.contact_force": Expected(
                (exact.force(t - within * (1 - 1e-9)) + exact.force(t * (1 - 1e-12))) / 2.0,
                tolerance * exact.first_force,
            ),
            "ram.touching": Expected(1.0, 0.0),
            "energy.ram": Expected(
                mass * exact.velocity(t * (1 - 1e-12)) ** 2 / 2.0, 2 * tolerance * mass * speed**2
            ),
            "energy.start": near(mass * speed**2 / 2.0, _ROUNDING),
            "energy.residual": Expected(0.0, _ROUNDING * mass * speed**2),
        },
        {
            "ram.mass": mass,
            "ram.velocity": speed,
            "toe.condition": "reflection",
            "toe.reflection": 0.5,
        },
        first=1,
    )


def _soil(segments: int) -> Experiment:
    steps = 3 * _PARTS - 1
    t = rows(_STEP, steps, 1)
    quake, most = 2.5e-3, 3e4
    k = most / quake
    since = np.maximum(t - _TRAVEL, 0.0)
    way = 2.0 * _FORCE / k * (1.0 - np.exp(-k * since / _IMPEDANCE))
    tolerance = 0.2 / segments**2
    # the contact force is a mean over the last internal step
    dt = _TRAVEL / segments
    mean = (
        2.0 * _FORCE
        - _IMPEDANCE
        * (way - 2.0 * _FORCE / k * (1.0 - np.exp(-k * np.maximum(since - dt, 0.0) / _IMPEDANCE)))
        / dt
    )
    mean = np.where(since >= dt / 2.0, mean, 0.0)
    return Experiment(
        "toe-on-smiths-soil",
        Purpose.VALIDATION,
        "The wave of a force on the head meets Smith's soil at the toe, without damping and below "
        "the quake: Z s' + k s = 2 F, an exponential. Of second order in the segment's length.",
        _STEP,
        steps,
        {
            "toe.position": near(way, tolerance),
            "toe.contact_force": near(mean, tolerance),
            "energy.soil": near(k * way**2 / 2.0, 2.0 * tolerance),
            "toe.set": Expected(0.0, 1e-12),
        },
        {
            "toe.condition": "soil",
            "toe.quake": quake,
            "toe.resistance": most,
            "toe.damping": 0.0,
        },
        {"head.force": _FORCE},
        first=1,
    )


_SHORTEST_QUAKE = 1e-9
"""Quake (m) of soil that slips from the first."""


def _slipping_toe() -> Experiment:
    steps, first = 3 * _PARTS - 1, _PARTS + 1
    since = rows(_STEP, steps, first) - _TRAVEL
    most, damping = 3e3, 0.5
    speed = (2.0 * _FORCE - most) / (_IMPEDANCE + damping * most)
    tolerance = 1e-5
    return Experiment(
        "slipping-toe",
        Purpose.VALIDATION,
        "The wave of a force on the head meets soil at the toe that slips from the first, with "
        "Smith's damping: 2 F = Z v + R_u (1 + J v). Off by the quake of the first step.",
        _STEP,
        steps,
        {
            "toe.velocity": near(speed, tolerance),
            "toe.position": near(speed * since, tolerance),
            "toe.contact_force": near(most * (1.0 + damping * speed), tolerance),
            "energy.damping": near(damping * most * speed**2 * since, tolerance),
            "energy.plastic": near(most * speed * since, tolerance),
        },
        {
            "toe.condition": "soil",
            "toe.quake": _SHORTEST_QUAKE,
            "toe.resistance": most,
            "toe.damping": damping,
        },
        {"head.force": _FORCE},
        first=first,
    )


def _slipping_shaft(segments: int) -> Experiment:
    parts, steps, first = 3, _PARTS + 3, _PARTS + 1
    held = parts * segments // _PARTS
    t = rows(_STEP, steps, first)
    since = t - parts * _STEP
    most, damping = 2e3, 0.3
    speed = (2.0 * _FORCE - most) / (2.0 * _IMPEDANCE + damping * most)
    tolerance = 1e-5
    resistance = np.zeros(segments)
    resistance[held - 1] = most
    return Experiment(
        "slipping-shaft",
        Purpose.VALIDATION,
        "The wave of a force on the head passes soil at the shaft of one segment that slips from "
        "the first, with Smith's damping: 2 F = 2 Z v + R_u (1 + J v). What goes on comes to a "
        "matched toe. Off by the quake of the first step.",
        _STEP,
        steps,
        {
            "toe.velocity": near(speed, tolerance),
            "toe.position": near(speed * (t - _TRAVEL), tolerance),
            "energy.damping": near(damping * most * speed**2 * since, tolerance),
            "energy.plastic": near(most * speed * since, tolerance),
        },
        {
            "toe.condition": "matched",
            "shaft.resistance": tuple(resistance),
            "shaft.quake": (_SHORTEST_QUAKE,) * segments,
            "shaft.damping": (damping,) * segments,
        },
        {"head.force": _FORCE},
        first=first,
    )


def _repaired() -> Experiment:
    steps = 2 * _PARTS
    t = rows(_STEP, steps, 2, 2)
    speed = _FORCE / _IMPEDANCE
    return Experiment(
        "masses-and-springs",
        Purpose.VALIDATION,
        "The scheme of masses and springs at its critical step, with the toe on the wave's own "
        "impedance. The mass at the head moves in every other step, twice as fast as the rod's "
        "head; after an even number of them it is where that is, to rounding.",
        _STEP,
        steps,
        {
            "head.position": near(speed * t, _ROUNDING),
            "energy.work.head": near(_FORCE * speed * t, _ROUNDING),
            "energy.residual": Expected(0.0, 1e-6 * _FORCE * speed * _TRAVEL),
        },
        {"scheme": "repaired", "toe.condition": "matched"},
        {"head.force": _FORCE},
        first=2,
        every=2,
    )


def _other_rod(area: float) -> Experiment:
    steps = 2 * _PARTS
    impedance = _IMPEDANCE * area
    t = rows(_STEP, steps, 1)
    inside = np.minimum(t, _TRAVEL)
    return Experiment(
        f"area-{100 * area:.0f}",
        Purpose.UNCERTAINTY,
        "Area known as 90 to 105 %: the impedance goes with it, so the velocity of the head has a "
        "spread of -5 to +11 %.",
        _STEP,
        steps,
        {
            "head.impedance": near(impedance, _ROUNDING),
            "travel_time": near(_TRAVEL, _ROUNDING),
            "head.velocity": near(_FORCE / impedance, _ROUNDING),
            "head.position": near(_FORCE / impedance * t, _ROUNDING),
            "energy.kinetic": near(_FORCE**2 / impedance * inside / 2.0, _ROUNDING),
        },
        {"toe.condition": "matched", "section.area": (area * _AREA,)},
        {"head.force": _FORCE},
        first=1,
    )
