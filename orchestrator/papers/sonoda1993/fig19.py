"""Figure 19: one step for sand and beam diverges, two steps are right.

And the error over the exchange step, for every scheme.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rockshed.components.common.units import cm, kgf, ms

from ...cases.sonoda1993 import DEFAULT_TEST, case_name
from ...core.system.fields import Value
from ...metrics.names import IMPACT_ENERGY, PEAK_TRANSMITTED
from ...runs.batch import COMPLETE, FAILED, Outcome, Task
from ...runs.job import Request
from ..statistics import power_law
from ..study import Outcomes, Row, Study, origin, verdict
from .laboratory import SHORT_JACOBI, SHORT_LATTICES, STOP

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COARSE = 1e-5
"""Step (s) of the sand."""
FINE = 1e-6
"""Step (s) of the beam."""
SAME = 1.0
"""Difference (%) within which two results count as nearly the same."""

_INTERNAL = ("sand", "rock", "beam")
STEPS = (2e-5, 5e-5, 1e-4, 2e-4, 5e-4)
"""Exchange steps (s) of the convergence; sand and rock keep 1e-5 s, the beam 1e-6 s."""
SCHEMES: Mapping[str, tuple[str, Mapping[str, Value]]] = {
    "paper": ("paper", {}),
    "impulse": ("impulse", {}),
    "jacobi": ("jacobi", {}),
    "jacobi, extrapolated": ("jacobi", {"sand.kinematics": "linear", "sand.forces": "mean"}),
}
"""Schemes by name: the coupling of the case, and values that are changed in it."""


def _single(step: float) -> Task:
    """Return the run with one step (s) for everything."""
    steps = {f"{name}.internal_step": step for name in _INTERNAL}
    options = {"stop_time": STOP, "exchange_step": step}
    return Task(
        Request(case_name(DEFAULT_TEST), steps, options=options),
        f"single step {step:g} s",
        allow_unstable=True,
    )


def _exchange(scheme: str, step: float) -> Task:
    coupling, values = SCHEMES[scheme]
    options = {"stop_time": STOP, "exchange_step": step, "output_interval": max(1e-4, step)}
    return Task(
        Request(case_name(DEFAULT_TEST), values, coupling=coupling, options=options), scheme
    )


_TWO_STEPS = _exchange("paper", COARSE)
"""The paper's multi-time-step method; the same bits as a program without interfaces."""


