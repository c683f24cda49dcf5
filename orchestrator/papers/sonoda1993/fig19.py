"""Figure 19: one step for sand and beam diverges, two steps are right; and how the error grows with the exchange step."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from rockshed.components.common.units import cm, kgf, ms

from ...cases.sonoda1993 import DEFAULT_TEST, case_name
from ...core.system.system import Value
from ...metrics.names import IMPACT_ENERGY, PEAK_TRANSMITTED
from ...runs.batch import COMPLETE, FAILED, Outcome, Task
from ...runs.job import Request
from ..statistics import power_law
from ..study import Outcomes, Row, Study, origin, verdict
from .laboratory import STOP

COARSE, FINE = 1e-5, 1e-6
SAME = 1.0
"""Percent within which two results count as nearly the same."""

_INTERNAL = ("sand", "rock", "beam")
STEPS = (2e-5, 5e-5, 1e-4, 2e-4, 5e-4)
"""Exchange steps (s) of the study of convergence; sand and rock keep their 1e-5 s, the beam its 1e-6 s."""
SCHEMES: Mapping[str, tuple[str, Mapping[str, Value]]] = {
    "paper": ("paper", {}),
    "impulse": ("impulse", {}),
    "jacobi": ("jacobi", {}),
    "jacobi, extrapolated": ("jacobi", {"sand.kinematics": "linear", "sand.forces": "mean"}),
}
"""Schemes by name: the coupling of the case and what is changed in it."""


def _single(step: float) -> Task:
    """One step for everything."""
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
    """The three runs of the figure, then every scheme with every exchange step."""
    return [
        _single(COARSE),
        _single(FINE),
        _TWO_STEPS,
        *(_exchange(scheme, step) for scheme in SCHEMES for step in STEPS),
    ]


def rows(found: Outcomes) -> list[Row]:
    """The claims of the figure, then the convergence of the schemes."""
    return [
        _divergence(found),
        *_two_steps(found),
        *(row for scheme in SCHEMES for row in _convergence(scheme, found)),
    ]


def _divergence(found: Outcomes) -> Row:
    outcome = found.of(_single(COARSE))
    diverged = outcome.status == FAILED and outcome.failed_at is not None
    at = outcome.failed_at / ms if outcome.failed_at is not None else None
    return Row(
        "a single step of 1e-5 s diverges, at",
        "ms",
        computed=at,
        model=_single(COARSE).model,
        verdict=verdict(diverged),
        note=outcome.error,
        **origin([_single(COARSE)], found),
    )


def _two_steps(found: Outcomes) -> list[Row]:
    """Multi-time-step against the single fine step: largest differences, in percent of the peak of the fine one."""
    compared = [
        ("peak transmitted force", "sand.transmitted_force", True),
        ("transmitted force, rms over time", "sand.transmitted_force", False),
        ("beam deflection, rms over time", "beam.midspan.deflection", False),
        ("beam energy, rms over time", "beam.energy.elastic", False),
    ]
    return [_two_step_row(*entry, found) for entry in compared]


def _two_step_row(name: str, column: str, peaks: bool, found: Outcomes) -> Row:
    two, single = found.of(_TWO_STEPS), found.of(_single(FINE))
    where = origin([_TWO_STEPS, _single(FINE)], found)
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
    a, b = one.series[column], other.series[column]
    return float(np.sqrt(np.mean((a - b) ** 2)) / np.abs(b).max())


# ------------------------------------------------------------------ convergence in the exchange step


def force_error(outcome: Outcome, reference: Outcome) -> float:
    """Relative error of the peak transmitted force (percent, without sign)."""
    return 100.0 * abs(
        outcome.metrics[PEAK_TRANSMITTED] / reference.metrics[PEAK_TRANSMITTED] - 1.0
    )


def energy_error(outcome: Outcome, reference: Outcome) -> float:
    """Largest energy within the run that the interfaces have made or lost beyond those of the reference, in percent of the
    impact energy. What the reference has is the work of forces of the last internal step, which no scheme can be without."""
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


def _points(scheme: str, name: str, found: Outcomes) -> list[tuple[float, float]]:
    """Exchange step (s) and error (percent) of the runs that ended."""
    reference = found.of(_TWO_STEPS)
    outcomes = [(step, found.of(_exchange(scheme, step))) for step in STEPS]
    return [
        (step, ERRORS[name](outcome, reference))
        for step, outcome in outcomes
        if outcome.status == COMPLETE and reference.status == COMPLETE
    ]


def order(points: Sequence[tuple[float, float]]) -> float | None:
    """Slope of the error over the step, both logarithmic; None with fewer than three errors above zero."""
    positive = [point for point in points if point[1] > 0.0]
    return power_law(*zip(*positive, strict=True))[1] if len(positive) >= 3 else None


def _convergence(scheme: str, found: Outcomes) -> list[Row]:
    """For each error its value at every step, and its order."""
    listed = []
    for name in ERRORS:
        points = dict(_points(scheme, name, found))
        for step in STEPS:
            task = _exchange(scheme, step)
            outcome = found.of(task)
            listed.append(
                Row(
                    f"{name}, exchange step {step / ms:g} ms",
                    "%",
                    computed=points.get(step),
                    model=scheme,
                    note="" if step in points else f"{outcome.status}: {outcome.error}",
                    detail=step != 1e-4,
                    **origin([task], found),
                )
            )
        fitted = order(list(points.items()))
        listed.append(
            Row(
                f"{name}: order in the exchange step",
                "1",
                computed=fitted,
                model=scheme,
                note=f"fitted to {len(points)} steps",
                **origin([_exchange(scheme, step) for step in STEPS], found),
            )
        )
    return listed


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Fig. 19 and the errors over the exchange step."""
    return [_fig_19(found, folder / "fig19.png"), _orders(found, folder / "convergence.png")]


