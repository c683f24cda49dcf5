"""Table 5: penetration and peak transmitted force, as computed in the paper.

Three moduli with three damping constants each.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockshed.components.common.units import cm, kgf

from ...cases.sonoda1993 import DEFAULT_TEST, TableFiveRow, table_5
from ...metrics.names import PEAK_TRANSMITTED, PENETRATION
from ...runs.batch import Task
from ..study import Measure, Outcomes, Row, Study, origin, row_of_runs, verdict
from .laboratory import READINGS, SEED_NOTE, SHORT_LATTICES, SHORT_STEEL, impacts

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_UNITS = {PENETRATION: ("cm", cm), PEAK_TRANSMITTED: ("kgf", kgf)}


def _paper(row: TableFiveRow, figure: str) -> float:
    return row.penetration if figure == PENETRATION else row.peak_force


def _modulus(row: TableFiveRow) -> float:
    """Return E_bar (kgf/cm2) of a row of the table."""
    return row.modulus / kgf * cm**2


def _impacts(row: TableFiveRow, model: str, quick: bool) -> list[Task]:
    return impacts(
        DEFAULT_TEST,
        model,
        quick,
        {"sand.modulus": row.modulus, "sand.damping": row.damping},
    )


def tasks(quick: bool) -> list[Task]:
    """Return the impacts of nine rows, each with every model."""
    return [task for row in table_5() for model in READINGS for task in _impacts(row, model, quick)]


def rows(outcomes: Outcomes) -> list[Row]:
    """Return both metrics for each row of the table and model, then deviations and trends."""
    listed = _each(outcomes)
    return [
        *listed,
        *(
            row
            for model in READINGS
            for row in (*_largest(model, listed, outcomes), *_trends(model, listed, outcomes))
        ),
    ]


def _largest(model: str, listed: Sequence[Row], outcomes: Outcomes) -> list[Row]:
    """Return the largest deviations from the paper's values."""
    made = []
    for figure in _UNITS:
        off = [
            row.deviation(row.paper)
            for row in listed
            if row.model == model and row.quantity.startswith(figure)
        ]
        known = [abs(value) for value in off if value is not None]
        made.append(
            Row(
                f"largest deviation of {figure} from the paper, nine rows",
                "%",
                model=model,
                computed=100.0 * max(known) if len(known) == len(off) else None,
                note="" if len(known) == len(off) else "a row has no result",
                **_where(model, outcomes),
            )
        )
    return made


def _trends(model: str, listed: Sequence[Row], outcomes: Outcomes) -> list[Row]:
    """Return the change of the force over the damping constants, for each modulus."""
    moduli = dict.fromkeys(map(_modulus, table_5()))
    return [_trend(model, modulus, listed, outcomes) for modulus in moduli]


def _trend(model: str, modulus: float, listed: Sequence[Row], outcomes: Outcomes) -> Row:
    """Return the change of the force from the least to the largest damping constant."""
    begin = f"{PEAK_TRANSMITTED}, E_bar {modulus:.0f}"
    chosen = [row for row in listed if row.model == model and row.quantity.startswith(begin)]
    first = chosen[0]
    last = chosen[-1]
    assert first.paper
    assert last.paper
    paper = 100.0 * (last.paper / first.paper - 1.0)
    change = None
    if first.computed and last.computed:
        change = 100.0 * (last.computed / first.computed - 1.0)
    return Row(
        f"change of the force from h 0.1 to 0.3, E_bar {modulus:.0f}",
        "%",
        paper,
        None,
        change,
        model=model,
        verdict="" if change is None else verdict(change * paper > 0.0),
        note="a row has no result" if change is None else "holds: the sign is the paper's",
        **_where(model, outcomes),
    )


def _where(model: str, outcomes: Outcomes) -> dict[str, Any]:
    """Return the origin of a value over all rows: without the numbers that differ in them."""
    where = origin(
        [task for row in table_5() for task in _impacts(row, model, outcomes.quick)], outcomes
    )
    return {
        **where,
        "options": {
            key: value
            for key, value in where["options"].items()
            if key not in ("modulus", "damping")
        },
    }


def _each(outcomes: Outcomes) -> list[Row]:
    return [
        row_of_runs(
            Measure(f"{figure}, E_bar {_modulus(row):.0f}, h {row.damping:g}", unit, scale, figure),
            _impacts(row, model, outcomes.quick),
            outcomes,
            paper=_paper(row, figure) / scale,
        )
        for row in table_5()
        for figure, (unit, scale) in _UNITS.items()
        for model in READINGS
    ]


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw both metrics over the damping constant, a line for each modulus."""
    from ...pictures.style import WIDTH, captioned

    file = folder / "table5.png"
    with captioned(["Table 5 of Sonoda et al. 1993. E_bar in kgf/cm²."], file, WIDTH, 3.4) as made:
        for axes, figure in zip(made.subplots(1, 2), _UNITS, strict=True):
            _draw_metric(axes, figure, listed)
        handles = made.axes[-1].get_legend_handles_labels()
        made.legend(*handles, loc="outside right upper", title="model, E_bar")
    return [file]


def _draw_metric(axes: "Axes", figure: str, listed: Sequence[Row]) -> None:
    """Draw a metric over the damping constant: the paper's, calibrated and literal."""
    from ...pictures.style import GREY, ROCK, TRANSMITTED

    unit, scale = _UNITS[figure]
    for modulus, dashes in ((20, "-"), (40, "--"), (60, ":")):
        chosen = [row for row in table_5() if round(_modulus(row)) == modulus]
        damping = [row.damping for row in chosen]
        form: dict[str, Any] = {"linestyle": dashes, "markersize": 3}
        paper = [_paper(row, figure) / scale for row in chosen]
        axes.plot(damping, paper, color=GREY, marker="s", label=f"paper, {modulus}", **form)
        for model, colour in (("calibrated", TRANSMITTED), ("literal", ROCK)):
            values = [_computed(row, figure, model, listed) for row in chosen]
            label = f"{model}, {modulus}"
            form |= {"marker": "o", "linewidth": 1.0}
            axes.plot(damping, values, color=colour, label=label, **form)
    axes.set(xlabel="damping constant h", ylabel=f"{figure} ({unit})", xticks=[0.1, 0.2, 0.3])
    axes.set_ylim(0.0, 1.08 * axes.get_ylim()[1])


def _computed(printed: TableFiveRow, figure: str, model: str, listed: Sequence[Row]) -> float:
    """Return the computed value beside a row of the table; NaN where there is none."""
    end = f"E_bar {_modulus(printed):.0f}, h {printed.damping:g}"
    value = next(
        row.computed
        for row in listed
        if row.model == model and row.quantity.startswith(figure) and row.quantity.endswith(end)
    )
    return float("nan") if value is None else value


STUDY = Study(
    "table5",
    "Table 5: influence of the damping constant",
    5.0,
    rows,
    tasks,
    draw,
    (
        SEED_NOTE,
        "calibrated: rotation locked, stiffness factor 0.342, fitted to this table and the static "
        "test. literal: three freedoms a disc, factor 1, on the discs of the beam. steel discs: "
        "calibrated sand, with the mass of a steel disc of the beam in the dashpots there; discs "
        "then chatter on the beam, with spikes in the force that a coarser exchange averages away.",
        "Ball, box and beam of test 4.",
    ),
    stands_on={**SHORT_LATTICES, **SHORT_STEEL},
)