def tasks(quick: bool) -> list[Task]:
    """Return the three runs of the figure, then every scheme with every exchange step."""
    return [
        _single(COARSE),
        _single(FINE),
        _TWO_STEPS,
        *(_exchange(scheme, step) for scheme in SCHEMES for step in STEPS),
    ]


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the claims of the figure, then the convergence of the schemes."""
    return [
        _divergence(outcomes),
        *_two_steps(outcomes),
        *(row for scheme in SCHEMES for row in _convergence(scheme, outcomes)),
    ]


def _divergence(outcomes: Outcomes) -> Row:
    outcome = outcomes.of(_single(COARSE))
    diverged = outcome.status == FAILED and outcome.failed_at is not None
    at = outcome.failed_at / ms if outcome.failed_at is not None else None
    return Row(
        "a single step of 1e-5 s diverges, at",
        "ms",
        computed=at,
        model=_single(COARSE).model,
        verdict=verdict(diverged),
        note=outcome.error,
        **origin([_single(COARSE)], outcomes),
    )


def _two_steps(outcomes: Outcomes) -> list[Row]:
    """Return the differences (%) of multi-time-step from the single fine step."""
    compared = [
        ("peak transmitted force", "sand.transmitted_force", True),
        ("transmitted force, rms over time", "sand.transmitted_force", False),
        ("beam deflection, rms over time", "beam.midspan.deflection", False),
        ("beam energy, rms over time", "beam.energy.elastic", False),
    ]
    return [_two_step_row(*entry, outcomes) for entry in compared]


def _two_step_row(name: str, column: str, peaks: bool, outcomes: Outcomes) -> Row:
    two = outcomes.of(_TWO_STEPS)
    single = outcomes.of(_single(FINE))
    where = origin([_TWO_STEPS, _single(FINE)], outcomes)
    quantity = f"multi-time-step against a single step of 1e-6 s: {name}"
    if not (two.status == single.status == COMPLETE):
        return Row(
            quantity, "%", model="multi-time-step", note=f"{two.status}, {single.status}", **where
        )
    difference = _peak_error(column, two, single) if peaks else _curve_error(column, two, single)
    return Row(
        quantity,
        "%",
        computed=100.0 * difference,
        model="multi-time-step",
        verdict=verdict(100.0 * abs(difference) < SAME),
        note=f"the paper: almost the same; here: within {SAME:g} %",
        **where,
    )


def _peak_error(column: str, one: Outcome, other: Outcome) -> float:
    return one.metrics[f"{column} maximum"] / other.metrics[f"{column} maximum"] - 1.0


def _curve_error(column: str, one: Outcome, other: Outcome) -> float:
    a = one.series[column]
    b = other.series[column]
    return float(np.sqrt(np.mean((a - b) ** 2)) / np.abs(b).max())


# ---------------------------------------------------------------- convergence


def force_error(outcome: Outcome, reference: Outcome) -> float:
    """Return the relative error (%) of the peak transmitted force, without sign."""
    return 100.0 * abs(
        outcome.metrics[PEAK_TRANSMITTED] / reference.metrics[PEAK_TRANSMITTED] - 1.0
    )


def energy_error(outcome: Outcome, reference: Outcome) -> float:
    """Return the largest energy that the interfaces make or lose, in percent of the impact energy.

    Counted is what goes beyond the reference: that has the work of forces of the last internal
    step, which no scheme can be without.
    """
    time = outcome.series["time"]
    made = np.zeros(time.size)
    for bond in ("sand_rock", "sand_beam"):
        column = f"coupling.{bond}.energy"
        made += np.abs(
            outcome.series[column]
            - np.interp(time, reference.series["time"], reference.series[column])
        )
    return 100.0 * float(np.max(made)) / outcome.metrics[IMPACT_ENERGY]


ERRORS = {
    "peak transmitted force, error": force_error,
    "coupling energy / impact energy": energy_error,
}


def _points(scheme: str, name: str, outcomes: Outcomes) -> list[tuple[float, float]]:
    """Return exchange step (s) and error (%) of the runs that ended."""
    reference = outcomes.of(_TWO_STEPS)
    each = [(step, outcomes.of(_exchange(scheme, step))) for step in STEPS]
    return [
        (step, ERRORS[name](outcome, reference))
        for step, outcome in each
        if outcome.status == COMPLETE and reference.status == COMPLETE
    ]


def order(points: Sequence[tuple[float, float]]) -> float | None:
    """Return the order of a scheme.

    Parameters
    ----------
    points : sequence of (float, float)
        Exchange steps and errors.

    Returns
    -------
    float or None
        Slope of the error over the step, both logarithmic; None with fewer than three errors
        above zero.
    """
    positive = [point for point in points if point[1] > 0.0]
    return power_law(*zip(*positive, strict=True))[1] if len(positive) >= 3 else None


def _convergence(scheme: str, outcomes: Outcomes) -> list[Row]:
    """Return for each error its value at every step, and its order."""
    listed = []
    for name in ERRORS:
        points = dict(_points(scheme, name, outcomes))
        for step in STEPS:
            task = _exchange(scheme, step)
            outcome = outcomes.of(task)
            row = Row(
                f"{name}, exchange step {step / ms:g} ms",
                "%",
                computed=points.get(step),
                model=scheme,
                note="" if step in points else f"{outcome.status}: {outcome.error}",
                detail=step != 1e-4,
                **origin([task], outcomes),
            )
            listed.append(row)
        row = Row(
            f"{name}: order in the exchange step",
            "1",
            computed=order(list(points.items())),
            model=scheme,
            note=f"fitted to {len(points)} steps",
            **origin([_exchange(scheme, step) for step in STEPS], outcomes),
        )
        listed.append(row)
    return listed


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw fig. 19, and the errors over the exchange step."""
    return [_fig_19(outcomes, folder / "fig19.png"), _orders(outcomes, folder / "convergence.png")]


