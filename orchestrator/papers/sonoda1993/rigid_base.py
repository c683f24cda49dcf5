"""Figures 20 to 22: a rock of 1 tf on 90 cm of three sands on a rigid base.

Transmitted force and force on the rock, beside those of formulas.
"""

from collections.abc import Sequence
from pathlib import Path

from rockshed.components.common.units import cm, standard_gravity, tf

from ...cases.full_scale import (
    DROP,
    ROCK_MASS,
    ROCK_RADIUS,
    Impact,
    impacts,
)
from ...formulas.handbook import handbook_force
from ...formulas.hertz import hertz_force
from ...metrics.names import (
    PENETRATION,
    SETTLED_CUT_OFF,
    SETTLED_RATIO,
    SETTLED_ROCK,
    SETTLED_TRANSMITTED,
)
from ...runs.batch import COMPLETE, Task
from ..study import Measure, Outcomes, Row, Study, detail, row_of_runs
from . import full_scale
from .full_scale import SEED_NOTE, SHORT_RIGID, STEP_NOTE, Model, models, plot_forces, sands

SANDS = {
    name.removeprefix("rigid-base-"): impact
    for name, impact in impacts().items()
    if not impact.span
}
"""Impacts by the name of the sand."""
RATIO = 2.0
"""Transmitted force / force on the rock in the paper: about twice."""


def _runs(impact: Impact, model: Model, quick: bool) -> list[Task]:
    return full_scale.impacts(impact.name, model, quick, impact.stop_time)


def tasks(quick: bool) -> list[Task]:
    """Return the impacts on every sand with every model."""
    return [
        task
        for model in models(quick, False)
        for sand in sands(model, [*SANDS])
        for task in _runs(SANDS[sand], model, quick)
    ]


def rows(outcomes: Outcomes) -> list[Row]:
    """Return ratio, both forces and penetration for every sand and model, then the formulas."""
    return [
        row
        for model in models(outcomes.quick, False)
        for sand in sands(model, [*SANDS])
        for row in _of_sand(sand, model, outcomes)
    ] + formulas()


def _of_sand(sand: str, model: Model, outcomes: Outcomes) -> list[Row]:
    """Return ratio, both forces and penetration for one sand."""
    runs = _runs(SANDS[sand], model, outcomes.quick)
    settled = _filter(runs, outcomes)
    transmitted = Measure(f"settled transmitted force, {sand} sand", "tf", tf, SETTLED_TRANSMITTED)
    on_rock = Measure(f"settled force on the rock, {sand} sand", "tf", tf, SETTLED_ROCK)
    penetration = Measure(f"penetration, {sand} sand", "cm", cm, PENETRATION)
    return [
        row_of_runs(
            Measure(f"settled ratio transmitted / rock, {sand} sand", "1", 1.0, SETTLED_RATIO),
            runs,
            outcomes,
            RATIO,
            note="; ".join(filter(None, ["paper: about twice", settled])),
        ),
        row_of_runs(transmitted, runs, outcomes, note=settled),
        row_of_runs(on_rock, runs, outcomes, note=settled),
        detail(row_of_runs(penetration, runs, outcomes)),
    ]


def _filter(runs: Sequence[Task], outcomes: Outcomes) -> str:
    """Return in words the filter of the settled forces; nothing where no run has one."""
    complete = [outcomes.of(task) for task in runs if outcomes.of(task).status == COMPLETE]
    cut_off = complete[0].metrics.get(SETTLED_CUT_OFF) if complete else None
    if not cut_off:
        return ""
    return f"settled: low-pass of 4th order, forwards and backwards, {cut_off:.0f} Hz"


def formulas() -> list[Row]:
    """Return the force on the rock by the handbook, and by Hertz, on whom the handbook builds."""
    speed = (2.0 * standard_gravity * DROP) ** 0.5
    return [
        Row(
            "force on the rock by the Japanese rockfall handbook",
            "tf",
            computed=handbook_force(ROCK_MASS, DROP) / tf,
            model="formula",
            note="2.108 (m g)^(2/3) lambda^(2/5) H^(3/5) with lambda = 1000 kN/m2, whatever the "
            "sand",
        ),
        Row(
            "force on the rock by Hertz's theory",
            "tf",
            computed=hertz_force(ROCK_MASS, ROCK_RADIUS, speed) / tf,
            model="formula",
            note="rigid sphere of 91.2 cm on an elastic half-space with lambda = 1000 kN/m2, nu = "
            "0.25: the handbook's formula is this one, for a rock of ordinary density",
        ),
    ]


SHOWN = ("calibrated", "literal")
"""Models in the figure."""


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw a column for each of figs 20 to 22, a row for each model; the first seed."""
    from ...pictures.style import GREY, WIDTH, captioned, legend, reference_line

    file = folder / "figs20-22.png"
    handbook = handbook_force(ROCK_MASS, DROP) / tf
    shown = [model for model in models(outcomes.quick, False) if model.name in SHOWN]
    words = (
        "Figs 20 to 22 of Sonoda et al. 1993: 1 tf from 10 m on 90 cm of sand on a rigid base. "
        "Thin: as computed; thick: settled (low-pass). The first seed of each model."
    )
    with captioned([words], file, WIDTH, 4.6) as made:
        grid = made.subplots(len(shown), len(SANDS), sharey=True, squeeze=False)
        for line, model in zip(grid, shown, strict=True):
            for axes, (number, sand) in zip(line, enumerate(SANDS, 20), strict=True):
                plot_forces(axes, outcomes.of(_runs(SANDS[sand], model, outcomes.quick)[0]))
                axes.set_title(f"fig. {number}: {sand} sand\n{model.name}", color=GREY)
                reference_line(axes, handbook, "rock, handbook")
            line[0].set_ylabel("force (tf)")
        for axes in grid[-1]:
            axes.set_xlabel("time (ms)")
        grid[0][0].set_ylim(0.0, None)
        legend(grid[0][0])
    return [file]


STUDY = Study(
    "rigid-base",
    "Figures 20 to 22: full scale on a rigid base",
    6.0,
    rows,
    tasks,
    draw,
    (
        SEED_NOTE,
        STEP_NOTE,
        "Settled maxima: after a low-pass at half the natural frequency of a sand disc on one "
        "contact, which takes away spikes of discs that are struck one by one.",
        "E_bar 20 (pit), 75 (river; the paper has 70 to 80) and 100 kgf/cm2 (crushed); depth 92 "
        "cm, which the paper does not give.",
    ),
    stands_on=SHORT_RIGID,
)
