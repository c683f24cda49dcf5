"""Finds the fictitious modulus E_bar with which the static test gives a measured spring constant or load-penetration curve.

The static test is run through the FMUs with a few E_bar around the one sought and several samples of the sand. Near it, loads go
with a power of E_bar (about 1), which is fitted; so every run says which E_bar its sample would need.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.units import cm, kgf

from ...cases.sand_models import LATTICE_SHIFT, model_values
from ...cases.sonoda1993 import STATIC_RATIO
from ...cases.static_loading import NAME, SPEED, rock_height
from ...core.errors import InputRefused, Problem, RunFailed
from ...core.system.system import Value
from ...metrics.load_curve import LoadCurve, load_curve
from ...runs.batch import (
    COMPLETE,
    INTERRUPTED,
    Counted,
    Outcome,
    Task,
    run_all,
    run_here,
    uncounted,
)
from ...runs.building import Note
from ...runs.job import Request
from .measurement import Measurement

LOWEST, HIGHEST = 1.0 * kgf / cm**2, 500.0 * kgf / cm**2
"""E_bar (Pa) between which it is sought."""
ROTATIONS: Mapping[str, Mapping[str, Value]] = {
    "locked": model_values("calibrated"),
    "free": model_values("literal"),
}
"""Models of the sand by what their discs may do; ``free`` goes with stiffness factor 1."""
_SOUGHT = ("sand.modulus", "sand.seed", "sand.internal_step", "rock.position0.y")
"""Parameters that the calibration sets itself."""
_SIDE = 1.25
"""E_bar is varied by this factor to both sides."""
_NEAR = 1.5
"""From so near (a factor in the load) on the fit begins."""
_LONGEST_STRIDE = 4.0
_TRIALS = 8
_ROUNDS = 3
_STABLE = 0.7
"""Internal step of the sand / its stable step."""
_PROBE_STEP = 1e-5
_HIGH = 0.5
"""Height (m) of the rock while the sand's surface is looked for."""
_MARGIN = 1.0 * cm
"""How much the surfaces of random samples may differ from that of the first, to both sides."""
_FLAT = 0.2
"""Exponent of the load over E_bar below which E_bar cannot be told from a load."""


@dataclass(frozen=True)
class Push:
    """A computed static test: fictitious modulus (Pa), number of the sample, load curve."""

    modulus: float
    seed: int
    curve: LoadCurve


@dataclass(frozen=True)
class Fit:
    """What a measurement says about E_bar (Pa), and the curve that the model has with it.

    exponent: loads go with E_bar to this power. spread: standard deviation of the E_bar that each run alone asks for, as one
    specimen would. misfit: root mean square of computed less measured load / that of the measured one; the E_bar that each point
    alone asks for scatter by about that. load, load_spread: computed at the measured penetrations, mean and standard deviation
    over the runs (N).
    """

    measured: Measurement
    modulus: float
    spread: float
    misfit: float
    exponent: float
    load: NDArray[np.float64]
    load_spread: NDArray[np.float64]

    @property
    def uncertainty(self) -> float:
        """Standard uncertainty (Pa): scatter of the samples and misfit of the curve together."""
        return math.hypot(self.spread, self.modulus * self.misfit / self.exponent)


@dataclass(frozen=True)
class Calibration:
    """Fits to all measurements with one model of the sand, from the same tests. values: what is changed in the case."""

    rotation: str
    values: Mapping[str, Value]
    fits: Sequence[Fit]
    pushes: Sequence[Push]


class Unreachable(InputRefused):
    """The sand does not have such loads with any E_bar."""


# ------------------------------------------------------------------ the fit, without any run


def strength(measured: Measurement, curve: LoadCurve) -> float:
    """Computed loads / those that lie nearest to the measured ones (least squares) among their multiples; 0 if none are there."""
    computed = curve.at(measured.depth)
    common = float(computed @ measured.load)
    return float(computed @ computed) / common if common > 0.0 else 0.0


