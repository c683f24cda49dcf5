"""Experiments on the hammer: a ram on the wave of a rod, with and without a cushion."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.ports import Sizes
from rockshed.components.common.units import standard_gravity as _g

from .declaration import Expected, Experiment, Purpose, near, rows

_MASS, _DROP = 63.5, 0.75
_IMPEDANCE = 23311.36
"""Of a rod of 5.8 cm2 of steel (N s/m)."""
_SPEED = float(np.sqrt(2.0 * _g * _DROP))
_SECOND_ORDER = 1e-6
"""Share of the largest value by which the midpoint rule may be off with internal steps of 1e-5 s
and shorter: measured, 1e-8 for the rigid ram and 2e-7 for cushions."""

_Numbers = NDArray[np.float64]


def experiments(sizes: Sizes) -> tuple[Experiment, ...]:
    """Return the experiments.

    Parameters
    ----------
    sizes : mapping of str to int
        Of the FMU; the hammer has none.
    """
    drops = [(h, e) for h in (0.70, 0.80) for e in (0.6, 0.9)]
    return (
        _rigid(),
        _weight_and_wave(),
        _cushion(1.0),
        _cushion(0.8),
        _given_head(),
        *(_drop(*each) for each in drops),
    )


def _mean_force(speed: "_Numbers", step: float) -> "_Numbers":
    """Return the mean force (N) over each step from the ram's speed (m/s), without its weight."""
    return -_MASS * np.diff(speed) / step


def _rigid() -> Experiment:
    step, steps = 1e-4, 60
    t = rows(step, steps)
    decay = np.exp(-_IMPEDANCE * t / _MASS)
    speed = _SPEED * decay
    way = _MASS / _IMPEDANCE * (_SPEED - speed)
    energy = _MASS * speed**2 / 2.0
    return Experiment(
        "rigid-ram",
        Purpose.SMOKE,
        "A rigid ram without weight on a rod without end: F = Z V, so V = V0 exp(-Z t/M) "
        "(St. Venant). The midpoint rule is of second order in the internal step.",
        step,
        steps,
        {
            "force": near(_mean_force(speed, step), _SECOND_ORDER),
            "velocity": Expected(speed[1:], _SECOND_ORDER * _SPEED),
            "position": near(way[1:], _SECOND_ORDER),
            "head.reached": near(way[1:], _SECOND_ORDER),
            "impact_velocity": near(_SPEED, 1e-9),
            "touching": Expected(1.0, 0.0),
            "energy.kinetic": Expected(energy[1:], _SECOND_ORDER * energy[0]),
            "energy.work.head": Expected(energy[1:] - energy[0], _SECOND_ORDER * energy[0]),
            "energy.residual": Expected(0.0, 1e-8),
        },
        {"weight": 0.0},
        {"head.impedance": _IMPEDANCE},
        first=1,
    )


def _weight_and_wave() -> Experiment:
    step, steps, wave = 1e-4, 40, 3000.0
    t = rows(step, steps)
    last = (_MASS * _g + wave) / _IMPEDANCE
    decay = np.exp(-_IMPEDANCE * t / _MASS)
    speed = last + (_SPEED - last) * decay
    way = last * t + (_SPEED - last) * _MASS / _IMPEDANCE * (1.0 - decay)
    return Experiment(
        "weight-and-wave",
        Purpose.VALIDATION,
        "The ram with its weight on a rod from which a constant wave c comes: M dV/dt = M g - F, "
        "F = Z V - c, an exponential towards (M g + c)/Z. Second order in the internal step.",
        step,
        steps,
        {
            "force": near(_mean_force(speed, step) + _MASS * _g, _SECOND_ORDER),
            "velocity": near(speed[1:], _SECOND_ORDER),
            "position": near(way[1:], _SECOND_ORDER),
            "energy.gravity": near(-_MASS * _g * way[1:], _SECOND_ORDER),
            "energy.residual": Expected(0.0, 1e-8),
        },
        {},
        {"head.impedance": _IMPEDANCE, "head.wave": wave},
        first=1,
    )


@dataclass(frozen=True)
class _Compressed:
    """Compression x of the cushion: x'' + k/Z x' + k/M x = 0, from x' = v at x = 0.

    ``stiffness`` k (N/m), ``speed`` v (m/s), and a start at the compression ``at`` (m).
    """

    stiffness: float
    speed: float
    at: float = 0.0

    def __call__(self, t: "_Numbers") -> "tuple[_Numbers, _Numbers]":
        """Return x (m) and x' (m/s) at times (s) since the start."""
        damping = self.stiffness / _IMPEDANCE / 2.0
        omega = np.sqrt(self.stiffness / _MASS - damping**2)
        swung = (self.speed + damping * self.at) / omega
        decay = np.exp(-damping * t)
        sine, cosine = np.sin(omega * t), np.cos(omega * t)
        x = decay * (self.at * cosine + swung * sine)
        rate = decay * omega * (swung * cosine - self.at * sine) - damping * x
        return x, rate

    def turn(self) -> float:
        """Return the time (s) of the largest compression after a start at 0."""
        damping = self.stiffness / _IMPEDANCE / 2.0
        omega = float(np.sqrt(self.stiffness / _MASS - damping**2))
        return float(np.arctan2(omega, damping)) / omega


