"""One contact law with one stiffness for static test, laboratory, rigid base and girders.

The law with one number changed shows what trades off in it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import mean, stdev
from typing import TYPE_CHECKING, Any

from rockshed.components.common.units import cm, kgf
from rockshed.components.sand_cushion.models import ONE_LAW_MODULUS, ONE_LAW_UNLOADING, ROLLING

from ...cases import full_scale, sonoda1993
from ...cases.sand_models import DENSE, LOOSE
from ...cases.static_loading import NAME as STATIC_TEST
from ...cases.static_loading import SPEED
from ...core.system.fields import Value
from ...metrics.names import (
    BEAM_ENERGY_FROM_STRAIN,
    BEAM_SHARE_FROM_STRAIN,
    PEAK_TRANSMITTED,
    SETTLED_RATIO,
    STATIC_DEPARTURE,
    STATIC_STIFFNESS,
)
from ...runs.batch import COMPLETE, Task
from ...runs.job import Request
from ..study import Measure, Outcomes, Row, Study, detail, origin, row_of_runs, shortened
from . import full_scale as full_scale_runs
from .laboratory import ONE_LAW, SHORT_IMPACTS, STOP
from .static_loading import HASTE
from .twelve import BOX_TESTS, error, exponent, twelve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SEEDS = range(1, 9)
"""Packings of the static tests, and of the law itself."""
VARIED_SEEDS = range(1, 4)
"""Packings of a law with one number changed."""
RIGID_BASE = "rigid-base-crushed"
_STATIC_STOP = 8.1
"""End of a static test (s): the disc starts well above the uneven surface of a packing."""
_KGF_PER_CM2 = kgf / cm**2
_RIGID_RATIO = "rigid base: settled ratio transmitted / rock"
_GIRDERS_FACTOR = "girders: largest factor between computed and measured energy"


@dataclass(frozen=True)
class Law:
    """The law with something changed in it, for all tests alike.

    Attributes
    ----------
    name : str
        For the reader.
    values : mapping of str to Value
        By ``sand.parameter``.
    """

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
"""Laws that are compared."""


def seeds(law: Law, quick: bool) -> Sequence[int]:
    """Return the seeds of the packings of a law."""
    if quick:
        return SEEDS[:1]
    return SEEDS if law.name == ONE_LAW else VARIED_SEEDS


def laws(quick: bool) -> Sequence[Law]:
    """Return the laws of a reproduction; in a quick one only the law itself."""
    return LAWS[:1] if quick else LAWS


# ------------------------------------------------------------------ runs


def static_tests(test: sonoda1993.Test, quick: bool) -> list[Task]:
    """Return the static test on the soil of a test, one for each packing; if quick, faster."""
    state = sonoda1993.soil(test)
    faster = HASTE if quick else 1
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
    """Return an impact of the laboratory or at full scale, one for each packing.

    Parameters
    ----------
    case : str
        Name of the case.
    law : Law
        Law of the sand.
    quick : bool
        One packing only.
    stop_time : float
        End of the runs (s).
    """
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


_GIRDERS_STOP = 0.16
_SPANS = [impact for impact in full_scale.impacts().values() if impact.span]


def tasks(quick: bool) -> list[Task]:
    """Return static tests on twelve soils, and the impacts for every law.

    They are twelve in the laboratory, three on girders and one on the rigid base.
    """
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


def _short() -> dict[str, Request]:
    """Return beginnings of the tests of the law itself; the static one is thirty times as fast."""
    push = shortened(static_tests(twelve()[0], True)[0], 0.12)
    fast = {**push.values, "rock.velocity0.y": -30.0 * SPEED}
    every = {**SHORT_IMPACTS, **full_scale_runs.SHORT_RIGID, **full_scale_runs.SHORT_GIRDERS}
    impacts_of_it = {name: request for name, request in every.items() if name.endswith(ONE_LAW)}
    return {f"push, {ONE_LAW}": replace(push, values=fast), **impacts_of_it}


# ------------------------------------------------------------------ rows


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the static tests, then for every law its results everywhere."""
    return [
        *(row for test in twelve() for row in _static_rows(test, outcomes)),
        *_static_error(outcomes),
        *(row for law in laws(outcomes.quick) for row in _of_law(law, outcomes)),
    ]


def _static_rows(test: sonoda1993.Test, outcomes: Outcomes) -> list[Row]:
    runs = static_tests(test, outcomes.quick)
    state = sonoda1993.soil(test)
    departure = f"departure of the load from the secant line / largest load, test {test.number}"
    return [
        row_of_runs(
            Measure(f"static k, test {test.number}", "kgf/cm", kgf / cm, STATIC_STIFFNESS),
            runs,
            outcomes,
            experiment=test.static_stiffness / kgf * cm,
            note=f"cohesion {state.cohesion / _KGF_PER_CM2:g} kgf/cm2 (calibrated to this k), "
            f"solid fraction {state.solid_fraction:g}",
        ),
        detail(row_of_runs(Measure(departure, "%", 0.01, STATIC_DEPARTURE), runs, outcomes)),
    ]


