"""One sand law: one contact law with one stiffness for static test, laboratory, rigid base and girders; what trades off in it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean, stdev
from typing import Any

from rockshed.components.common.units import cm, kgf
from rockshed.components.sand_cushion.models import ONE_LAW_MODULUS, ONE_LAW_UNLOADING, ROLLING

from ...cases import full_scale, sonoda1993
from ...cases.sand_models import DENSE, LOOSE
from ...cases.static_loading import NAME as STATIC_TEST
from ...cases.static_loading import SPEED
from ...core.system.system import Value
from ...metrics.names import (
    BEAM_SHARE_FROM_STRAIN,
    PEAK_TRANSMITTED,
    SETTLED_RATIO,
    STATIC_DEPARTURE,
    STATIC_STIFFNESS,
)
from ...runs.batch import COMPLETE, Task
from ...runs.job import Request
from ..study import Measure, Outcomes, Row, Study, detail, origin, row_of_runs
from .laboratory import ONE_LAW, STOP
from .static_loading import HASTE
from .twelve import BOX_TESTS, error, exponent, twelve

SEEDS = range(1, 9)
"""Packings of the static tests, and of the law itself."""
VARIED_SEEDS = range(1, 4)
"""Packings of a law with one number changed."""
RIGID_BASE = "rigid-base-crushed"
_STATIC_STOP = 6.6
"""End of a static test (s): the surface of a packing is uneven, and the disc starts well above it."""
_KGF_PER_CM2 = kgf / cm**2


@dataclass(frozen=True)
class Law:
    """The law with something changed in it, for all tests alike. values: by ``sand.parameter``."""

    name: str
    values: Mapping[str, Value] = field(default_factory=dict)


LAWS = (
    Law(ONE_LAW),
    Law("unloading ratio 1 (elastic)", {"sand.unloading_ratio": 1.0}),
    Law("unloading ratio 2", {"sand.unloading_ratio": 2.0}),
    Law("unloading ratio 6", {"sand.unloading_ratio": 6.0}),
    Law("E_bar 50", {"sand.modulus": 50.0 * _KGF_PER_CM2}),
    Law("rolling resistance 0.1", {"sand.rolling_resistance": 0.1}),
)
"""What is compared; one line each."""


def seeds(law: Law, quick: bool) -> Sequence[int]:
    """Packings of a law."""
    return SEEDS[:1] if quick else SEEDS if law.name == ONE_LAW else VARIED_SEEDS


def laws(quick: bool) -> Sequence[Law]:
    """The laws of a reproduction; in a quick one only the law itself."""
    return LAWS[:1] if quick else LAWS


# ------------------------------------------------------------------ runs


def static_tests(test: sonoda1993.Test, quick: bool) -> list[Task]:
    """The static test on the soil of a test, one for each packing; in a quick study faster."""
    state, faster = sonoda1993.soil(test), HASTE if quick else 1
    values = {
        "sand.cohesion": state.cohesion,
        "sand.solid_fraction": state.solid_fraction,
        "rock.velocity0.y": -SPEED * faster,
    }
    options = {"stop_time": _STATIC_STOP / faster}
    return [
        Task(
            Request(STATIC_TEST, {**values, "sand.seed": seed}, options=options, model=ONE_LAW),
            ONE_LAW,
            seed,
        )
        for seed in (SEEDS[:1] if quick else SEEDS)
    ]


def impacts(case: str, law: Law, quick: bool, stop_time: float = STOP) -> list[Task]:
    """An impact of the laboratory or at full scale, one for each packing."""
    return [
        Task(
            Request(
                case,
                {**law.values, "sand.seed": seed},
                coupling="impulse",
                options={"stop_time": stop_time},
                model=ONE_LAW,
            ),
            law.name,
            seed,
        )
        for seed in seeds(law, quick)
    ]


def _laboratory(test: sonoda1993.Test, law: Law, quick: bool) -> list[Task]:
    return impacts(sonoda1993.case_name(test.number), law, quick)


def _girders(impact: full_scale.Impact, law: Law, quick: bool) -> list[Task]:
    return impacts(impact.name, law, quick, _GIRDERS_STOP)


def _rigid(law: Law, quick: bool) -> list[Task]:
    return impacts(RIGID_BASE, law, quick, full_scale.impacts()[RIGID_BASE].stop_time)


_GIRDERS_STOP = 0.15
_SPANS = [impact for impact in full_scale.impacts().values() if impact.span]


def tasks(quick: bool) -> list[Task]:
    """Static tests on twelve soils; for every law twelve impacts in the laboratory, three on girders, one on the rigid base."""
    return [task for test in twelve() for task in static_tests(test, quick)] + [
        task
        for law in laws(quick)
        for group in (
            *(_laboratory(test, law, quick) for test in twelve()),
            *(_girders(impact, law, quick) for impact in _SPANS),
            _rigid(law, quick),
        )
        for task in group
    ]


# ------------------------------------------------------------------ rows


def rows(found: Outcomes) -> list[Row]:
    """The static tests; then for every law what it gives everywhere."""
    return [
        *(row for test in twelve() for row in _static_rows(test, found)),
        *_static_error(found),
        *(row for law in laws(found.quick) for row in _of_law(law, found)),
    ]


def _static_rows(test: sonoda1993.Test, found: Outcomes) -> list[Row]:
    runs, state = static_tests(test, found.quick), sonoda1993.soil(test)
    said = f"cohesion {state.cohesion / _KGF_PER_CM2:g} kgf/cm2 (calibrated to this k), solid fraction {state.solid_fraction:g}"
    return [
        row_of_runs(
            Measure(f"static k, test {test.number}", "kgf/cm", kgf / cm, STATIC_STIFFNESS),
            runs,
            found,
            experiment=test.static_stiffness / kgf * cm,
            note=said,
        ),
        detail(
            row_of_runs(
                Measure(
                    f"departure of the load from the secant line / largest load, test {test.number}",
                    "%",
                    0.01,
                    STATIC_DEPARTURE,
                ),
                runs,
                found,
            )
        ),
    ]


def _static_error(found: Outcomes) -> list[Row]:
    listed = [_static_rows(test, found)[0] for test in twelve()]
    pairs = [
        (row.computed, row.experiment)
        for row in listed
        if row.computed is not None and row.experiment is not None
    ]
    complete = len(pairs) == len(listed)
    return [
        Row(
            f"mean absolute error of the static k, {BOX_TESTS}",
            "%",
            model=ONE_LAW,
            computed=100.0 * mean(abs(c / e - 1.0) for c, e in pairs) if complete else None,
            note="cohesions are calibrated to these" if complete else "a test has no result",
            **_origin(
                [task for test in twelve() for task in static_tests(test, found.quick)], found
            ),
        )
    ]


def _origin(runs: Sequence[Task], found: Outcomes) -> dict[str, Any]:
    """Where a figure over several tests comes from: without what belongs to one of them."""
    where = origin(runs, found)
    return {
        **where,
        "options": {key: value for key, value in where["options"].items() if key not in _OF_A_TEST},
    }


_OF_A_TEST = ("cohesion", "solid_fraction", "internal_step")


def _of_law(law: Law, found: Outcomes) -> list[Row]:
    """Laboratory: error, exponent. Girders: energies and their largest factor to the experiment. Rigid base: ratio."""
    energies = [_energy(impact, law, found) for impact in _SPANS]
    return [
        *_laboratory_rows(law, found),
        *energies,
        _largest_factor(energies, law, found),
        row_of_runs(
            Measure("rigid base: settled ratio transmitted / rock", "1", 1.0, SETTLED_RATIO),
            _rigid(law, found.quick),
            found,
            2.0,
            note="paper: about twice, with its elastic sand",
        ),
    ]


def _laboratory_rows(law: Law, found: Outcomes) -> list[Row]:
    """Of the mean over the packings; the spread is that of the single packings' own figures."""
    of_seeds = [_forces(law, place, found) for place in range(len(seeds(law, found.quick)))]
    complete = [forces for forces in of_seeds if len(forces) == len(twelve())]
    average = (
        {test.number: mean(forces[test.number] for forces in complete) for test in twelve()}
        if complete
        else {}
    )
    where = _origin(
        [task for test in twelve() for task in _laboratory(test, law, found.quick)], found
    )
    lost = len(of_seeds) - len(complete)
    note = f"{lost} of {len(of_seeds)} packings have a test without result" if lost else ""

    def row(quantity: str, unit: str, figure: Any, measured: float | None) -> Row:
        own = [figure(forces) for forces in complete]
        return Row(
            quantity,
            unit,
            None,
            measured,
            figure(average) if average else None,
            _spread(own),
            law.name,
            note=note,
            **where,
        )

    return [
        row(
            f"laboratory: mean absolute error of the peak force, {BOX_TESTS}",
            "%",
            lambda f: error(f, twelve()),
            None,
        ),
        row(
            f"laboratory: trend exponent of P against k, {BOX_TESTS}",
            "1",
            exponent,
            exponent({test.number: test.peak_force for test in twelve()}),
        ),
    ]