@dataclass(frozen=True)
class _Blow:
    """A blow through a cushion k (N/m) that unloads along k/e2, at times (s)."""

    stiffness: float
    restitution: float
    t: "_Numbers"

    def course(self) -> "dict[str, _Numbers]":
        """Return force (N), velocity (m/s) and energies (J) at the times."""
        k, e2 = self.stiffness, self.restitution**2
        loading = _Compressed(k, _SPEED)
        turn = loading.turn()
        largest = float(loading(np.array([turn]))[0][0])
        x, rate = loading(self.t)
        back, back_rate = _Compressed(k / e2, 0.0, largest * e2)(np.maximum(self.t - turn, 0.0))
        goes_in = self.t < turn
        force = np.where(goes_in, k * x, k / e2 * back)
        taken = k * np.where(goes_in, x, largest) ** 2 / 2.0
        return {
            "force": force,
            "velocity": np.where(goes_in, rate, back_rate) + force / _IMPEDANCE,
            # of what it takes a cushion can give back e2; the rest is lost when it is taken
            "stored": np.where(goes_in, e2 * taken, k / e2 * back**2 / 2.0),
            "lost": (1.0 - e2) * taken,
        }


def _cushion(restitution: float) -> Experiment:
    step, steps, k = 1e-4, 55, 2e7
    found = _Blow(k, restitution, rows(step, steps)).course()
    speed, force = found["velocity"], found["force"][1:]
    reached = _MASS / _IMPEDANCE * (_SPEED - speed)[1:]
    scale = _SECOND_ORDER * float(force.max()) ** 2 / k / 2.0
    return Experiment(
        f"cushion-restitution-{restitution:g}",
        Purpose.VALIDATION,
        "A ram without weight on a cushion (k, unloading along k/e2) on a rod without end: "
        "x'' + k/Z x' + k/M x = 0, in one piece for loading and one for unloading. Of second "
        "order in the internal step; measured, 2e-7 of the largest value.",
        step,
        steps,
        {
            "force": Expected(_mean_force(speed, step), _SECOND_ORDER * float(force.max())),
            "end_force": near(force, _SECOND_ORDER),
            "velocity": Expected(speed[1:], _SECOND_ORDER * _SPEED),
            "head.reached": near(reached, _SECOND_ORDER),
            "energy.cushion": Expected(found["stored"][1:], scale),
            "energy.cushion_loss": Expected(found["lost"][1:], scale),
            "energy.residual": Expected(0.0, 1e-8),
        },
        {"weight": 0.0, "cushion.stiffness": k, "cushion.restitution": restitution},
        {"head.impedance": _IMPEDANCE},
        first=1,
    )


def _given_head() -> Experiment:
    step, steps, k, head = 1e-4, 30, 5e7, 1.0
    t = rows(step, steps)
    omega = np.sqrt(k / _MASS)
    x = (_SPEED - head) / omega * np.sin(omega * t)
    speed = head + (_SPEED - head) * np.cos(omega * t)
    tolerance = _SECOND_ORDER
    return Experiment(
        "given-head",
        Purpose.VALIDATION,
        "Port of motions: the head moves away with a constant velocity, the cushion swings as a "
        "mass on a spring. Second order in the internal step.",
        step,
        steps,
        {
            "force": near(_mean_force(speed, step), tolerance),
            "velocity": Expected(speed[1:], tolerance * _SPEED),
            "position": near((x + head * t)[1:], tolerance),
            "energy.cushion": near(k * x[1:] ** 2 / 2.0, 2.0 * tolerance),
            "energy.residual": Expected(0.0, 1e-8),
        },
        {"port": "kinematics", "weight": 0.0, "cushion.stiffness": k},
        {"head.velocity": head, "head.position": lambda time: head * time},
        first=1,
    )


def _drop(height: float, efficiency: float) -> Experiment:
    step, steps = 1e-4, 20
    t = rows(step, steps)
    speed = np.sqrt(2.0 * _g * height * efficiency) * np.exp(-_IMPEDANCE * t / _MASS)
    return Experiment(
        f"drop-{100 * height:.0f}cm-efficiency-{100 * efficiency:.0f}",
        Purpose.UNCERTAINTY,
        "Height of fall known to 5 cm, efficiency between 0.6 and 0.9: velocity and force go with "
        "sqrt(h eta), a spread of -25 to -2 % against 0.75 m without losses.",
        step,
        steps,
        {
            "impact_velocity": near(speed[0], 1e-9),
            "force": near(_mean_force(speed, step), _SECOND_ORDER),
            "velocity": near(speed[1:], _SECOND_ORDER),
        },
        {"weight": 0.0, "drop_height": height, "efficiency": efficiency},
        {"head.impedance": _IMPEDANCE},
        first=1,
    )
