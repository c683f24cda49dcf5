"""Figures 17 and 18: transmitted force and energy of the beam over time.

Tests 4 (soft sand) and 10 (hard sand).
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rockshed.components.common.units import cm, kgf, ms

from ...cases import sonoda1993
from ...metrics.filtering import load_cell
from ...metrics.names import (
    BEAM_ENERGY,
    BEAM_ENERGY_FROM_STRAIN,
    BEAM_SHARE,
    BEAM_SHARE_FROM_STRAIN,
    PEAK_TRANSMITTED,
)
from ...runs.batch import COMPLETE, Outcome, Task
from ..study import Measure, Outcomes, Row, Study, origin, row_of_runs, verdict
from .laboratory import ALL_MODELS, BOX_MASS, BOXED, SEED_NOTE, SHORT_IMPACTS, impacts

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TESTS = (4, 10)
SHARE = (1.0, 3.0)
"""Part (%) of the ball's energy that reaches the beam, as the paper sums it up."""
WITHIN = 25.0
"""Deviation (%) of the computed energy from the measured one, by the paper's conclusion 4."""
_MODELS = (*ALL_MODELS, BOXED)
_ENERGY = kgf * cm


def tasks(quick: bool) -> list[Task]:
    """Return both tests with every model, those of table 2."""
    return [task for number in TESTS for model in _MODELS for task in impacts(number, model, quick)]


def rows(outcomes: Outcomes) -> list[Row]:
    """Return peaks of force and energy, and the part of the ball's energy."""
    return [
        row
        for number in TESTS
        for model in _MODELS
        for row in _of_test(number, impacts(number, model, outcomes.quick), outcomes)
    ] + [_share(), *_conclusion_4(outcomes)]


def _of_test(number: int, runs: Sequence[Task], outcomes: Outcomes) -> list[Row]:
    """Return force and energies of a test with one model."""
    by_springs = f"peak beam energy, eqs (5) and (6), test {number}"
    share_by_springs = f"peak beam energy, eqs (5) and (6) / impact energy, test {number}"
    return [
        _force(number, runs, outcomes),
        _in_cells(number, runs, outcomes),
        row_of_runs(Measure(by_springs, "kgf cm", _ENERGY, BEAM_ENERGY), runs, outcomes),
        row_of_runs(
            Measure(
                f"peak beam energy, eq. (7), test {number}",
                "kgf cm",
                _ENERGY,
                BEAM_ENERGY_FROM_STRAIN,
            ),
            runs,
            outcomes,
            experiment=sonoda1993.BEAM_ENERGY[number] / _ENERGY,
            note="experiment: about, read from fig. 18",
        ),
        row_of_runs(Measure(share_by_springs, "%", 0.01, BEAM_SHARE), runs, outcomes),
        row_of_runs(
            Measure(
                f"peak beam energy, eq. (7) / impact energy, test {number}",
                "%",
                0.01,
                BEAM_SHARE_FROM_STRAIN,
            ),
            runs,
            outcomes,
            experiment=100.0 * sonoda1993.BEAM_ENERGY[number] / _impact_energy(),
        ),
    ]


def _force(number: int, runs: Sequence[Task], outcomes: Outcomes) -> Row:
    test = sonoda1993.tests()[number]
    paper = sonoda1993.known_of(test)[PEAK_TRANSMITTED].paper
    return row_of_runs(
        Measure(f"peak transmitted force, test {number}", "kgf", kgf, PEAK_TRANSMITTED),
        runs,
        outcomes,
        paper.value / kgf if paper else None,
        test.peak_force / kgf,
        "paper: its table 5, inter- or extrapolated",
    )


def _in_cells(number: int, runs: Sequence[Task], outcomes: Outcomes) -> Row:
    """Return the peak in the load cells, which stand between box and beam."""
    return row_of_runs(
        Measure(
            f"peak in load cells of {sonoda1993.LOAD_CELL / 1e3:g} kHz under the box, test "
            f"{number}",
            "kgf",
            kgf,
            under_box,
        ),
        runs,
        outcomes,
        experiment=sonoda1993.tests()[number].peak_force / kgf,
        note="transmitted force less what accelerates the box",
    )


def under_box(outcome: Outcome) -> float:
    """Return the peak (N) that load cells between box and beam show."""
    force = outcome.series["sand.transmitted_force"] - outcome.series["beam.box.inertia_force"]
    return float(load_cell(outcome.series["time"], force, sonoda1993.LOAD_CELL).max())


def _conclusion_4(outcomes: Outcomes) -> list[Row]:
    """Return for every model whether its energies are as near as the paper says of its own."""
    return [_nearness(model, outcomes) for model in _MODELS]


