"""Experiments on the beam: the chain of discs at rest and swinging, by its own closed forms."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.ports import Sizes
from rockshed.components.common.units import standard_gravity as _g

from .declaration import Expected, Experiment, Purpose, near, rows

_SPAN, _AREA, _SECOND, _DENSITY = 1.2, 0.001185, 1.87e-06, 7850.0
_HEIGHT = 0.1
_MODULUS = 205939650000.0
_EI, _EA = _MODULUS * _SECOND, _MODULUS * _AREA
_LINE_MASS = _DENSITY * _AREA
_WEIGHT = _LINE_MASS * _g
_FEWEST, _MOST = 8, 120
"""Numbers of discs with experiments: what the walls' closed form is known for, and small files."""

_Numbers = NDArray[np.float64]


def experiments(sizes: Sizes) -> tuple[Experiment, ...]:
    """Return the experiments.

    Parameters
    ----------
    sizes : mapping of str to int
        Of the FMU. There are experiments for beams of 8 to 120 discs on two supports.
    """
    elements = sizes["elements"]
    if sizes["support_count"] != 2 or not _FEWEST <= elements <= _MOST:
        return ()
    chain = _Chain(elements)
    return (
        _own_weight(chain),
        _fixed(chain),
        _sudden_load(chain, 0.0, 0.0),
        _sudden_load(chain, 200.0, 2e-6 * chain.coarseness),
        _pull(chain),
        _supports(chain),
        *(
            _stiffness(chain, modulus, height)
            for modulus in (0.97, 1.03)
            for height in (0.95, 1.05)
        ),
    )


