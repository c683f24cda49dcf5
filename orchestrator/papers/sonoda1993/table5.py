"""Table 5: penetration and peak transmitted force for three moduli and three damping constants, as computed in the paper."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rockshed.components.common.units import cm, kgf

from ...cases.sonoda1993 import DEFAULT_TEST, TableFiveRow, table_5
from ...metrics.names import PEAK_TRANSMITTED, PENETRATION
from ...runs.batch import Task
from ..study import Measure, Outcomes, Row, Study, origin, row_of_runs, verdict
from .laboratory import READINGS, SEED_NOTE, impacts

_UNITS = {PENETRATION: ("cm", cm), PEAK_TRANSMITTED: ("kgf", kgf)}


def _paper(row: TableFiveRow, figure: str) -> float:
    return row.penetration if figure == PENETRATION else row.peak_force


def _modulus(row: TableFiveRow) -> float:
    """In kgf/cm2."""
    return row.modulus / kgf * cm**2


def _impacts(row: TableFiveRow, model: str, quick: bool) -> list[Task]:
    return impacts(
        DEFAULT_TEST,
        model,
        quick,
        {"sand.modulus": row.modulus, "sand.damping": row.damping},
    )


def tasks(quick: bool) -> list[Task]:
    """Nine rows, each with every model."""
    return [task for row in table_5() for model in READINGS for task in _impacts(row, model, quick)]


def rows(found: Outcomes) -> list[Row]:
    """Two figures for each row of the table and model; for each model how far they are off, and the trend of the force in h."""
    listed = _each(found)
    return [
        *listed,
        *(
            row
            for model in READINGS
            for row in (*_largest(model, listed, found), *_trends(model, listed, found))
        ),
    ]


def _largest(model: str, listed: Sequence[Row], found: Outcomes) -> list[Row]:
    """Largest deviation from the paper's figures."""
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
                **_where(model, found),
            )
        )
    return made


def _trends(model: str, listed: Sequence[Row], found: Outcomes) -> list[Row]:
    """Change of the force from the least to the largest damping constant, for each modulus."""
    made = []
    for modulus in dict.fromkeys(map(_modulus, table_5())):
        of_modulus = [
            row
            for row in listed
            if row.model == model
            and row.quantity.startswith(f"{PEAK_TRANSMITTED}, E_bar {modulus:.0f}")
        ]
        first, last = of_modulus[0], of_modulus[-1]
        known = first.computed is not None and last.computed is not None
        assert first.paper
        assert last.paper
        change = (
            100.0 * (last.computed / first.computed - 1.0)
            if known and first.computed and last.computed
            else None
        )
        paper = 100.0 * (last.paper / first.paper - 1.0)
        made.append(
            Row(
                f"change of the force from h 0.1 to 0.3, E_bar {modulus:.0f}",
                "%",
                paper,
                None,
                change,
                model=model,
                verdict="" if change is None else verdict(change * paper > 0.0),
                note="holds: the sign is the paper's" if known else "a row has no result",
                **_where(model, found),
            )
        )
    return made


def _where(model: str, found: Outcomes) -> dict[str, Any]:
    where = origin([task for row in table_5() for task in _impacts(row, model, found.quick)], found)
    return {
        **where,
        "options": {
            key: value
            for key, value in where["options"].items()
            if key not in ("modulus", "damping")
        },
    }


def _each(found: Outcomes) -> list[Row]:
    return [
        row_of_runs(
            Measure(f"{figure}, E_bar {_modulus(row):.0f}, h {row.damping:g}", unit, scale, figure),
            _impacts(row, model, found.quick),
            found,
            paper=_paper(row, figure) / scale,
        )
        for row in table_5()
        for figure, (unit, scale) in _UNITS.items()
        for model in READINGS
    ]


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Both figures over the damping constant, a line for each modulus."""
    from ...pictures.style import GREY, ROCK, TRANSMITTED, WIDTH, captioned

    file = folder / "table5.png"
    dashes = {20: "-", 40: "--", 60: ":"}
    with captioned(["Table 5 of Sonoda et al. 1993. E_bar in kgf/cm²."], file, WIDTH, 3.4) as made:
        for axes, (figure, (unit, scale)) in zip(made.subplots(1, 2), _UNITS.items(), strict=True):
            for modulus, line in dashes.items():
                chosen = [row for row in table_5() if round(_modulus(row)) == modulus]
                damping = [row.damping for row in chosen]
                axes.plot(
                    damping,
                    [_paper(row, figure) / scale for row in chosen],
                    line,
                    color=GREY,
                    marker="s",
                    markersize=3,
                    label=f"paper, {modulus}",
                )
                for model, colour in (("calibrated", TRANSMITTED), ("literal", ROCK)):
                    values = [
                        next(
                            r.computed
                            for r in listed
                            if r.model == model
                            and r.quantity.startswith(figure)
                            and r.quantity.endswith(f"E_bar {modulus}, h {row.damping:g}")
                        )
                        for row in chosen
                    ]
                    axes.plot(
                        damping,
                        [float("nan") if v is None else v for v in values],
                        line,
                        color=colour,
                        marker="o",
                        markersize=3,
                        linewidth=1.0,
                        label=f"{model}, {modulus}",
                    )
            axes.set(
                xlabel="damping constant h", ylabel=f"{figure} ({unit})", xticks=[0.1, 0.2, 0.3]
            )
            axes.set_ylim(0.0, 1.08 * axes.get_ylim()[1])
        made.legend(
            *axes.get_legend_handles_labels(), loc="outside right upper", title="model, E_bar"
        )
    return [file]


STUDY = Study(
    "table5",
    "Table 5: influence of the damping constant",
    5.0,
    rows,
    tasks,
    draw,
    (
        SEED_NOTE,
        "calibrated: rotation locked, stiffness factor 0.37, fitted to this table and the static test. literal: three "
        "freedoms a disc, factor 1. steel discs: calibrated sand, with the mass of a steel disc of the beam "
        "in the dashpots there; discs then chatter on the beam, with spikes in the force that a coarser exchange averages away.",
        "Ball, box and beam of test 4.",
    ),
)
