"""Like with like: predictions of the measured peak forces, all fitted to the same measurements.

A law of the sand, computed, against laws that need no computation: each has seen the same tests and
predicts the same others.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, stdev
from textwrap import fill
from typing import Any

from ...cases import sonoda1993
from ...cases.sonoda1993 import Test
from ...metrics.names import PEAK_TRANSMITTED
from ...runs.batch import COMPLETE, Task
from ..statistics import (
    Predictor,
    by_power_law,
    constant,
    in_proportion,
    leave_one_out,
    mean_absolute_error,
    mean_of_equals,
)
from ..study import Outcomes, Row, Study, origin
from .laboratory import ALL_MODELS, SHORT_IMPACTS, impacts
from .table2 import paper_force
from .twelve import BOX_TESTS, error, twelve

BASELINE = "baseline"
"""In the place of a model: a prediction without a computation."""


@dataclass(frozen=True)
class Prediction:
    """A way to predict the peak force of a test from measured ones.

    Attributes
    ----------
    name : str
        For the reader.
    x : mapping of int to float
        What it knows of each test, by the test's number.
    predictor : callable
        From the x and the forces of some tests, and the x of another, to its force.
    where : mapping
        Keywords of its rows: model, origin.
    """

    name: str
    x: Mapping[int, float]
    predictor: Predictor
    where: Mapping[str, Any]

    def of(self, known: Sequence[Test], asked: Sequence[Test]) -> float:
        """Return the mean absolute error (%) over tests that are predicted from others."""
        x = [self.x[test.number] for test in known]
        y = [test.peak_force for test in known]
        predicted = [self.predictor(x, y, self.x[test.number]) for test in asked]
        return 100.0 * mean_absolute_error(predicted, [test.peak_force for test in asked])

    def without_each(self, tests: Sequence[Test]) -> float:
        """Return the mean absolute error (%) over tests, each predicted from all the others."""
        x = [self.x[test.number] for test in tests]
        y = [test.peak_force for test in tests]
        return 100.0 * mean_absolute_error(leave_one_out(x, y, self.predictor), y)


def _every() -> list[Test]:
    return list(sonoda1993.tests().values())


def _held_out() -> list[Test]:
    """Return the tests in the other box, to which nothing is fitted."""
    return [test for test in _every() if test not in twelve()]


def _of_sand(name: str) -> list[Test]:
    return [test for test in twelve() if test.sand == name]


TRIALS: Mapping[str, Callable[[Prediction], float]] = {
    f"{BOX_TESTS}, each from the eleven others": lambda p: p.without_each(twelve()),
    "tests 13 to 16, from tests 1 to 12": lambda p: p.of(twelve(), _held_out()),
    "sand B, from sand A": lambda p: p.of(_of_sand("A"), _of_sand("B")),
    "sand A, from sand B": lambda p: p.of(_of_sand("B"), _of_sand("A")),
}
"""Trials by what is predicted from what; of a sand the tests 1 to 12."""


def tasks(quick: bool) -> list[Task]:
    """Return the impacts of sixteen tests, each with every model: those of table 2."""
    return [
        task
        for number in sonoda1993.tests()
        for model in ALL_MODELS
        for task in impacts(number, model, quick)
    ]


# ------------------------------------------------------------------ predictions


def baselines() -> list[Prediction]:
    """Return the predictions that need no computation."""
    every = _every()

    def made(name: str, x: Callable[[Test], float], predictor: Predictor, note: str) -> Prediction:
        known = {test.number: x(test) for test in every}
        return Prediction(name, known, predictor, {"model": BASELINE, "note": note})

    return [
        made("a constant", lambda test: 1.0, constant, "mean of the known forces"),
        made(
            "two constants",
            lambda test: float(test.compaction > 0.0),
            mean_of_equals,
            "means of the known forces, poured and compacted",
        ),
        made(
            "a power law in k",
            lambda test: test.static_stiffness,
            by_power_law,
            "fitted to the known forces",
        ),
        made(
            "the paper's trend, level fitted",
            paper_force,
            in_proportion,
            "its table 5, h = 0.2, times a factor fitted to the known forces",
        ),
    ]


def of_model(model: str, outcomes: Outcomes) -> Prediction | None:
    """Return the prediction by the computed forces of a model, with one factor fitted.

    Parameters
    ----------
    model : str
        Model of the sand.
    outcomes : Outcomes
        Outcomes of all runs.

    Returns
    -------
    Prediction or None
        None if a test has no result, or no force: nothing is in proportion to zero.
    """
    forces = [_forces(model, number, outcomes) for number in sonoda1993.tests()]
    if not all(values and mean(values) > 0.0 for values in forces):
        return None
    x = {n: mean(values) for n, values in zip(sonoda1993.tests(), forces, strict=True)}
    where = {
        **_origin(model, outcomes),
        "note": "mean over the seeds, times a factor fitted to the known forces",
    }
    return Prediction(f"{model}, level fitted", x, in_proportion, where)


def _forces(model: str, number: int, outcomes: Outcomes) -> list[float]:
    """Return the peak forces (N) of a test, one for each seed that has a result."""
    each = [outcomes.of(task) for task in impacts(number, model, outcomes.quick)]
    return [outcome.metrics[PEAK_TRANSMITTED] for outcome in each if outcome.status == COMPLETE]


def _origin(model: str, outcomes: Outcomes) -> dict[str, Any]:
    runs = [
        task for number in sonoda1993.tests() for task in impacts(number, model, outcomes.quick)
    ]
    where = origin(runs, outcomes)
    of_a_test = ("modulus", "cohesion", "solid_fraction")
    options = {name: value for name, value in where["options"].items() if name not in of_a_test}
    seeds = list(dict.fromkeys(where["seeds"]))
    return {"model": model, **where, "options": options, "seeds": seeds}


# ------------------------------------------------------------------ rows


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the error of every prediction in every trial, then that of single samples."""
    listed = [row for prediction in baselines() for row in _of_prediction(prediction)]
    for model in ALL_MODELS:
        prediction = of_model(model, outcomes)
        where = _origin(model, outcomes)
        if prediction is None:
            listed.append(Row(_quantity(model, "all"), "%", note="a test has no result", **where))
            continue
        listed += _of_prediction(prediction)
        listed += [_as_it_stands(prediction, where), _of_single_samples(model, outcomes, where)]
    return listed