def _fig_19(outcomes: Outcomes, file: Path) -> Path:
    from ...pictures.style import WIDTH, captioned, legend

    words = "Fig. 19 of Sonoda et al. 1993: test 4 with different time steps, calibrated sand."
    with captioned([words], file, WIDTH, 3.2) as made:
        left, right = made.subplots(1, 2)
        _draw_steps(left, outcomes, "sand.transmitted_force", kgf)
        left.set_ylabel("transmitted force (kgf)")
        _draw_steps(right, outcomes, "beam.energy.elastic", kgf * cm)
        right.set_ylabel("energy of the beam (kgf cm)")
        legend(left)
    return file


def _draw_steps(axes: "Axes", outcomes: Outcomes, column: str, scale: float) -> None:
    """Draw a variable over time with one step and with two, up to the largest stable value."""
    from ...pictures.style import INK, ROCK, TRANSMITTED

    top = 0.0
    for task, colour, dashes, label in (
        (_single(FINE), INK, "-", "single step 1e-6 s"),
        (_TWO_STEPS, TRANSMITTED, "--", "sand 1e-5 s, beam 1e-6 s"),
        (_single(COARSE), ROCK, ":", "single step 1e-5 s: diverges"),
    ):
        outcome = outcomes.of(task)
        if not outcome.series:
            continue
        values = outcome.series[column] / scale
        if outcome.status == COMPLETE and task != _single(COARSE):
            top = max(top, float(values.max()))
        form: dict[str, Any] = {"color": colour, "linewidth": 1.3, "label": label}
        axes.plot(outcome.series["time"] / ms, values, dashes, **form)
    axes.set(xlabel="time (ms)", xlim=(0.0, STOP / ms))
    axes.set_ylim(-0.1 * (top or 1.0), 1.4 * (top or 1.0))


def _orders(outcomes: Outcomes, file: Path) -> Path:
    from ...pictures.style import WIDTH, captioned, legend

    words = (
        "Test 4, calibrated sand; sand and rock 1e-5 s, beam 1e-6 s. Errors against the exchange "
        "every 1e-5 s, sand first, which has the bits of a program without interfaces. In "
        "brackets: fitted order."
    )
    with captioned([words], file, WIDTH, 3.6) as made:
        for axes, name in zip(made.subplots(1, 2), ERRORS, strict=True):
            _draw_errors(axes, name, outcomes)
            legend(axes)
    return file


def _draw_errors(axes: "Axes", name: str, outcomes: Outcomes) -> None:
    """Draw an error over the exchange step, a line for each scheme."""
    from ...pictures.style import BEAM, INK, ROCK, TRANSMITTED, plain_powers

    colours = (INK, TRANSMITTED, ROCK, BEAM)
    for scheme, colour, mark in zip(SCHEMES, colours, "osD^", strict=True):
        points = [point for point in _points(scheme, name, outcomes) if point[1] > 0.0]
        if not points:
            continue
        fitted = order(points)
        known = "-" if fitted is None else f"{fitted:.1f}"
        steps, errors = zip(*points, strict=True)
        form: dict[str, Any] = {"color": colour, "markersize": 4, "linewidth": 1.0}
        axes.loglog(np.divide(steps, ms), errors, f"{mark}-", label=f"{scheme} ({known})", **form)
    axes.set(xlabel="exchange step (ms)", xticks=[step / ms for step in STEPS])
    axes.set(ylabel=f"{name} (%)")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter("")
    plain_powers(axes.yaxis)


STUDY = Study(
    "fig19",
    "Figure 19: time steps and exchange steps",
    5.2,
    rows,
    tasks,
    draw,
    (
        "Convergence: the internal steps stay as they are, only the exchange step changes, so that "
        "the error is that of the coupling; the reference exchanges every 1e-5 s, sand first.",
        "paper and impulse: sand first, with held inputs and last forces, or extrapolated "
        "kinematics and mean forces; jacobi: all at once, with held inputs and last forces, or "
        "extrapolated.",
    ),
    stands_on={**SHORT_LATTICES, **SHORT_JACOBI},
)