def _nearness(model: str, outcomes: Outcomes) -> Row:
    """Return the largest deviation of a model's energy by (7) from the measured one."""
    runs = {number: impacts(number, model, outcomes.quick) for number in TESTS}
    energy = Measure("", "kgf cm", _ENERGY, BEAM_ENERGY_FROM_STRAIN)
    found = {
        number: row_of_runs(
            energy, runs[number], outcomes, experiment=sonoda1993.BEAM_ENERGY[number] / _ENERGY
        )
        for number in TESTS
    }
    percent = [
        100.0 * deviation
        for row in found.values()
        if (deviation := row.deviation(row.experiment)) is not None
    ]
    whole = len(percent) == len(TESTS)
    worst = max(percent, key=abs) if whole else None
    each = ", ".join(f"test {n} {p:+.0f} %" for n, p in zip(TESTS, percent, strict=False))
    return Row(
        f"conclusion 4: beam energy within {WITHIN:g} % of the measured one",
        "%",
        computed=worst,
        paper=WITHIN,
        model=model,
        verdict=verdict(abs(worst) <= WITHIN) if worst is not None else "",
        note=f"eq. (7); {each}" if whole else "a test has no result",
        **origin([task for number in TESTS for task in runs[number]], outcomes),
    )


def _impact_energy() -> float:
    return 0.5 * sonoda1993.BALL_MASS * sonoda1993.BALL_SPEED**2


def _share() -> Row:
    """Return the paper's summary against the energies that it measured."""
    shares = [100.0 * sonoda1993.BEAM_ENERGY[number] / _impact_energy() for number in TESTS]
    return Row(
        "measured energy of the beam is 1 to 3 % of the ball's",
        "%",
        experiment=shares[-1],
        model="claim",
        verdict=verdict(SHARE[0] - 0.5 < min(shares) and max(shares) < SHARE[1] + 0.5),
        note=f"{shares[0]:.1f} % in test {TESTS[0]}, {shares[1]:.1f} % in test {TESTS[1]}; rounded "
        "to whole percent",
    )


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw fig. 17, force, and fig. 18, energy; test 4 at the left, test 10 at the right."""
    return [_fig_17(outcomes, folder / "fig17.png"), _fig_18(outcomes, folder / "fig18.png")]


_CAPTION = (
    "{} of Sonoda et al. 1993: (a) test 4, (b) test 10. Of the experiment only the peak is known "
    "here."
)


def _fig_17(outcomes: Outcomes, file: Path) -> Path:
    from ...pictures.style import WIDTH, captioned, legend, reference_line

    with captioned([_CAPTION.format("Fig. 17")], file, WIDTH, 3.2) as made:
        panels = made.subplots(1, 2, sharey=True)
        for axes, number, letter in zip(panels, TESTS, "ab", strict=True):
            _draw_column(axes, number, outcomes, "sand.transmitted_force", kgf)
            reference_line(axes, sonoda1993.tests()[number].peak_force / kgf, "peak measured")
            axes.set(xlabel="time (ms)", title=f"({letter}) test {number}", xlim=(0.0, None))
        panels[0].set_ylabel("transmitted force (kgf)")
        legend(panels[0])
    return file


def _fig_18(outcomes: Outcomes, file: Path) -> Path:
    from ...pictures.style import WIDTH, captioned, legend, reference_line

    with captioned([_CAPTION.format("Fig. 18")], file, WIDTH, 3.2) as made:
        panels = made.subplots(1, 2, sharey=True)
        for axes, number, letter in zip(panels, TESTS, "ab", strict=True):
            _draw_column(
                axes, number, outcomes, "beam.energy.elastic", _ENERGY, "-", "eqs (5), (6)"
            )
            _draw_column(
                axes, number, outcomes, "beam.energy.strain_estimate", _ENERGY, ":", "eq. (7)"
            )
            reference_line(axes, sonoda1993.BEAM_ENERGY[number] / _ENERGY, "peak measured, eq. (7)")
            axes.set(xlabel="time (ms)", title=f"({letter}) test {number}", xlim=(0.0, None))
        panels[0].set_ylabel("energy of the beam (kgf cm)")
        legend(panels[0])
    return file


def _draw_column(
    axes: "Axes",
    number: int,
    outcomes: Outcomes,
    column: str,
    scale: float,
    dashes: str = "-",
    equation: str = "",
) -> None:
    """Draw a variable of a test over time, a line for each model."""
    from ...pictures.style import BEAM, ROCK, TRANSMITTED

    for model, colour in zip(ALL_MODELS, (TRANSMITTED, ROCK, BEAM), strict=True):
        outcome = outcomes.of(impacts(number, model, outcomes.quick)[0])
        if outcome.status == COMPLETE:
            label = ", ".join(filter(None, (model, equation)))
            time = outcome.series["time"] / ms
            values = outcome.series[column] / scale
            axes.plot(time, values, dashes, color=colour, label=label, linewidth=1.1)


STUDY = Study(
    "figs17-18",
    "Figures 17 and 18: force and energy on the beam, tests 4 and 10",
    5.1,
    rows,
    tasks,
    draw,
    (
        SEED_NOTE,
        "The figures show the first seed of each model.",
        f"With the box of {BOX_MASS:g} kg the mass is assumed, as the paper gives none; it moves "
        "with the beam, between the sand and the load cells.",
        "The experiment's energies follow from the strain at midspan by eq. (7).",
    ),
    stands_on=SHORT_IMPACTS,
)
