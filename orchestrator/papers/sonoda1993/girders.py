"""Table 6, figures 23 and 24: the rock of 1 tf on sand on two girders of 8, 10 and 12 m.

Models of the sand differ by one assumption each.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockshed.components.common.units import tf

from ...cases.full_scale import Impact, impacts, known_of
from ...metrics.names import (
    BEAM_ENERGY,
    BEAM_ENERGY_FROM_STRAIN,
    BEAM_SHARE,
    BEAM_SHARE_FROM_STRAIN,
    SETTLED_RATIO,
    SETTLED_ROCK,
    SETTLED_TRANSMITTED,
)
from ...runs.batch import Task
from ..study import Measure, Outcomes, Row, Study, detail, origin, row_of_runs, verdict
from . import full_scale
from .full_scale import SEED_NOTE, SHORT_GIRDERS, STEP_NOTE, Model, models, plot_forces, share

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SPANS = {impact.span: impact for impact in impacts().values() if impact.span}
"""Impacts by their span (m)."""
EXCESS = (1.3, 1.5)
"""Transmitted force over that on the rock in figs 23 and 24, whose maxima differ by 30 to 50 %."""
STOP = 0.16
"""End of the runs (s): energy and forces have had their peaks."""


def _runs(impact: Impact, model: Model, quick: bool) -> list[Task]:
    return full_scale.impacts(impact.name, model, quick, STOP)


def tasks(quick: bool) -> list[Task]:
    """Return the impacts on every span with every model."""
    return [
        task
        for impact in SPANS.values()
        for model in models(quick, True)
        for task in _runs(impact, model, quick)
    ]


def rows(outcomes: Outcomes) -> list[Row]:
    """Return for every model energy and forces at each span, and how well the energies fit."""
    listed = []
    for model in models(outcomes.quick, True):
        energies = [_energy(impact, model, outcomes) for impact in SPANS.values()]
        listed += [
            *energies,
            *(
                row
                for impact in SPANS.values()
                for row in _springs_and_forces(impact, model, outcomes)
            ),
            *_over_spans(energies, model, outcomes),
            _fig_24(model, outcomes),
        ]
    return listed


def _known(impact: Impact, figure: str, who: str) -> float | None:
    reference = known_of(impact)[figure].by().get(who)
    return None if reference is None else reference.value


def _percent(value: float | None) -> float | None:
    return None if value is None else 100.0 * value


def _energy(impact: Impact, model: Model, outcomes: Outcomes) -> Row:
    """Return the energy as it was measured."""
    return row_of_runs(
        Measure(
            f"girders' energy / rock's by eq. (7), span {impact.span:g} m",
            "%",
            0.01,
            share(BEAM_ENERGY_FROM_STRAIN),
        ),
        _runs(impact, model, outcomes.quick),
        outcomes,
        experiment=_percent(_known(impact, BEAM_SHARE_FROM_STRAIN, "experiment")),
        note="from the strain at midspan since the start",
    )


def _springs_and_forces(impact: Impact, model: Model, outcomes: Outcomes) -> list[Row]:
    """Return the energy as the paper's analysis has it, and both forces."""
    runs = _runs(impact, model, outcomes.quick)
    span = f"span {impact.span:g} m"
    by_springs = f"girders' energy / rock's by eqs (5), (6), {span}"
    transmitted = Measure(f"settled transmitted force, {span}", "tf", tf, SETTLED_TRANSMITTED)
    on_rock = Measure(f"settled force on the rock, {span}", "tf", tf, SETTLED_ROCK)
    return [
        row_of_runs(
            Measure(by_springs, "%", 0.01, share(BEAM_ENERGY)),
            runs,
            outcomes,
            _percent(_known(impact, BEAM_SHARE, "paper")),
            note="largest elastic energy less that at rest under the sand",
        ),
        row_of_runs(
            Measure(f"settled ratio transmitted / rock, {span}", "1", 1.0, SETTLED_RATIO),
            runs,
            outcomes,
            _known(impact, SETTLED_RATIO, "paper"),
            note="paper: a difference of 30 to 50 % in figs 23 and 24",
        ),
        detail(row_of_runs(transmitted, runs, outcomes)),
        detail(row_of_runs(on_rock, runs, outcomes)),
    ]


def _over_spans(energies: Sequence[Row], model: Model, outcomes: Outcomes) -> list[Row]:
    """Return the rise of the energy with the span, and its largest factor to the measured one.

    Both are empty if a span has no result.
    """
    every = [task for impact in SPANS.values() for task in _runs(impact, model, outcomes.quick)]
    computed = [row.computed for row in energies if row.computed is not None]
    measured = [row.experiment for row in energies if row.experiment is not None]
    rise = None
    factor = None
    where: dict[str, Any] = {"model": model.name, **origin(every, outcomes)}
    if len(computed) == len(energies):
        rise = computed[-1] / computed[0]
        factor = max(max(c / m, m / c) for c, m in zip(computed, measured, strict=True))
    else:
        where["note"] = "a span has no result"
    return [
        Row(
            "girders' energy by eq. (7), longest / shortest span",
            "1",
            None,
            measured[-1] / measured[0],
            rise,
            **where,
        ),
        Row(
            "largest factor between computed and measured energy, eq. (7)",
            "1",
            computed=factor,
            **where,
        ),
    ]


