"""Figures 20 to 22: a rock of 1 tf on 90 cm of three sands on a rigid base; transmitted force and force on the rock."""

from collections.abc import Sequence
from pathlib import Path

from rockshed.components.common.units import cm, tf

from ...cases.full_scale import (
    DROP,
    GRAVITY,
    ROCK_MASS,
    ROCK_RADIUS,
    Impact,
    handbook_force,
    hertz_force,
    impacts,
)
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
from .full_scale import SEED_NOTE, STEP_NOTE, Model, models, plot_forces, sands

SANDS = {
    name.removeprefix("rigid-base-"): impact
    for name, impact in impacts().items()
    if not impact.span
}
"""The impacts by the name of the sand."""
RATIO = 2.0
"""Transmitted force / force on the rock, in the paper: about twice."""


def _runs(impact: Impact, model: Model, quick: bool) -> list[Task]:
    return full_scale.impacts(impact.name, model, quick, impact.stop_time)


def tasks(quick: bool) -> list[Task]:
    """Every sand with every model."""
    return [
        task
        for model in models(quick, False)
        for sand in sands(model, [*SANDS])
        for task in _runs(SANDS[sand], model, quick)
    ]


def rows(found: Outcomes) -> list[Row]:
    """Ratio, both forces and penetration for every sand and model, then what formulas give whatever the sand."""
    return [
        row
        for model in models(found.quick, False)
        for sand in sands(model, [*SANDS])
        for row in _of_sand(sand, model, found)
    ] + formulas()


def _of_sand(sand: str, model: Model, found: Outcomes) -> list[Row]:
    runs = _runs(SANDS[sand], model, found.quick)
    filters = [
        found.of(task).metrics.get(SETTLED_CUT_OFF)
        for task in runs
        if found.of(task).status == COMPLETE
    ]
    settled = (
        f"settled: low-pass of 4th order, forwards and backwards, {filters[0]:.0f} Hz"
        if filters and filters[0]
        else ""
    )
    return [
        row_of_runs(
            Measure(f"settled ratio transmitted / rock, {sand} sand", "1", 1.0, SETTLED_RATIO),
            runs,
            found,
            RATIO,
            note="; ".join(filter(None, ["paper: about twice", settled])),
        ),
        row_of_runs(
            Measure(f"settled transmitted force, {sand} sand", "tf", tf, SETTLED_TRANSMITTED),
            runs,
            found,
            note=settled,
        ),
        row_of_runs(
            Measure(f"settled force on the rock, {sand} sand", "tf", tf, SETTLED_ROCK),
            runs,
            found,
            note=settled,
        ),
        detail(
            row_of_runs(Measure(f"penetration, {sand} sand", "cm", cm, PENETRATION), runs, found)
        ),
    ]


def formulas() -> list[Row]:
    """The handbook's force on the rock and Hertz's, which the handbook has made its own: they need no run."""
    speed = (2.0 * GRAVITY * DROP) ** 0.5
    return [
        Row(
            "force on the rock by the Japanese rockfall handbook",
            "tf",
            computed=handbook_force(ROCK_MASS, DROP) / tf,
            model="formula",
            note="2.108 (m g)^(2/3) lambda^(2/5) H^(3/5) with lambda = 1000 kN/m2, whatever the sand",
        ),
        Row(
            "force on the rock by Hertz's theory",
            "tf",
            computed=hertz_force(ROCK_MASS, ROCK_RADIUS, speed) / tf,
            model="formula",
            note="rigid sphere of 91.2 cm on an elastic half-space with lambda = 1000 kN/m2, nu = 0.25: the "
            "handbook's formula is this one, for a rock of ordinary density",
        ),
    ]


SHOWN = ("calibrated", "literal")
"""Models in the figure."""


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """A column for each of figs 20 to 22, a row for each model; the first seed."""
    from ...pictures.style import GREY, WIDTH, captioned, legend, reference_line

    file = folder / "figs20-22.png"
    handbook = handbook_force(ROCK_MASS, DROP) / tf
    shown = [model for model in models(found.quick, False) if model.name in SHOWN]
    with captioned(
        [
            "Figs 20 to 22 of Sonoda et al. 1993: 1 tf from 10 m on 90 cm of sand on a rigid base. Thin: as computed; "
            "thick: settled (low-pass). The first seed of each model."
        ],
        file,
        WIDTH,
        4.6,
    ) as made:
        grid = made.subplots(len(shown), len(SANDS), sharey=True, squeeze=False)
        for line, model in zip(grid, shown):
            for axes, (number, impact) in zip(line, enumerate(SANDS.values(), 20)):
                plot_forces(axes, found.of(_runs(impact, model, found.quick)[0]))
                axes.set_title(
                    f"fig. {number}: {impact.name.removeprefix('rigid-base-')} sand\n{model.name}",
                    color=GREY,
                )
                reference_line(axes, handbook, "rock, handbook")
            line[0].set_ylabel("force (tf)")
        for axes in grid[-1]:
            axes.set_xlabel("time (ms)")
        grid[0][0].set_ylim(0.0, None)
        legend(grid[0][0], loc="upper right")
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
        "Settled maxima: after a low-pass at half the natural frequency of a sand disc on one contact, which "
        "takes away spikes of discs that are struck one by one.",
        "E_bar 20 (pit), 75 (river; the paper has 70 to 80) and 100 kgf/cm2 (crushed); depth 92 cm, which the paper does not give.",
    ),
)
