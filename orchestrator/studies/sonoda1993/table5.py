"""Table 5: penetration and peak transmitted force for three moduli and three damping constants, as computed in the paper."""

from collections.abc import Sequence
from pathlib import Path

from components.units import cm, kgf

from ...cases.sonoda1993 import DEFAULT_TEST, TableFiveRow, table_5
from ...headlines import PEAK_TRANSMITTED, PENETRATION
from ..study import Outcomes, Row, Study, Task, row_of_runs
from .laboratory import MODELS, SEED_NOTE, impacts

_UNITS = {PENETRATION: ("cm", cm), PEAK_TRANSMITTED: ("kgf", kgf)}


def _paper(row: TableFiveRow, figure: str) -> float:
    return row.penetration if figure == PENETRATION else row.peak_force


def _modulus(row: TableFiveRow) -> float:
    """In kgf/cm2."""
    return row.modulus / kgf * cm**2


def _impacts(row: TableFiveRow, model: str, quick: bool) -> list[Task]:
    return impacts(DEFAULT_TEST, model, quick, (f"sand.modulus={row.modulus!r}", f"sand.damping={row.damping!r}"))


def tasks(quick: bool) -> list[Task]:
    """Nine rows, each with every model."""
    return [task for row in table_5() for model in MODELS for task in _impacts(row, model, quick)]


def rows(found: Outcomes) -> list[Row]:
    """Two figures for each row of the table and model."""
    return [row_of_runs(f"{figure}, E_bar {_modulus(row):.0f}, h {row.damping:g}", unit, scale, figure,
                        _impacts(row, model, found.quick), found, paper=_paper(row, figure) / scale)
            for row in table_5() for figure, (unit, scale) in _UNITS.items() for model in MODELS]


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
                axes.plot(damping, [_paper(row, figure) / scale for row in chosen], line, color=GREY, marker="s", markersize=3,
                          label=f"paper, {modulus}")
                for model, colour in (("calibrated", TRANSMITTED), ("literal", ROCK)):
                    values = [next(r.computed for r in listed if r.model == model and r.quantity.startswith(figure)
                                   and r.quantity.endswith(f"E_bar {modulus}, h {row.damping:g}")) for row in chosen]
                    axes.plot(damping, [float("nan") if v is None else v for v in values], line, color=colour, marker="o",
                              markersize=3, linewidth=1.0, label=f"{model}, {modulus}")
            axes.set(xlabel="damping constant h", ylabel=f"{figure} ({unit})", xticks=[0.1, 0.2, 0.3])
            axes.set_ylim(0.0, 1.08 * axes.get_ylim()[1])
        made.legend(*axes.get_legend_handles_labels(), loc="outside right upper", title="model, E_bar")
    return [file]


STUDY = Study("table5", "Table 5: influence of the damping constant", 5.0, rows, tasks, draw, (
    SEED_NOTE, "calibrated: rotation locked, stiffness factor 0.37, fitted to this table and the static test. literal: three "
    "freedoms a disc, factor 1.", "Ball, box and beam of test 4."))
