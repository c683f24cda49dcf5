"""Experiments on the ground: Mogami's plate and Smith's soil, in closed form."""

import numpy as np

from rockshed.components.common.ports import Sizes

from .declaration import Expected, Experiment, Purpose, near, rows

_R0, _R1 = 5.412290134999999, 8571.0121
"""Resistance of the start values at the onset of motion and at the end (N)."""
_RADIUS, _PLATE, _DEPTH, _SAND = 0.07978845608028654, 3.14, 0.45, 1600.0
_FALLEN = 14.7
_ROUNDING = 1e-9


def experiments(sizes: Sizes) -> tuple[Experiment, ...]:
    """Return the experiments.

    Parameters
    ----------
    sizes : mapping of str to int
        Of the FMU; the ground has none.
    """
    return (
        _plate(
            "mogami-blow",
            Purpose.SMOKE,
            40.0,
            "A blow of 40 N s on the plate: M dv/dt = -R(t), R from R0 to R1 over t_f = 2 I/(R0 + "
            "R1); it stops at t_f after 2 I2 (R0 + 2 R1)/[3 M (R0 + R1)2]. To rounding.",
        ),
        _plate(
            "mogami-push",
            Purpose.VALIDATION,
            40.0,
            "The blow with 1.5 kN on the plate besides: M dv/dt = F - R(t). To rounding.",
            push=1500.0,
        ),
        _toe(),
        _wave(),
        *(_blow(impulse) for impulse in (20.0, 30.0, 50.0)),
    )


def _mass(fallen: float) -> float:
    """Return the mass (kg) of plate, fallen body and the sand that moves, for 45 degrees."""
    sand = 12.0 * _RADIUS**2 + 8.0 * _RADIUS * _DEPTH + 2.0 * _DEPTH**2
    return _PLATE + fallen + np.pi * _SAND * _DEPTH / 24.0 * sand


def _plate(
    name: str, purpose: Purpose, impulse: float, description: str, push: float = 0.0
) -> Experiment:
    """Motion after an impulse (N s) under a constant force (N), until it stops or R has risen."""
    mass = _mass(_FALLEN)
    rise = 2.0 * impulse / (_R0 + _R1)
    steps = 24
    # whole microseconds: past the end of the motion, or short of it where a force goes on pushing
    step = round(rise / 20.0 if push == 0.0 else 0.95 * rise / steps, 6)
    t = np.minimum(rows(step, steps), rise)
    speed = (impulse + (push - _R0) * t - (_R1 - _R0) * t**2 / (2.0 * rise)) / mass
    way = (impulse * t + (push - _R0) * t**2 / 2.0 - (_R1 - _R0) * t**3 / (6.0 * rise)) / mass
    start = impulse**2 / mass / 2.0
    kinetic = mass * speed**2 / 2.0
    expected = {
        "position.y": near(-way, _ROUNDING),
        "velocity.y": Expected(-speed, _ROUNDING * impulse / mass),
        "settlement": near(way, _ROUNDING),
        "virtual_mass": near(mass, _ROUNDING),
        "energy.kinetic": Expected(kinetic, _ROUNDING * start),
        "energy.plastic": Expected(start + push * way - kinetic, _ROUNDING * start),
        "energy.work.contact": Expected(push * way, _ROUNDING * start),
        "energy.start": near(start, _ROUNDING),
        "energy.residual": Expected(0.0, _ROUNDING * start),
    }
    return Experiment(
        name,
        purpose,
        description,
        step,
        steps,
        expected,
        {"impulse0": impulse, "impulse0.mass": _FALLEN, "resistance.time": rise},
        {"force.y": -push} if push else {},
    )


_QUAKE = 2.5e-3
_MOST = 2e4
"""Quake (m) and ultimate resistance (N) of Smith's soil."""
_DOWN = 8e-3
"""Time (s) after which the toe goes back."""
_TOE_SPEED = 0.5