def fit(measured: Measurement, pushes: Sequence[Push]) -> Fit:
    """E_bar from tests with several moduli and samples, three at least.

    Raises:
        Unreachable: the load does not rise with E_bar.
    """
    moduli, strengths = (
        np.array([push.modulus for push in pushes]),
        np.array([strength(measured, push.curve) for push in pushes]),
    )
    exponent = _exponent(moduli, strengths)
    if not exponent > _FLAT:
        raise _unreachable(measured, pushes)
    wanted = np.log(moduli) - np.log(strengths) / exponent
    modulus = float(np.exp(wanted.mean()))
    loads = np.array(
        [push.curve.at(measured.depth) * (modulus / push.modulus) ** exponent for push in pushes]
    )
    load = loads.mean(axis=0)
    misfit = (
        float(np.sqrt(np.sum((load - measured.load) ** 2) / np.sum(measured.load**2)))
        if measured.is_curve
        else 0.0
    )
    return Fit(
        measured,
        modulus,
        modulus * float(np.std(wanted, ddof=2)),
        misfit,
        exponent,
        load,
        loads.std(axis=0, ddof=1),
    )


def _exponent(moduli: NDArray[np.float64], strengths: NDArray[np.float64]) -> float:
    """Slope of the logarithms; none where a sample carries nothing."""
    return (
        float(np.polyfit(np.log(moduli), np.log(strengths), 1)[0])
        if (strengths > 0.0).all()
        else math.nan
    )


def _unreachable(measured: Measurement, pushes: Sequence[Push]) -> Unreachable:
    """What the sand reaches, in terms of the spring constant at the deepest measured point."""
    depth = float(measured.depth[-1])
    reached = [float(push.curve.at(depth)) / depth / kgf * cm for push in pushes]
    moduli = [push.modulus / kgf * cm**2 for push in pushes]
    wanted = float(measured.load[-1]) / depth / kgf * cm
    return Unreachable(
        [
            Problem(
                measured.name,
                f"a spring constant of {wanted:.3g} kgf/cm at {depth / cm:g} cm is out of reach: the sand has "
                f"{min(reached):.3g} to {max(reached):.3g} kgf/cm for E_bar from {min(moduli):.3g} to {max(moduli):.3g} kgf/cm2",
                "another model of the sand (--rotation, --set sand.packing=...), or look at the measurement",
            )
        ]
    )


# ------------------------------------------------------------------ runs


@dataclass(frozen=True)
class _Bench:
    """The static test of one sand: what is changed in the case, how deep to go, where its surface is, its stable step.

    root: stable step (s) * sqrt(E_bar). surface: highest (m), depth: way (m) from there.
    """

    values: Mapping[str, Value]
    surface: float
    depth: float
    root: float

    def task(self, modulus: float, seed: int) -> Task:
        """The run of a sample."""
        step = _STABLE * self.root / math.sqrt(modulus)
        return Task(
            Request(
                NAME,
                {
                    **self.values,
                    "sand.modulus": modulus,
                    "sand.seed": seed,
                    "sand.internal_step": step,
                    "rock.position0.y": rock_height(self.surface),
                },
                options={"stop_time": round(self.depth / SPEED, 2)},
            ),
            seed=seed,
        )


def calibrate(
    measurements: Sequence[Measurement],
    rotation: str = "locked",
    values: Mapping[str, Value] | None = None,
    seeds: int = 5,
    workers: int | None = None,
    note: Note = lambda text: None,
    done: Counted = uncounted,
) -> Calibration:
    """Find E_bar for each measurement.

    rotation: one of :data:`ROTATIONS`. values: further changes of the case, by ``component.parameter``. seeds: samples, at
    least two.

    Raises:
        InputRefused: values that cannot be had, or (:class:`Unreachable`) loads that the sand does not have.
        RunFailed: a run could not go on.
        KeyboardInterrupt: Ctrl-C, also from a run that took it for itself.
    """
    if problems := [
        Problem(f"--set {name}", "is chosen by the calibration", "leave it out")
        for name in values or {}
        if name in _SOUGHT
    ]:
        raise InputRefused(problems)
    chosen = {"sand.lattice_shift": LATTICE_SHIFT, **ROTATIONS[rotation], **(values or {})}
    bench = _bench(chosen, max(float(measured.depth[-1]) for measured in measurements), note)
    ordered = sorted(
        measurements, key=lambda measured: float(measured.load[-1] / measured.depth[-1])
    )
    low = _near(ordered[0], bench)
    high = low if len(ordered) == 1 else _near(ordered[-1], bench)
    for _ in range(_ROUNDS):
        moduli = _around(low, high)
        tasks = [bench.task(modulus, seed) for modulus in moduli for seed in range(1, seeds + 1)]
        outcomes = run_all(tasks, workers, note, done)
        pushes = [
            Push(modulus, seed, _curve(outcomes[bench.task(modulus, seed).key]))
            for modulus in moduli
            for seed in range(1, seeds + 1)
        ]
        fits = [fit(measured, pushes) for measured in measurements]
        found = [result.modulus for result in fits]
        if min(found) >= moduli[0] and max(found) <= moduli[-1]:
            break
        low, high = min(found), max(found)
    return Calibration(rotation, chosen, fits, pushes)