def _static_error(outcomes: Outcomes) -> list[Row]:
    listed = [_static_rows(test, outcomes)[0] for test in twelve()]
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
                [task for test in twelve() for task in static_tests(test, outcomes.quick)], outcomes
            ),
        )
    ]


def _origin(runs: Sequence[Task], outcomes: Outcomes) -> dict[str, Any]:
    """Return the origin of a value over several tests: without the parameters of one of them."""
    where = origin(runs, outcomes)
    return {
        **where,
        "options": {key: value for key, value in where["options"].items() if key not in _OF_A_TEST},
    }


_OF_A_TEST = ("cohesion", "solid_fraction", "internal_step")


def _of_law(law: Law, outcomes: Outcomes) -> list[Row]:
    """Return the results of a law.

    Laboratory: error and exponent; girders: energies and their largest factor to the experiment;
    rigid base: ratio.
    """
    energies = [_energy(impact, law, outcomes) for impact in _SPANS]
    return [
        *_laboratory_rows(law, outcomes),
        *energies,
        _largest_factor(energies, law, outcomes),
        *(_girders_ratio(impact, law, outcomes) for impact in _SPANS),
        row_of_runs(
            Measure(_RIGID_RATIO, "1", 1.0, SETTLED_RATIO),
            _rigid(law, outcomes.quick),
            outcomes,
            2.0,
            note="paper: about twice, with its elastic sand",
        ),
    ]


def _laboratory_rows(law: Law, outcomes: Outcomes) -> list[Row]:
    """Return error and exponent of the mean over the packings.

    The spread is that of the single packings' own values.
    """
    of_seeds = [_forces(law, place, outcomes) for place in range(len(seeds(law, outcomes.quick)))]
    complete = [forces for forces in of_seeds if len(forces) == len(twelve())]
    runs = [task for test in twelve() for task in _laboratory(test, law, outcomes.quick)]
    where: dict[str, Any] = {"model": law.name, **_origin(runs, outcomes)}
    if lost := len(of_seeds) - len(complete):
        where["note"] = f"{lost} of {len(of_seeds)} packings have a test without result"
    measured = exponent({test.number: test.peak_force for test in twelve()})
    return [
        Row(_LABORATORY_ERROR, "%", **_over_packings(_error, complete), **where),
        Row(
            f"laboratory: trend exponent of P against k, {BOX_TESTS}",
            "1",
            experiment=measured,
            **_over_packings(exponent, complete),
            **where,
        ),
    ]


_LABORATORY_ERROR = f"laboratory: mean absolute error of the peak force, {BOX_TESTS}"


def _error(forces: Mapping[int, float]) -> float:
    return error(forces, twelve())


def _over_packings(
    value: Callable[[Mapping[int, float]], float], packings: Sequence[Mapping[int, float]]
) -> dict[str, Any]:
    """Return a value of the mean forces, and its spread over the packings."""
    if not packings:
        return {"computed": None, "spread": None}
    average = {test.number: mean(forces[test.number] for forces in packings) for test in twelve()}
    return {"computed": value(average), "spread": _spread([value(each) for each in packings])}


def _forces(law: Law, place: int, outcomes: Outcomes) -> dict[int, float]:
    """Return the peak forces (N) of a packing by the number of the test."""
    chosen = {
        test.number: outcomes.of(_laboratory(test, law, outcomes.quick)[place]) for test in twelve()
    }
    return {
        number: outcome.metrics[PEAK_TRANSMITTED]
        for number, outcome in chosen.items()
        if outcome.status == COMPLETE
    }


def _spread(values: Sequence[float]) -> float | None:
    return stdev(values) if len(values) > 1 else None


def _energy(impact: full_scale.Impact, law: Law, outcomes: Outcomes) -> Row:
    known = full_scale.known_of(impact)[BEAM_SHARE_FROM_STRAIN].experiment
    return row_of_runs(
        Measure(
            f"girders of {impact.span:g} m: energy / rock's by eq. (7)",
            "%",
            0.01,
            full_scale_runs.share(BEAM_ENERGY_FROM_STRAIN),
        ),
        _girders(impact, law, outcomes.quick),
        outcomes,
        experiment=100.0 * known.value if known else None,
    )


def _girders_ratio(impact: full_scale.Impact, law: Law, outcomes: Outcomes) -> Row:
    known = full_scale.known_of(impact)[SETTLED_RATIO].paper
    return row_of_runs(
        Measure(
            f"girders of {impact.span:g} m: settled ratio transmitted / rock",
            "1",
            1.0,
            SETTLED_RATIO,
        ),
        _girders(impact, law, outcomes.quick),
        outcomes,
        known.value if known else None,
        note="paper: a difference of 30 to 50 % in figs 23 and 24",
    )