def _forces(law: Law, place: int, found: Outcomes) -> dict[int, float]:
    """Peak forces (N) of a packing by the number of the test."""
    chosen = {
        test.number: found.of(_laboratory(test, law, found.quick)[place]) for test in twelve()
    }
    return {
        number: outcome.metrics[PEAK_TRANSMITTED]
        for number, outcome in chosen.items()
        if outcome.status == COMPLETE
    }


def _spread(values: Sequence[float]) -> float | None:
    return stdev(values) if len(values) > 1 else None


def _energy(impact: full_scale.Impact, law: Law, found: Outcomes) -> Row:
    known = full_scale.known_of(impact)[BEAM_SHARE_FROM_STRAIN].experiment
    return row_of_runs(
        Measure(
            f"girders of {impact.span:g} m: energy / rock's by eq. (7)",
            "%",
            0.01,
            BEAM_SHARE_FROM_STRAIN,
        ),
        _girders(impact, law, found.quick),
        found,
        experiment=100.0 * known.value if known else None,
    )


def _largest_factor(energies: Sequence[Row], law: Law, found: Outcomes) -> Row:
    pairs = [(row.computed, row.experiment) for row in energies if row.computed and row.experiment]
    complete = len(pairs) == len(energies)
    return Row(
        "girders: largest factor between computed and measured energy",
        "1",
        model=law.name,
        computed=max(max(c / e, e / c) for c, e in pairs) if complete else None,
        note="" if complete else "a span has no result",
        **_origin(
            [task for impact in _SPANS for task in _girders(impact, law, found.quick)], found
        ),
    )


