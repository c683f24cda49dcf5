"""Table 2: measured and computed peak transmitted force of all sixteen tests."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockshed.components.common.units import cm, kgf

from ...cases import sonoda1993
from ...cases.sonoda1993 import Test
from ...metrics.filtering import load_cell
from ...metrics.names import PEAK_TRANSMITTED
from ...runs.batch import Outcome, Task
from ..statistics import exponent_error, power_law
from ..study import Measure, Outcomes, Row, Study, origin, row_of_runs
from .laboratory import ALL_MODELS, ONE_LAW, SEED_NOTE, SHORT_IMPACTS, impacts
from .twelve import BOX_TESTS, error, exponent, twelve

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def paper_force(test: Test) -> float:
    """Return the force (N) of a test by the paper's own table 5."""
    reference = sonoda1993.known_of(test)[PEAK_TRANSMITTED].paper
    assert reference is not None
    return reference.value


def tasks(quick: bool) -> list[Task]:
    """Return the impacts of sixteen tests, each with every model."""
    return [
        task
        for number in sonoda1993.tests()
        for model in ALL_MODELS
        for task in impacts(number, model, quick)
    ]


def rows(outcomes: Outcomes) -> list[Row]:
    """Return each test, then errors and trends over the tests."""
    listed = []
    for through, figure in _SEEN.items():
        each = {
            model: {
                number: _of_test(test, model, outcomes, through, figure)
                for number, test in sonoda1993.tests().items()
            }
            for model in ALL_MODELS
        }
        listed += [each[model][number] for number in sonoda1993.tests() for model in ALL_MODELS]
        listed += [
            row
            for model in ALL_MODELS
            for row in _over_tests(model, each[model], outcomes, through)
        ]
    return listed


def through_load_cell(outcome: Outcome) -> float:
    """Return the peak (N) of the transmitted force as the load cells under the beam show it."""
    return float(
        load_cell(
            outcome.series["time"], outcome.series["sand.transmitted_force"], sonoda1993.LOAD_CELL
        ).max()
    )


_SEEN: Mapping[str, str | Callable[[Outcome], float]] = {
    "": PEAK_TRANSMITTED,
    f" through a load cell of {sonoda1993.LOAD_CELL / 1e3:g} kHz": through_load_cell,
}
"""Metric of the force by the words for how it is seen."""


def _of_test(
    test: Test,
    model: str,
    outcomes: Outcomes,
    through: str,
    figure: str | Callable[[Outcome], float],
) -> Row:
    return row_of_runs(
        Measure(f"peak transmitted force{through}, test {test.number}", "kgf", kgf, figure),
        impacts(test.number, model, outcomes.quick),
        outcomes,
        paper_force(test) / kgf,
        test.peak_force / kgf,
        "paper: its table 5, h = 0.2, inter- or extrapolated to the test's E_bar",
    )


def _over_tests(model: str, each: Mapping[int, Row], outcomes: Outcomes, through: str) -> list[Row]:
    """Return mean error and trend over the tests.

    A test without a result makes them empty.
    """
    computed = {
        number: row.computed * kgf for number, row in each.items() if row.computed is not None
    }
    where = _origin(model, each, outcomes)
    complete = len(computed) == len(each)
    if not complete:
        where["note"] = "a test has no result"
    every = list(sonoda1993.tests().values())
    return [
        Row(
            f"mean absolute error{through}, {BOX_TESTS}",
            "%",
            _paper_error(),
            computed=error(computed, twelve()) if complete else None,
            **where,
        ),
        Row(
            f"mean absolute error{through}, all sixteen tests",
            "%",
            computed=error(computed, every) if complete else None,
            **where,
        ),
        Row(
            f"trend exponent of P against k{through}, {BOX_TESTS}",
            "1",
            exponent({test.number: paper_force(test) for test in twelve()}),
            exponent({test.number: test.peak_force for test in twelve()}),
            exponent(computed) if complete else None,
            **where,
        ),
    ]