@dataclass(frozen=True)
class _Chain:
    """The chain of N discs on simple supports, and its modes sin(n pi (i - 1/2)/N)."""

    elements: int

    @property
    def spacing(self) -> float:
        """Distance from disc to disc, which is their diameter too (m)."""
        return _SPAN / self.elements

    @property
    def coarseness(self) -> float:
        """Share (at most 1) by which internal step and damping follow the highest frequency.

        That grows with N2: 48 discs are stable with 0.2 microseconds and 2 of damping.
        """
        return 1.0 / float(np.ceil((self.elements / 48) ** 2))

    @property
    def internal_step(self) -> float:
        """Internal step (s) of the experiments in time, a whole part of their steps."""
        return 2e-7 * self.coarseness

    @property
    def step_at_rest(self) -> float:
        """Internal step (s) of the experiments at rest: that of the start values to 48 discs."""
        return 1e-6 * self.coarseness

    @property
    def places(self) -> _Numbers:
        """Distance of each disc from the left support (m)."""
        return (np.arange(self.elements, dtype=np.float64) + 0.5) * self.spacing

    @property
    def middle(self) -> _Numbers:
        """Share of each disc in what is told for midspan."""
        found = np.zeros(self.elements)
        for number in ((self.elements - 1) // 2, self.elements // 2):
            found[number] += 0.5
        return found

    @property
    def bends(self) -> _Numbers:
        """Curvature of each mode per amplitude: 4 sin2(n pi/2N)/R2 (1/m2)."""
        n = np.arange(1, self.elements + 1)
        return np.square(2.0 / self.spacing * np.sin(n * np.pi / (2 * self.elements)))

    @property
    def modes(self) -> _Numbers:
        """Shape of each mode, a row each."""
        n = np.arange(1, self.elements + 1)[:, None]
        return np.sin(n * np.pi * (np.arange(self.elements) + 0.5) / self.elements)

    def deflection_factor(self) -> float:
        """Return the deflection under an even load over that of the continuous beam."""
        n2 = float(self.elements) ** 2
        return 1 + 2 / n2 + 9 / (5 * n2**2) if self.elements % 2 else 1 + 4 / (5 * n2)

    def even_moment(self, load: float) -> _Numbers:
        """Return the moment (N m) at each disc under an even load (N/m)."""
        x = self.places
        return load * x * (_SPAN - x) / 2.0 + load * self.spacing**2 / 8.0


def _swing(omega: _Numbers, decay: _Numbers, h: float, t: _Numbers) -> _Numbers:
    """Return 1 - cos(omega t) with damping, a row for each time, a column for each mode.

    It is that of semi-implicit Euler with internal steps ``h`` (s), which is exact: e(k) of
    e(k+1) - (2 - a h - omega2 h2) e(k) + (1 - a h) e(k-1) = 0 from e(0) = e(-1) = 1 on. Its
    frequency is 2/h asin(omega h/2) without damping, and it lags half an internal step.
    """
    kept = np.asarray(1.0 - decay * h, np.complex128)
    half = (1.0 + kept - np.square(omega * h)) / 2.0
    root = np.sqrt(half**2 - kept)
    one, other = half + root, half - root
    steps = np.rint(t / h)[:, None]
    left = (other - 1.0) * one ** (steps + 1) - (one - 1.0) * other ** (steps + 1)
    return np.asarray(1.0 - np.real(left / (other - one)), np.float64)


def _own_weight(chain: _Chain) -> Experiment:
    step, steps = 1e-4, 20
    count = steps + 1
    moment = chain.even_moment(_WEIGHT)
    sag = 5.0 * _WEIGHT * _SPAN**4 / (384.0 * _EI) * chain.deflection_factor()
    at_middle = float(moment @ chain.middle)
    tolerance = 1e-7
    return Experiment(
        "own-weight",
        Purpose.SMOKE,
        "The beam under its own weight on simple supports starts at rest and stays there: 5 q "
        "L4/384 EI with the chain's own term in 1/N2, moments q x (L - x)/2 with theirs. To "
        "rounding, and what rounding makes swing.",
        step,
        steps,
        {
            "midspan.deflection": near(sag, tolerance),
            "midspan.moment": near(at_middle, tolerance),
            "midspan.strain": near(at_middle * _HEIGHT / (2.0 * _EI), tolerance),
            "moment": near(np.tile(moment, (count, 1)), tolerance),
            "support.force.y": near(np.full((count, 2), -_WEIGHT * _SPAN / 2.0), tolerance),
            "transmitted_force": Expected(0.0, 1e-9),
            "energy.kinetic": Expected(0.0, 1e-9),
            "energy.residual": Expected(0.0, 1e-9),
        },
        {"gravity": _g, "internal_step": chain.step_at_rest},
    )


def _fixed(chain: _Chain) -> Experiment:
    step, steps = 1e-4, 5
    for_deflection, for_moments = 8.0 / chain.elements**2, 3.0 / chain.elements**2
    return Experiment(
        "fixed-ends",
        Purpose.VALIDATION,
        "The beam under its own weight with both ends held: -q L2/12 at the walls, q L2/24 and q "
        "L4/384 EI in the middle. The chain differs by 7/N2 in the deflection and 2/N2 in moments "
        "at most (measured).",
        step,
        steps,
        {
            "midspan.deflection": near(_WEIGHT * _SPAN**4 / (384.0 * _EI), for_deflection),
            "midspan.moment": near(_WEIGHT * _SPAN**2 / 24.0, for_moments),
            "support.moment": near(
                np.full((steps + 1, 2), -_WEIGHT * _SPAN**2 / 12.0), for_moments
            ),
            "support.force.y": near(np.full((steps + 1, 2), -_WEIGHT * _SPAN / 2.0), 1e-7),
        },
        {"gravity": _g, "supports": "fixed", "internal_step": chain.step_at_rest},
    )


def _amplitudes(
    chain: _Chain, forces: _Numbers, damping: tuple[float, float], t: _Numbers
) -> _Numbers:
    """Return the amplitude of each mode (m) at times (s), under forces from the start on.

    ``damping``: by mass (1/s) and by stiffness (s).
    """
    omega = chain.bends * np.sqrt(_EI / _LINE_MASS)
    norm = (chain.modes**2).sum(axis=1) * _LINE_MASS * chain.spacing
    static = chain.modes @ forces / (norm * omega**2)
    return static * _swing(omega, damping[0] + damping[1] * omega**2, chain.internal_step, t)


def _sudden_load(chain: _Chain, by_mass: float, by_stiffness: float) -> Experiment:
    """Load that acts on the middle from the start on."""
    step, steps, every, load = 5e-5, 80, 4, 1000.0
    t = rows(step, steps, every=every)
    forces = -load * chain.middle
    amplitude = _amplitudes(chain, forces, (by_mass, by_stiffness), t)
    heights = amplitude @ chain.modes
    moments = (amplitude * chain.bends) @ chain.modes * -_EI
    down = -(heights @ chain.middle)
    at_middle = moments @ chain.middle
    tolerance = 1e-7
    damped = by_mass > 0.0
    work = load * down
    return Experiment(
        "damped-load" if damped else "sudden-load",
        Purpose.VALIDATION,
        "1 kN on the middle from the start on, "
        + ("with damping by mass and stiffness" if damped else "without damping")
        + ": the sum over the chain's modes, omega_n = 4/R2 sqrt(EI/mu) sin2(n pi/2N), in time as "
        "semi-implicit Euler makes them with the internal step h, 2/h asin(omega_n h/2) without "
        "damping. To rounding; the residual is the energy that h makes swing.",
        step,
        steps,
        {
            "midspan.deflection": near(down, tolerance),
            "position.y": Expected(-0.025 + heights, tolerance * float(down.max())),
            "midspan.moment": near(at_middle, tolerance),
            "moment": near(moments, tolerance),
            "transmitted_force": near(load, 1e-9),
            "energy.work.contact": near(work, tolerance),
            "energy.residual": Expected(0.0, 1e-4 * float(work.max())),
        },
        {
            "axis.y": -0.025,
            "damping.mass": by_mass,
            "damping.stiffness": by_stiffness,
            "internal_step": chain.internal_step,
        },
        {"force.y": tuple(forces)},
        every=every,
    )


def _pull(chain: _Chain) -> Experiment:
    """Force along the beam on its free end."""
    step, steps, every, pull = 1e-5, 60, 3, 1e4
    t = rows(step, steps, every=every)
    count = chain.elements
    n = 2.0 * np.arange(1, count + 1)[:, None] - 1.0
    shapes = np.sin(n * np.pi / 2.0 * (np.arange(count) + 0.5) / count)
    mass = _LINE_MASS * chain.spacing
    omega = 2.0 / chain.spacing * np.sqrt(_EA / _LINE_MASS) * np.sin(n[:, 0] * np.pi / (4 * count))
    static = shapes[:, -1] * pull / ((shapes**2).sum(axis=1) * mass * omega**2)
    ways = (static * _swing(omega, np.zeros(count), chain.internal_step, t)) @ shapes
    largest = float(np.abs(ways).max())
    return Experiment(
        "pull",
        Purpose.VALIDATION,
        "10 kN along the beam on its last disc, from the start on: the sum over the axial modes, "
        "omega_n = 2/R sqrt(EA/mu) sin((2n - 1) pi/4N), in time as the internal step makes them: "
        "see sudden-load.",
        step,
        steps,
        {
            "position.x": Expected(chain.places + ways, 1e-7 * largest),
            "position.y": Expected(np.full((len(t), count), -0.025), 1e-12),
            "energy.work.contact": Expected(pull * ways[:, -1], 1e-7 * pull * largest),
            "energy.residual": Expected(0.0, 3e-4 * pull * largest),
        },
        {"axis.y": -0.025, "internal_step": chain.internal_step},
        {"force.x": tuple(np.where(np.arange(count) == count - 1, pull, 0.0))},
        every=every,
    )


def _supports(chain: _Chain) -> Experiment:
    """Both supports rise with one speed: in their frame, a beam that is pushed down."""
    step, steps, every, speed = 5e-5, 80, 4, 0.1
    t = rows(step, steps, every=every)
    omega = chain.bends * np.sqrt(_EI / _LINE_MASS)
    norm = (chain.modes**2).sum(axis=1)
    # semi-implicit Euler: h sin(Omega t)/sin(Omega h) with sin(Omega h/2) = omega h/2
    h = chain.internal_step
    swings = 2.0 / h * np.arcsin(omega * h / 2.0)
    ways = h * np.sin(t[:, None] * swings) / np.sin(swings * h)
    heights = -speed * (chain.modes.sum(axis=1) / norm * ways) @ chain.modes
    return Experiment(
        "rising-supports",
        Purpose.VALIDATION,
        "Both supports rise with 0.1 m/s from the start on: in their frame the beam starts with "
        "that speed downwards and swings in its modes, in time as the internal step makes them: "
        "see sudden-load.",
        step,
        steps,
        {
            "position.y": Expected(
                -0.025 + speed * t[:, None] + heights, 1e-7 * float(np.abs(heights).max())
            ),
            "transmitted_force": Expected(0.0, 1e-9),
            "energy.residual": Expected(0.0, 1e-3 * _LINE_MASS * _SPAN * speed**2 / 2.0),
        },
        {"axis.y": -0.025, "internal_step": chain.internal_step},
        {
            "support.position.y": (lambda time: speed * time,) * 2,
            "support.velocity.y": (speed,) * 2,
        },
        every=every,
    )


def _stiffness(chain: _Chain, modulus: float, height: float) -> Experiment:
    step, steps = 1e-4, 5
    second = _SECOND * height**3
    sag = 5.0 * _WEIGHT * _SPAN**4 / (384.0 * _MODULUS * modulus * second)
    return Experiment(
        f"modulus-{100 * modulus:.0f}-height-{100 * height:.0f}",
        Purpose.UNCERTAINTY,
        "Modulus known to 3 %, height of the section to 5 %: the deflection goes with 1/(E h3), a "
        "spread of -16 to +20 %; moments and reactions stay.",
        step,
        steps,
        {
            "midspan.deflection": near(sag * chain.deflection_factor(), 1e-7),
            "midspan.moment": near(float(chain.even_moment(_WEIGHT) @ chain.middle), 1e-7),
            "support.force.y": near(np.full((steps + 1, 2), -_WEIGHT * _SPAN / 2.0), 1e-7),
        },
        {
            "gravity": _g,
            "elastic_modulus": modulus * _MODULUS,
            "section.second_moment": second,
            "section.height": height * _HEIGHT,
            "internal_step": chain.step_at_rest,
        },
    )