def _fig_19(found: Outcomes, file: Path) -> Path:
    from ...pictures.style import INK, ROCK, TRANSMITTED, WIDTH, captioned, legend

    curves = (
        (_single(FINE), INK, "-", "single step 1e-6 s"),
        (_TWO_STEPS, TRANSMITTED, "--", "sand 1e-5 s, beam 1e-6 s"),
        (_single(COARSE), ROCK, ":", "single step 1e-5 s: diverges"),
    )
    columns = (
        ("sand.transmitted_force", kgf, "transmitted force (kgf)"),
        ("beam.energy.elastic", kgf * cm, "energy of the beam (kgf cm)"),
    )
    with captioned(
        ["Fig. 19 of Sonoda et al. 1993: test 4 with different time steps, calibrated sand."],
        file,
        WIDTH,
        3.2,
    ) as made:
        for axes, (column, scale, label) in zip(made.subplots(1, 2), columns, strict=True):
            settled = [
                found.of(task).series[column].max() / scale
                for task, *_ in curves[:2]
                if found.of(task).status == COMPLETE
            ]
            for task, colour, line, name in curves:
                series = found.of(task).series
                if series:
                    axes.plot(
                        series["time"] / ms,
                        series[column] / scale,
                        line,
                        color=colour,
                        label=name,
                        linewidth=1.3,
                    )
            axes.set(xlabel="time (ms)", ylabel=label, xlim=(0.0, STOP / ms))
            axes.set_ylim(-0.1 * max(settled, default=1.0), 1.4 * max(settled, default=1.0))
        legend(made.axes[0], loc="upper left")
    return file


def _orders(found: Outcomes, file: Path) -> Path:
    from ...pictures.style import BEAM, INK, ROCK, TRANSMITTED, WIDTH, captioned, legend

    caption = [
        "Test 4, calibrated sand; sand and rock 1e-5 s, beam 1e-6 s. Errors against the exchange every 1e-5 s, sand first, "
        "which has the bits of a program without interfaces. In brackets: fitted order."
    ]
    with captioned(caption, file, WIDTH, 3.6) as made:
        for axes, name in zip(made.subplots(1, 2), ERRORS, strict=True):
            for scheme, colour, mark in zip(
                SCHEMES, (INK, TRANSMITTED, ROCK, BEAM), "osD^", strict=True
            ):
                points = [
                    (step / ms, error)
                    for step, error in _points(scheme, name, found)
                    if error > 0.0
                ]
                fitted = order(points)
                if points:
                    axes.loglog(
                        *zip(*points, strict=True),
                        f"{mark}-",
                        color=colour,
                        markersize=4,
                        linewidth=1.0,
                        label=f"{scheme} ({'-' if fitted is None else f'{fitted:.1f}'})",
                    )
            axes.set(
                xlabel="exchange step (ms)",
                ylabel=f"{name} (%)",
                xticks=[step / ms for step in STEPS],
            )
            axes.xaxis.set_major_formatter("{x:g}")
            axes.xaxis.set_minor_formatter("")
            legend(axes, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)
    return file


STUDY = Study(
    "fig19",
    "Figure 19: time steps and exchange steps",
    5.2,
    rows,
    tasks,
    draw,
    (
        "Convergence: the internal steps stay as they are, only the exchange step changes, so that the error is that of the coupling; "
        "the reference exchanges every 1e-5 s, sand first.",
        "paper and impulse: sand first, with held inputs and last forces, or extrapolated kinematics and mean forces; jacobi: all at "
        "once, with held inputs and last forces, or extrapolated.",
    ),
)