def _origin(model: str, numbers: Iterable[int], outcomes: Outcomes) -> dict[str, Any]:
    """Return the origin of a value over several tests: without the modulus, which differs."""
    runs = [task for number in numbers for task in impacts(number, model, outcomes.quick)]
    where = {"model": model, **origin(runs, outcomes)}
    where["options"] = {
        name: value for name, value in where["options"].items() if name != "modulus"
    }
    return where


def _paper_error() -> float:
    """Return the error (%) of the paper's own trend."""
    return error({test.number: paper_force(test) for test in twelve()}, twelve())


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw P against k in the layout of fig. 9, all axes logarithmic, measured and computed."""
    from ...pictures.style import BEAM, ROCK, TRANSMITTED, WIDTH, captioned

    file = folder / "table2.png"
    words = (
        "Table 2 of Sonoda et al. 1993; E_bar = k / 1.29 where table 4 gives none. Filled: box 1, "
        "open: box 2. Bars: standard deviation over seeds."
    )
    with captioned([words], file, WIDTH, 4.2) as made:
        axes = made.subplots()
        _measured(axes)
        for model, colour in (("calibrated", TRANSMITTED), ("literal", ROCK), (ONE_LAW, BEAM)):
            of_model = {row.quantity: row for row in listed if row.model == model}
            rows = {
                number: of_model[f"peak transmitted force, test {number}"]
                for number in sonoda1993.tests()
            }
            known = {number: row for number, row in rows.items() if row.computed is not None}
            _points(axes, model, colour, "o", known)
        _decorate(axes)
    return [file]


def _measured(axes: "Axes") -> None:
    """Draw the measurements and the power law through those of box 1."""
    from ...pictures.style import GREY, INK

    _points(
        axes,
        "measured",
        INK,
        "s",
        {t.number: Row("", "", computed=t.peak_force / kgf) for t in sonoda1993.tests().values()},
    )
    k = [_k(test) for test in twelve()]
    p = [test.peak_force / kgf for test in twelve()]
    factor, exponent = power_law(k, p)
    axes.plot(
        sorted(k),
        [factor * x**exponent for x in sorted(k)],
        "--",
        color=GREY,
        linewidth=1.0,
        label=f"fit to box 1: P ~ k^({exponent:.2f} ± {exponent_error(k, p):.2f})",
    )


def _k(test: Test) -> float:
    """Return the static k (kgf/cm) of a test."""
    return test.static_stiffness / kgf * cm


def _points(axes: "Axes", name: str, colour: str, mark: str, rows: Mapping[int, Row]) -> None:
    """Draw the forces of tests over k, with their spread."""
    for box, fill in ((1, colour), (2, "white")):
        tests = [
            test
            for number, test in sonoda1993.tests().items()
            if number in rows and test.box == box
        ]
        axes.errorbar(
            [_k(test) for test in tests],
            [rows[test.number].computed or 0.0 for test in tests],
            yerr=[rows[test.number].spread or 0.0 for test in tests],
            fmt=mark,
            color=colour,
            markersize=4.5,
            linewidth=0.8,
            markerfacecolor=fill,
            label=name if box == 1 else "_",
        )


def _decorate(axes: "Axes") -> None:
    from ...pictures.style import legend  # imports matplotlib

    axes.set(
        xscale="log",
        yscale="log",
        xlabel="secant spring constant k (kgf/cm)",
        ylabel="peak transmitted force P (kgf)",
        xticks=[15, 20, 30, 40, 60, 90],
        yticks=[300, 400, 500, 600, 700],
    )
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(lambda value, place: "")
    legend(axes)


STUDY = Study(
    "table2",
    "Table 2: peak transmitted force of the sixteen tests",
    4.9,
    rows,
    tasks,
    draw,
    (
        SEED_NOTE,
        "Errors and trends over tests are those of the mean over the seeds.",
        "Rows through a load cell: the same runs behind a causal low-pass of second order "
        "(Butterworth); the paper gives a natural frequency of 3200 Hz and a response up to about "
        "1 kHz. The box has no mass here; what one does is in figs 17 and 18.",
    ),
    stands_on=SHORT_IMPACTS,
)