def _largest_factor(energies: Sequence[Row], law: Law, outcomes: Outcomes) -> Row:
    pairs = [(row.computed, row.experiment) for row in energies if row.computed and row.experiment]
    complete = len(pairs) == len(energies)
    return Row(
        _GIRDERS_FACTOR,
        "1",
        model=law.name,
        computed=max(max(c / e, e / c) for c, e in pairs) if complete else None,
        note="" if complete else "a span has no result",
        **_origin(
            [task for impact in _SPANS for task in _girders(impact, law, outcomes.quick)], outcomes
        ),
    )


# ------------------------------------------------------------------ figure


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw computed over measured, everywhere; and the trade-off of girders and rigid base."""
    return [
        _parity(listed, folder / "one-law.png"),
        *_trade_off(listed, folder / "one-law-trade-off.png", outcomes),
    ]


def _parity(listed: Sequence[Row], file: Path) -> Path:
    from ...pictures.style import ROCK, SAND, WIDTH, captioned

    own = [
        row
        for row in listed
        if row.model == ONE_LAW and row.computed is not None and row.experiment is not None
    ]
    constants = [row for row in own if row.quantity.startswith("static k, test")]
    energies = [row for row in own if row.quantity.startswith("girders of")]
    words = (
        "One contact law for all tests (model one-law); bars: standard deviation over packings. "
        "The cohesion of each test is calibrated to its k; peak forces: table 2."
    )
    with captioned([words], file, WIDTH, 3.2) as made:
        left, right = made.subplots(1, 2)
        _draw_parity(left, constants, SAND)
        left.set(xlabel="measured secant spring constant k (kgf/cm)", ylabel="computed (kgf/cm)")
        _draw_parity(right, energies, ROCK)
        right.set(xlabel="measured girders' energy / rock's (%)", ylabel="computed (%)")
    return file


def _draw_parity(axes: "Axes", shown: Sequence[Row], colour: str) -> None:
    """Draw computed over measured values, and the line on which they are equal."""
    from ...pictures.style import INK

    measured = [row.experiment or 0.0 for row in shown]
    computed = [row.computed or 0.0 for row in shown]
    spread = [row.spread or 0.0 for row in shown]
    form: dict[str, Any] = {"fmt": "o", "markersize": 4, "linewidth": 0.8}
    axes.errorbar(measured, computed, spread, color=colour, **form)
    top = 1.1 * max(measured + computed, default=1.0)
    axes.plot([0.0, top], [0.0, top], color=INK, linewidth=0.8)
    axes.set(xlim=(0.0, top), ylim=(0.0, None))


def _trade_off(listed: Sequence[Row], file: Path, outcomes: Outcomes) -> list[Path]:
    from ...pictures.style import WIDTH, captioned

    if len(laws(outcomes.quick)) < 2:
        return []
    words = (
        "Effects of one number of the law: girders against rigid base (left) and laboratory "
        "(right). Lines: aims. Eight packings of the law itself, three of the others."
    )
    with captioned([words], file, WIDTH, 3.6) as made:
        left, right = made.subplots(1, 2)
        _draw_laws(left, listed, _RIGID_RATIO, 1.8)
        left.set_ylabel("rigid base: settled ratio")
        _draw_laws(right, listed, _LABORATORY_ERROR, 7.5)
        right.set_ylabel("laboratory: mean absolute error (%)")
    return [file]


def _draw_laws(axes: "Axes", listed: Sequence[Row], quantity: str, aim: float) -> None:
    """Draw a quantity over the factor of the girders' energy, a point for each law.

    A name stands on the side of its point on which it stays in the picture.
    """
    from ...pictures.style import GREY, INK, TRANSMITTED

    of = {(row.model, row.quantity): row for row in listed}
    for law in LAWS:
        x = of[law.name, _GIRDERS_FACTOR].computed
        y = of[law.name, quantity].computed
        if x is None or y is None:
            continue
        colour = INK if law.name == ONE_LAW else TRANSMITTED
        axes.plot(x, y, "o", color=colour, markersize=5)
        side = -1 if x > _FAR_FACTOR else 1
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
    axes.set(xlabel="girders: largest factor to the measured energy")


_FAR_FACTOR = 1.6
"""Factor beyond which a name stands on the left of its point."""


STUDY = Study(
    "one-law",
    "One sand law for static test, laboratory, rigid base and girders",
    8.0,
    rows,
    tasks,
    draw,
    (
        f"Discs ±25 % in size that turn, rolling resistance {ROLLING:g}, E_bar {ONE_LAW_MODULUS:g} "
        f"kgf/cm2, unloading ratio {ONE_LAW_UNLOADING:g}, phi 30 degrees, h 0.2, 0.0018 kgf/cm3 as "
        "unit weight of the layer, for all tests.",
        f"State of the soil: solid fraction {LOOSE:g} as poured, {DENSE:g} compacted and at full "
        "scale; cohesion by Rumpf from each test's static k; 0.05 kgf/cm2 at full scale, where "
        "nothing is known.",
        "Calibrated: E_bar, unloading ratio and the two solid fractions (to the twelve peak forces "
        "and table 6), the cohesions (to k).",
        "Mean and standard deviation over eight packings, three where one number of the law is "
        "changed; in a quick reproduction one packing.",
    ),
    stands_on=_short(),
)
