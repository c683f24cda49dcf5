"""The search for E_bar: static tests through the FMUs around the modulus that is sought."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rockshed.components.common.units import cm, kgf

from ...cases.sand_models import LATTICE_SHIFT, model_values
from ...cases.sonoda1993 import STATIC_RATIO
from ...cases.static_loading import NAME, SPEED, rock_height
from ...core.errors import InputRefused, Problem, RunFailed
from ...core.system.fields import Value
from ...metrics.load_curve import LoadCurve, load_curve
from ...runs.batch import COMPLETE, INTERRUPTED, Outcome, Task, run_all, run_here, uncounted
from ...runs.building import Note, silent
from ...runs.kept import KeptRuns
from ...runs.request import Request
from ..frame import Count
from .fit import Fit, Push, Unreachable, fit, strength, unreachable
from .measurement import Measurement

LOWEST, HIGHEST = 1.0 * kgf / cm**2, 500.0 * kgf / cm**2
"""E_bar (Pa) between which it is sought."""
ROTATIONS: Mapping[str, Mapping[str, Value]] = {
    "locked": model_values("calibrated"),
    "free": model_values("literal"),
}
"""Models of the sand by the rotation of their discs; ``free`` goes with stiffness factor 1."""
SOUGHT = ("sand.modulus", "sand.seed", "sand.internal_step", "rock.position0.y")
"""Parameters that the calibration sets itself."""
_SIDE = 1.25
"""Factor by which E_bar is varied to both sides."""
_NEAR = 1.5
"""Factor in the load from which the fit begins."""
_LONGEST_STRIDE = 4.0
"""Largest factor between two tried E_bar."""
_MOST_TRIED = 8
"""Number of E_bar that are tried until one is near."""
_ROUNDS = 3
"""Number of fits, each around the E_bar of the one before."""
_STABLE = 0.7
"""Internal step of the sand / its stable step."""
_PROBE_MODULUS, _PROBE_STEP = 20.0 * kgf / cm**2, 1e-5
"""E_bar (Pa) and step (s) with which the surface of the sand is looked for."""
_HIGH = 0.5
"""Height (m) of the rock while the surface of the sand is looked for."""
_MARGIN = 1.0 * cm
"""Way (m) by which surfaces of random samples may differ from the first one, to both sides."""


@dataclass(frozen=True)
class Means:
    """Means by which static tests are carried out.

    Attributes
    ----------
    workers : int, optional
        Number of processes, by default one for each core.
    note : callable
        Called with a line for each FMU that is built.
    count : Count
        Called with the numbers of tests done and of all.
    kept : KeptRuns, optional
        Tests that have ended before, which are not carried out again, and to which others are
        added.
    """

    workers: int | None = None
    note: Note = silent
    count: Count = uncounted
    kept: KeptRuns | None = None

    def here(self, task: Task) -> Outcome:
        """Carry out one test in this process."""
        return run_here(task, self.note, self.kept)

    def all(self, tasks: Sequence[Task]) -> Mapping[str, Outcome]:
        """Carry out tests, and return their outcomes by the keys of the tasks."""
        return run_all(tasks, self.workers, self.note, self.count, self.kept)


@dataclass(frozen=True)
class Calibration:
    """Fits to all measurements with one model of the sand, from the same tests.

    Attributes
    ----------
    rotation : str
        One of :data:`ROTATIONS`.
    values : mapping of str to Value
        Changes in the case ``static-test``.
    fits : sequence of Fit
        One for each measurement.
    pushes : sequence of Push
        Computed tests.
    """

    rotation: str
    values: Mapping[str, Value]
    fits: Sequence[Fit]
    pushes: Sequence[Push]


def calibration_of(
    measurements: Sequence[Measurement],
    rotation: str = "locked",
    values: Mapping[str, Value] | None = None,
    seeds: int = 5,
    means: Means = Means(),
) -> Calibration:
    """Find E_bar for each measurement with one model of the sand.

    Parameters
    ----------
    measurements : sequence of Measurement
        One at least.
    rotation : str
        One of :data:`ROTATIONS`.
    values : mapping of str to Value, optional
        Further changes of the case, by ``component.parameter``.
    seeds : int
        Number of samples, two at least.
    means : Means
        With what the tests are carried out.

    Returns
    -------
    Calibration
        Fits and tests.

    Raises
    ------
    InputRefused
        The case refuses values, or (:class:`Unreachable`) the sand does not have such loads.
    RunFailed
        A test could not go on.
    KeyboardInterrupt
        Ctrl-C, also from a test that took it for itself.
    """
    chosen = {"sand.lattice_shift": LATTICE_SHIFT, **ROTATIONS[rotation], **(values or {})}
    rig = _rig(chosen, max(float(measured.depth[-1]) for measured in measurements), means)
    ordered = sorted(measurements, key=lambda measured: measured.stiffness)
    low = _near(ordered[0], rig, means)
    high = low if len(ordered) == 1 else _near(ordered[-1], rig, means)
    for _ in range(_ROUNDS):
        moduli = _around(low, high)
        pushes = _pushes(rig, moduli, seeds, means)
        fits = [fit(measured, pushes) for measured in measurements]
        low = min(result.modulus for result in fits)
        high = max(result.modulus for result in fits)
        if low >= moduli[0] and high <= moduli[-1]:
            break
    return Calibration(rotation, chosen, fits, pushes)


def by_misfit(
    candidates: Mapping[str, Callable[[], Calibration]],
) -> tuple[list[Calibration], dict[str, Unreachable]]:
    """Calibrate several models of the sand to one curve.

    Parameters
    ----------
    candidates : mapping of str to callable
        Calibrations by the name of the model.

    Returns
    -------
    calibrations : list of Calibration
        The best fit first.
    refused : dict of str to Unreachable
        Models that do not have such loads.

    Raises
    ------
    Unreachable
        No model has such loads.
    """
    calibrations = []
    refused = {}
    for name, candidate in candidates.items():
        try:
            calibrations.append(candidate())
        except Unreachable as reason:
            refused[name] = reason
    if not calibrations:
        raise Unreachable([problem for reason in refused.values() for problem in reason.problems])
    return sorted(calibrations, key=lambda made: made.fits[0].misfit), refused


# --- static tests ---


@dataclass(frozen=True)
class _TestRig:
    """The static test of one sand.

    Attributes
    ----------
    values : mapping of str to Value
        Changes in the case.
    surface : float
        Highest surface of the sand under the rock (m).
    depth : float
        Way of the rock from there (m).
    root : float
        Stable step (s) * sqrt(E_bar).
    """

    values: Mapping[str, Value]
    surface: float
    depth: float
    root: float

    def task(self, modulus: float, seed: int) -> Task:
        """Return the test of a sample."""
        values = {
            **self.values,
            "sand.modulus": modulus,
            "sand.seed": seed,
            "sand.internal_step": _STABLE * self.root / math.sqrt(modulus),
            "rock.position0.y": rock_height(self.surface),
        }
        options = {"stop_time": round(self.depth / SPEED, 2)}
        return Task(Request(NAME, values, options=options), seed=seed)


def _rig(values: Mapping[str, Value], deepest: float, means: Means) -> _TestRig:
    """Look how high the sand stands and which step is stable.

    In a run of one exchange, the rock far above.
    """
    changes = {
        **values,
        "sand.modulus": _PROBE_MODULUS,
        "sand.internal_step": _PROBE_STEP,
        "rock.position0.y": _HIGH,
    }
    probe = Task(Request(NAME, changes, options={"stop_time": 1e-3}), allow_unstable=True)
    outcome = _ended(means.here(probe))
    margin = _MARGIN if outcome.options["packing"] == "random" else 0.0
    highest, level = (
        float(outcome.series[f"sand.surface_{name}"][0]) for name in ("height", "level")
    )
    return _TestRig(
        values,
        highest + margin,
        deepest + highest - level + 2.0 * margin + 0.15 * cm,
        float(outcome.series["sand.stable_step"][0]) * math.sqrt(_PROBE_MODULUS),
    )


def _pushes(rig: _TestRig, moduli: Sequence[float], seeds: int, means: Means) -> list[Push]:
    """Carry out the tests of all samples with each modulus."""
    tests = [(modulus, seed) for modulus in moduli for seed in range(1, seeds + 1)]
    tasks = [rig.task(*test) for test in tests]
    outcomes = means.all(tasks)
    return [
        Push(modulus, seed, _curve(outcomes[task.key]))
        for (modulus, seed), task in zip(tests, tasks, strict=True)
    ]


def _around(low: float, high: float) -> list[float]:
    """Return moduli (Pa) in equal ratios, a little beyond both ends; at least three."""
    count = 3 + math.ceil(math.log(high / low) / math.log(_SIDE**2))
    return [float(modulus) for modulus in np.geomspace(low / _SIDE, high * _SIDE, count)]


def _near(measured: Measurement, rig: _TestRig, means: Means) -> float:
    """Return an E_bar (Pa) with which one sample has about the measured load.

    Raises
    ------
    Unreachable
        There is none.
    """
    modulus = _within(measured.stiffness / STATIC_RATIO / cm, LOWEST, HIGHEST)
    tried: list[Push] = []
    for _ in range(_MOST_TRIED):
        tried.append(Push(modulus, 1, _curve(means.here(rig.task(modulus, 1)))))
        relation = strength(measured, tried[-1].curve)
        if 1.0 / _NEAR < relation < _NEAR:
            return modulus
        stride = 1.0 / relation if relation > 0.0 else math.inf
        stride = _within(stride, 1.0 / _LONGEST_STRIDE, _LONGEST_STRIDE)
        following = _within(modulus * stride, LOWEST, HIGHEST)
        if following == modulus:
            break
        modulus = following
    raise unreachable(measured, tried)


def _within(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def _curve(outcome: Outcome) -> LoadCurve:
    curve = load_curve(_ended(outcome).series, "sand")
    assert curve is not None
    return curve


def _ended(outcome: Outcome) -> Outcome:
    """Return the outcome of a test that has a result.

    Raises
    ------
    InputRefused, RunFailed, KeyboardInterrupt
        Why there is none.
    """
    if outcome.status == INTERRUPTED:
        raise KeyboardInterrupt
    if outcome.status != COMPLETE and outcome.failed_at is None:
        raise InputRefused([Problem(outcome.key, outcome.error)])
    if outcome.status != COMPLETE:
        raise RunFailed(outcome.key, float(outcome.failed_at or 0.0), outcome.error)
    return outcome
