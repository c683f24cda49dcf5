"""Experiments on the falling rock: closed forms of a rigid body under constant loads."""

import numpy as np

from rockshed.components.common.ports import Sizes
from rockshed.components.common.units import standard_gravity as _g

from .declaration import Expected, Experiment, Given, Purpose, near, rows

_MASS, _RADIUS = 4.0, 0.0495
_DT = 1e-5
"""Internal step (s) of the FMU's start values."""
_ROUNDING = 1e-9


def experiments(sizes: Sizes) -> tuple[Experiment, ...]:
    """Return the experiments.

    Parameters
    ----------
    sizes : mapping of str to int
        Of the FMU; the rock has none.
    """
    spread = [(m, r) for m in (0.9, 1.1) for r in (0.95, 1.05)]
    return (_fall(), _push(), _driven(), *(_spin(*factors) for factors in spread))


def _late(acceleration: float, stop: float) -> float:
    """Return by how far (m) the position is wrong at the end, with a tenth to spare: a dt t/2."""
    return 1.1 * abs(acceleration) * _DT * stop / 2.0


def _fall() -> Experiment:
    step, steps = 1e-3, 20
    t = rows(step, steps)
    speed = -8.0 - _g * t
    height = 1.0 - 8.0 * t - _g * t**2 / 2.0
    late = _late(_g, steps * step)
    lost = 1.1 * _MASS * _g * _DT * _g * steps * step / 2.0
    return Experiment(
        "free-fall",
        Purpose.SMOKE,
        "The rock falls from its start values without force: v = v0 - g t, y = y0 + v0 t - g t2/2. "
        "Semi-implicit Euler has the velocity to rounding, and the position off by g dt t/2.",
        step,
        steps,
        {
            "position.x": Expected(0.0, 1e-12),
            "position.y": Expected(height, late),
            "velocity.x": Expected(0.0, 1e-12),
            "velocity.y": near(speed, _ROUNDING),
            "angle": Expected(0.0, 1e-12),
            "energy.kinetic": near(_MASS * speed**2 / 2.0, _ROUNDING),
            "energy.gravity": Expected(_MASS * _g * height, _MASS * _g * late),
            "energy.work.contact": Expected(0.0, 1e-12),
            "energy.work.drive": Expected(0.0, 1e-12),
            "energy.residual": Expected(0.0, lost),
            "energy.start": near(_MASS * 64.0 / 2.0 + _MASS * _g, _ROUNDING),
        },
    )


_FORCE = (30.0, -12.0)
_TORQUE = 0.02
_PUSHED: dict[str, Given] = {
    "shape": "disc",
    "position0.x": 0.2,
    "angle0": 0.3,
    "velocity0.x": 1.5,
    "velocity0.y": 3.0,
    "angular_velocity0": 2.0,
}


def _push() -> Experiment:
    step, steps = 1e-3, 50
    t = rows(step, steps)
    inertia = _MASS * _RADIUS**2 / 2.0
    rates = np.array([_FORCE[0] / _MASS, _FORCE[1] / _MASS - _g, _TORQUE / inertia])
    start = np.array([1.5, 3.0, 2.0])
    ways = np.outer(start, t) + np.outer(rates, t**2 / 2.0)
    made = ways + np.outer(rates, _DT * t / 2.0)
    speeds = start[:, None] + np.outer(rates, t)
    loads = np.array([*_FORCE, _TORQUE])
    inertias = np.array([_MASS, _MASS, inertia])
    return Experiment(
        "push-and-turn",
        Purpose.VALIDATION,
        "A disc under constant force and torque: straight lines of the velocities, parabolas of "
        "position and angle with the a dt t/2 that semi-implicit Euler adds, and the exact work. "
        "To rounding.",
        step,
        steps,
        {
            "position.x": near(0.2 + made[0], _ROUNDING),
            "position.y": near(1.0 + made[1], _ROUNDING),
            "angle": near(0.3 + made[2], _ROUNDING),
            "velocity.x": near(speeds[0], _ROUNDING),
            "velocity.y": near(speeds[1], _ROUNDING),
            "angular_velocity": near(speeds[2], _ROUNDING),
            "energy.kinetic": near(inertias @ speeds**2 / 2.0, _ROUNDING),
            "energy.work.contact": near(loads @ ways, _ROUNDING),
        },
        _PUSHED,
        {"force.x": _FORCE[0], "force.y": _FORCE[1], "torque": _TORQUE},
    )


def _driven() -> Experiment:
    step, steps = 1e-3, 20
    t = rows(step, steps)
    contact = (-40.0 * 0.5 + 200.0 * -1.0 + 1.0 * 3.0) * t
    return Experiment(
        "driven",
        Purpose.VALIDATION,
        "A rock that a machine pushes keeps its velocities whatever acts on it: straight lines, "
        "and the machine's work is m g v t less the work of force and torque. To rounding.",
        step,
        steps,
        {
            "position.x": near(0.5 * t, _ROUNDING),
            "position.y": near(1.0 - t, _ROUNDING),
            "angle": near(3.0 * t, _ROUNDING),
            "velocity.y": near(-1.0, _ROUNDING),
            "energy.work.contact": near(contact, _ROUNDING),
            "energy.work.drive": near(-_MASS * _g * t - contact, _ROUNDING),
            "energy.residual": Expected(0.0, 1e-9),
        },
        {"motion": "driven", "velocity0.x": 0.5, "velocity0.y": -1.0, "angular_velocity0": 3.0},
        {"force.x": -40.0, "force.y": 200.0, "torque": 1.0},
    )


def _spin(heavier: float, larger: float) -> Experiment:
    step, steps = 1e-3, 20
    t = rows(step, steps)
    mass, radius = heavier * _MASS, larger * _RADIUS
    inertia = 0.4 * mass * radius**2
    return Experiment(
        f"mass-{heavier:.0%}-radius-{larger:.0%}".replace("%", ""),
        Purpose.UNCERTAINTY,
        "Mass known to 10 %, radius to 5 %: the velocity under a force goes with 1/m (spread -9 to "
        "+11 %), the spin of a sphere under a torque with 1/(m r2) (-18 to +23 %).",
        step,
        steps,
        {
            "velocity.x": near(50.0 / mass * t, _ROUNDING),
            "velocity.y": near(-8.0 - _g * t, _ROUNDING),
            "angular_velocity": near(0.1 / inertia * t, _ROUNDING),
        },
        {"mass": mass, "radius": radius},
        {"force.x": 50.0, "torque": 0.1},
    )