# ------------------------------------------------------------------ figure


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Computed over measured, everywhere; and the trade-off between girders and rigid base."""
    return [
        _parity(listed, folder / "one-law.png"),
        *_trade_off(listed, folder / "one-law-trade-off.png", found),
    ]


def _parity(listed: Sequence[Row], file: Path) -> Path:
    from ...pictures.style import INK, ROCK, SAND, WIDTH, captioned

    own = [row for row in listed if row.model == ONE_LAW and row.computed is not None]
    groups: Mapping[str, tuple[str, str, str]] = {
        "static k, test": ("secant spring constant k", "kgf/cm", SAND),
        "girders of": ("girders' energy / rock's", "%", ROCK),
    }
    with captioned(
        [
            "One contact law for all tests (model one-law); bars: standard deviation over packings. The cohesion of each "
            "test is calibrated to its k; peak forces: table 2."
        ],
        file,
        WIDTH,
        3.2,
    ) as made:
        for axes, (begin, (name, unit, colour)) in zip(made.subplots(1, 2), groups.items()):
            rows_ = [
                row for row in own if row.quantity.startswith(begin) and row.experiment is not None
            ]
            axes.errorbar(
                [row.experiment or 0.0 for row in rows_],
                [row.computed or 0.0 for row in rows_],
                [row.spread or 0.0 for row in rows_],
                fmt="o",
                color=colour,
                markersize=4,
                linewidth=0.8,
            )
            top = 1.1 * max(
                [row.experiment or 0.0 for row in rows_] + [row.computed or 0.0 for row in rows_],
                default=1.0,
            )
            axes.plot([0.0, top], [0.0, top], color=INK, linewidth=0.8)
            axes.set(
                xlabel=f"measured {name} ({unit})",
                ylabel=f"computed ({unit})",
                xlim=(0.0, top),
                ylim=(0.0, None),
            )
    return file


def _trade_off(listed: Sequence[Row], file: Path, found: Outcomes) -> list[Path]:
    from ...pictures.style import GREY, INK, TRANSMITTED, WIDTH, captioned

    if len(laws(found.quick)) < 2:
        return []
    of = {(row.model, row.quantity): row for row in listed}
    factor, ratio, lab = (
        "girders: largest factor between computed and measured energy",
        "rigid base: settled ratio transmitted / rock",
        f"laboratory: mean absolute error of the peak force, {BOX_TESTS}",
    )
    with captioned(
        [
            "What one number of the law moves: girders against rigid base (left) and laboratory (right). Lines: aims. "
            "Eight packings of the law itself, three of the others."
        ],
        file,
        WIDTH,
        3.6,
    ) as made:
        for axes, quantity, aim, name in zip(
            made.subplots(1, 2),
            (ratio, lab),
            (1.8, 7.5),
            ("rigid base: settled ratio", "laboratory: mean absolute error (%)"),
        ):
            for law in LAWS:
                x, y = of[law.name, factor].computed, of[law.name, quantity].computed
                if x is not None and y is not None:
                    axes.plot(
                        x, y, "o", color=INK if law.name == ONE_LAW else TRANSMITTED, markersize=5
                    )
                    side = (
                        -1 if x > _FAR_FACTOR else 1
                    )  # the name beside the point stays in the picture
                    axes.annotate(
                        law.name,
                        (x, y),
                        textcoords="offset points",
                        xytext=(4 * side, 3),
                        fontsize=6,
                        ha="right" if side < 0 else "left",
                    )
            axes.axvline(1.15, color=GREY, linestyle="--", linewidth=0.8)
            axes.axhline(aim, color=GREY, linestyle="--", linewidth=0.8)
            axes.set(xlabel="girders: largest factor to the measured energy", ylabel=name)
    return [file]


_FAR_FACTOR = 1.6


STUDY = Study(
    "one-law",
    "One sand law for static test, laboratory, rigid base and girders",
    8.0,
    rows,
    tasks,
    draw,
    (
        f"Discs ±25 % in size that turn, rolling resistance {ROLLING:g}, E_bar {ONE_LAW_MODULUS:g} kgf/cm2, unloading ratio "
        f"{ONE_LAW_UNLOADING:g}, phi 30 degrees, h 0.2, 0.0018 kgf/cm3 as unit weight of the layer, for all tests.",
        f"State of the soil: solid fraction {LOOSE:g} as poured, {DENSE:g} compacted and at full scale; cohesion by Rumpf from each "
        "test's static k; 0.05 kgf/cm2 at full scale, where nothing is known.",
        "Calibrated: E_bar, unloading ratio and the two solid fractions (to the twelve peak forces and table 6), the cohesions (to k).",
        "Mean and standard deviation over eight packings, three where one number of the law is changed; with --quick one packing.",
    ),
)