def _around(low: float, high: float) -> list[float]:
    """Moduli (Pa) in equal ratios, a little beyond both ends; at least three."""
    count = 3 + math.ceil(math.log(high / low) / math.log(_SIDE**2))
    return [float(modulus) for modulus in np.geomspace(low / _SIDE, high * _SIDE, count)]


def _bench(values: Mapping[str, Value], deepest: float, note: Note) -> _Bench:
    """Look how high the sand stands and which step is stable: a run of one exchange, the rock far above."""
    modulus = 20.0 * kgf / cm**2
    probe = Task(
        Request(
            NAME,
            {
                **values,
                "sand.modulus": modulus,
                "sand.internal_step": _PROBE_STEP,
                "rock.position0.y": _HIGH,
            },
            options={"stop_time": 1e-3},
        ),
        allow_unstable=True,
    )
    outcome = _ended(run_here(probe, note))
    margin = _MARGIN if outcome.options["packing"] == "random" else 0.0
    return _Bench(
        values,
        float(outcome.series["sand.surface_height"][0]) + margin,
        deepest + 2.0 * margin + 0.15 * cm,
        float(outcome.series["sand.stable_step"][0]) * math.sqrt(modulus),
    )


def _near(measured: Measurement, bench: _Bench) -> float:
    """An E_bar (Pa) with which one sample has about the measured load.

    Raises:
        Unreachable: there is none.
    """
    modulus = min(
        max(float(measured.load[-1] / measured.depth[-1]) / STATIC_RATIO / cm, LOWEST), HIGHEST
    )
    tried: list[Push] = []
    for _ in range(_TRIALS):
        tried.append(Push(modulus, 1, _curve(_ended(run_here(bench.task(modulus, 1))))))
        relation = strength(measured, tried[-1].curve)
        if 1.0 / _NEAR < relation < _NEAR:
            return modulus
        stride = min(
            max(1.0 / relation if relation > 0.0 else math.inf, 1.0 / _LONGEST_STRIDE),
            _LONGEST_STRIDE,
        )
        following = min(max(modulus * stride, LOWEST), HIGHEST)
        if following == modulus:
            break
        modulus = following
    raise _unreachable(measured, tried)


def _curve(outcome: Outcome) -> LoadCurve:
    curve = load_curve(_ended(outcome).series, "sand")
    assert curve is not None
    return curve


def _ended(outcome: Outcome) -> Outcome:
    """A run with a result.

    Raises:
        InputRefused, RunFailed, KeyboardInterrupt: why there is none.
    """
    if outcome.status == INTERRUPTED:
        raise KeyboardInterrupt
    if outcome.status != COMPLETE and outcome.failed_at is None:
        raise InputRefused([Problem(outcome.key, outcome.error)])
    if outcome.status != COMPLETE:
        raise RunFailed(outcome.key, float(outcome.failed_at or 0.0), outcome.error)
    return outcome


def by_misfit(
    candidates: Mapping[str, Callable[[], Calibration]],
) -> tuple[list[Calibration], dict[str, Unreachable]]:
    """Calibrations of several models, by their names, to one curve: the best fit first; and why others have none.

    Raises:
        Unreachable: no model has such loads.
    """
    made, lost = [], {}
    for name, candidate in candidates.items():
        try:
            made.append(candidate())
        except Unreachable as reason:
            lost[name] = reason
    if not made:
        raise Unreachable([problem for reason in lost.values() for problem in reason.problems])
    return sorted(made, key=lambda calibration: calibration.fits[0].misfit), lost