def _quantity(name: str, trial: str) -> str:
    return f"mean absolute error of {name}: {trial}"


def _of_prediction(prediction: Prediction) -> list[Row]:
    return [
        Row(
            _quantity(prediction.name, trial),
            "%",
            computed=error_of(prediction),
            **prediction.where,
        )
        for trial, error_of in TRIALS.items()
    ]


def _as_it_stands(prediction: Prediction, where: Mapping[str, Any]) -> Row:
    """Return the error on the tests that nothing was fitted to, without a factor."""
    return Row(
        _quantity(str(where["model"]), "tests 13 to 16, as it stands"),
        "%",
        computed=error(prediction.x, _held_out()),
        note="no factor; the cohesion of the one law from each test's k",
        **where,
    )


def _of_single_samples(model: str, outcomes: Outcomes, where: Mapping[str, Any]) -> Row:
    """Return the error over tests 1 to 12 of one sample alone: mean and spread over the seeds."""
    by_test = {test.number: _forces(model, test.number, outcomes) for test in twelve()}
    samples = range(min(map(len, by_test.values())))
    errors = [error({n: forces[i] for n, forces in by_test.items()}, twelve()) for i in samples]
    return Row(
        _quantity(model, f"{BOX_TESTS}, a single sample"),
        "%",
        computed=mean(errors),
        spread=stdev(errors) if len(errors) > 1 else None,
        note=f"of {len(errors)} samples the least {min(errors):.1f}, the largest "
        f"{max(errors):.1f} %",
        **where,
    )


# ------------------------------------------------------------------ figure


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the errors of every prediction, a panel for each trial."""
    from ...pictures.style import GREY, TRANSMITTED, WIDTH, captioned

    file = folder / "prediction.png"
    words = (
        "Table 2 of Sonoda et al. 1993: mean absolute error of peak forces predicted from measured "
        "ones. Grey: without a computation; blue: computed, mean over the seeds, one factor fitted."
    )
    found = [p for model in ALL_MODELS if (p := of_model(model, outcomes)) is not None]
    shown = [*baselines(), *found]
    with captioned([words], file, WIDTH, 3.4) as made:
        panels = made.subplots(1, len(TRIALS), sharey=True)
        for axes, (trial, error_of) in zip(panels, TRIALS.items(), strict=True):
            errors = [error_of(prediction) for prediction in shown]
            colours = [GREY if p.where["model"] == BASELINE else TRANSMITTED for p in shown]
            bars = axes.barh([p.name for p in shown], errors, color=colours)
            axes.bar_label(bars, fmt="%.1f", padding=2, fontsize=6.5)
            axes.set(xlabel="error (%)", xlim=(0.0, 1.25 * max(errors)))
            axes.set_title(fill(trial, 20), fontsize=7.5)
        panels[0].invert_yaxis()
    return [file]


STUDY = Study(
    "prediction",
    "Predictions of the peak force, like with like",
    4.95,
    rows,
    tasks,
    draw,
    (
        "Every prediction is fitted to the same measured forces and asked for the same others. "
        "Models of the sand have one factor fitted. The paper's sand has each test's E_bar, the "
        "one law each test's cohesion: both from the measured k, which the power law has too.",
        "E_bar, unloading ratio and solid fractions of the one law were chosen with tests 1 to 12 "
        "in view: only tests 13 to 16 are new to all of it.",
    ),
    stands_on=SHORT_IMPACTS,
)