def _toe_place(time: float) -> float:
    """Return how deep the toe is (m)."""
    return _TOE_SPEED * min(time, 2.0 * _DOWN - time)


def _toe_spring(time: float) -> float:
    """Return the static force (N) of the soil: up to the quake, along it, and back."""
    k = _MOST / _QUAKE
    if time <= _DOWN:
        return min(k * _toe_place(time), _MOST)
    return max(0.0, _MOST - k * _TOE_SPEED * (time - _DOWN))


def _toe() -> Experiment:
    """Toe that is pushed down with a constant speed and drawn back."""
    step, steps, damping = 2e-4, 50, 0.3
    t = rows(step, steps, 1)
    static, middle = np.array([(_toe_spring(s), _toe_spring(s - step / 2.0)) for s in t]).T
    factor = 1.0 + damping * np.where(t <= _DOWN * (1 + 1e-9), _TOE_SPEED, -_TOE_SPEED)
    set_ = np.maximum(_TOE_SPEED * np.minimum(t, _DOWN) - _QUAKE, 0.0)
    damped = np.cumsum(damping * _TOE_SPEED**2 * step * middle)
    scale = _ROUNDING * _MOST * _QUAKE
    return Experiment(
        "smith-toe-driven",
        Purpose.VALIDATION,
        "Smith's soil under a toe that goes down with 0.5 m/s for 8 ms and back: k s up to the "
        "quake, then R_u, then down along k, each times 1 + J v. To rounding, as the motion is "
        "made of straight lines and the quake is reached at the end of a step.",
        step,
        steps,
        {
            "toe.force": Expected(static * factor, _ROUNDING * _MOST),
            "toe.mean_force": Expected(middle * factor, _ROUNDING * _MOST),
            "permanent_set": Expected(set_, _ROUNDING * _QUAKE),
            "energy.elastic": Expected(static**2 / (2.0 * _MOST / _QUAKE), scale),
            "energy.plastic": Expected(_MOST * set_, scale),
            "energy.damping": Expected(damped, scale),
            "energy.residual": Expected(0.0, scale),
        },
        {**_smith("kinematics"), "damping": damping},
        {
            "toe.position": _toe_place,
            "toe.velocity": lambda s: _TOE_SPEED if s < _DOWN - step / 2.0 else -_TOE_SPEED,
        },
        first=1,
    )


def _smith(port: str) -> dict[str, float | str]:
    """Return the parameters of Smith's soil at a port."""
    return {"law": "smith", "port": port, "quake": _QUAKE, "ultimate_resistance": _MOST}


def _wave() -> Experiment:
    step, steps, wave, impedance = 1e-4, 50, 1.5e4, 2e4
    k = _MOST / _QUAKE
    t = rows(step, steps)
    way = wave / k * (1.0 - np.exp(-k * t / impedance))
    mean = wave - impedance * np.diff(way) / step
    return Experiment(
        "smith-wave",
        Purpose.VALIDATION,
        "A constant wave c comes down a rod of impedance Z on Smith's soil: c - Z s' = k s, so s = "
        "c/k (1 - exp(-k t/Z)), below the quake. Closed form piece by piece, to rounding.",
        step,
        steps,
        {
            "settlement": near(way[1:], 1e-7),
            "toe.force": near(k * way[1:], 1e-7),
            "toe.mean_force": near(mean, 1e-7),
            "energy.elastic": near(k * way[1:] ** 2 / 2.0, 1e-7),
        },
        _smith("wave"),
        {"toe.wave": wave, "toe.impedance": impedance},
        first=1,
    )


def _blow(impulse: float) -> Experiment:
    return _plate(
        f"impulse-{impulse:g}",
        Purpose.UNCERTAINTY,
        impulse,
        "Impulses of 20, 30 and 50 N s, each with its own t_f: settlement goes with the square of "
        "the impulse, 0.25 to 1.56 times that of 40 N s.",
    )