def _fig_24(model: Model, outcomes: Outcomes) -> Row:
    """Return whether the transmitted force exceeds that on the rock by what figs 23, 24 show."""
    ratios = [
        row_of_runs(
            Measure("", "1", 1.0, SETTLED_RATIO), _runs(impact, model, outcomes.quick), outcomes
        ).computed
        for impact in SPANS.values()
    ]
    found = [ratio for ratio in ratios if ratio is not None]
    whole = len(found) == len(ratios)
    every = [task for impact in SPANS.values() for task in _runs(impact, model, outcomes.quick)]
    least, most = EXCESS
    spans = ", ".join(f"{span:g} m {r:.2f}" for span, r in zip(SPANS, found, strict=False))
    return Row(
        "fig. 24: transmitted force 1.3 to 1.5 times that on the rock",
        "1",
        paper=0.5 * (least + most),
        computed=sum(found) / len(found) if whole else None,
        model=model.name,
        verdict=verdict(least <= min(found) and max(found) <= most) if whole else "",
        note=f"settled maxima: {spans}" if whole else "a span has no result",
        **origin(every, outcomes),
    )


SHOWN = ("calibrated", "one-law")
"""Models in the figure of the forces."""


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw forces over time as in figs 23 and 24, and table 6 over the span."""
    return [
        _forces(outcomes, folder / "figs23-24.png"),
        _table_6(outcomes, listed, folder / "table6.png"),
    ]


def _forces(outcomes: Outcomes, file: Path) -> Path:
    from ...pictures.style import GREY, WIDTH, captioned, legend

    shown = [model for model in models(outcomes.quick, True) if model.name in SHOWN]
    words = (
        "Figs 23 and 24 of Sonoda et al. 1993: 1 tf from 10 m on 90 cm of crushed sand on two "
        "H-300x400 girders. Thin: as computed; thick: settled (low-pass). The first seed of each "
        "model."
    )
    with captioned([words], file, WIDTH, 4.6) as made:
        grid = made.subplots(len(shown), len(SPANS), sharey=True, squeeze=False)
        for line, model in zip(grid, shown, strict=True):
            for axes, impact in zip(line, SPANS.values(), strict=True):
                plot_forces(axes, outcomes.of(_runs(impact, model, outcomes.quick)[0]))
                axes.set_title(f"span {impact.span:g} m\n{model.name}", color=GREY)
            line[0].set_ylabel("force (tf)")
        for axes in grid[-1]:
            axes.set_xlabel("time (ms)")
        grid[0][0].set_ylim(0.0, None)
        legend(grid[0][0])
    return file


def _table_6(outcomes: Outcomes, listed: Sequence[Row], file: Path) -> Path:
    """Draw the energy over the span.

    Left: by eq. (7) beside the experiment; right: by eqs (5), (6) beside the paper's analysis.
    """
    from ...pictures.style import WIDTH, captioned

    words = (
        "Table 6 of Sonoda et al. 1993: energy of the girders as a part of the rock's. Squares: "
        "measured (left), the paper's analysis (right). Bars: standard deviation over seeds."
    )
    with captioned([words], file, WIDTH, 3.6) as made:
        left, right = made.subplots(1, 2, sharey=True)
        _draw_energies(left, "eq. (7)", "experiment", listed, outcomes.quick)
        _draw_energies(right, "eqs (5), (6)", "paper", listed, outcomes.quick)
        left.set_ylabel("energy of the girders / energy of the rock (%)")
        made.legend(*left.get_legend_handles_labels(), loc="outside right upper")
    return file


def _draw_energies(axes: "Axes", by: str, who: str, listed: Sequence[Row], quick: bool) -> None:
    """Draw the energies by one equation, of every model and of a reference."""
    from ...pictures.style import INK

    spans = list(SPANS)
    begin = f"girders' energy / rock's by {by}"
    shown = [row for row in listed if row.quantity.startswith(begin)]
    form: dict[str, Any] = {"marker": "o", "markersize": 3, "linewidth": 1.0}
    for model in models(quick, True):
        lines = [row for row in shown if row.model == model.name]
        computed = [float("nan") if row.computed is None else row.computed for row in lines]
        spread = [row.spread or 0.0 for row in lines]
        axes.errorbar(spans, computed, spread, label=model.name, **form)
    known = [getattr(row, who) for row in shown[: len(spans)]]
    axes.plot(spans, known, "s--", color=INK, markersize=5, label="Sonoda et al.")
    axes.set(title=f"by {by}", xlabel="span (m)", xticks=spans, yscale="log", ylim=(3.0, 100.0))
    axes.yaxis.set_major_formatter("{x:g}")


STUDY = Study(
    "girders",
    "Table 6, figures 23 and 24: full scale on girders",
    7.0,
    rows,
    tasks,
    draw,
    (
        SEED_NOTE,
        STEP_NOTE,
        "Comparable with the experiment is eq. (7) from the strain at midspan, gauges at zero "
        "before the test. The paper's analysis sums up the springs by eqs (5), (6), which give "
        "more: eq. (7) is that of a static point load at midspan, and the energy at rest under the "
        "sand has a cross term with the impact's that grows with the span.",
        "The girders start at rest in equilibrium under sand and own weight. Masses of deck (200 "
        "kg/m) and box (2 t) are assumed where a model names them; elsewhere there are none, as "
        "the paper gives none.",
        "'poured' is a pack of discs +-25 % with rolling resistance 0.3, brought to the solid "
        "fraction 0.74; models that begin so differ from it by what they name: bulk weight (0.0018 "
        "kgf/cm3 of the layer, not of a disc), deck and box, unloading stiffness 3 or 20 times the "
        "loading one, cohesion 0.05 kgf/cm2; all together: these with unloading 3.",
    ),
    stands_on=SHORT_GIRDERS,
)
