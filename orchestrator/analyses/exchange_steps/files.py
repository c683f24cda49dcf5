"""Files of a convergence study of exchange steps.

====================  ==========================================================================
exchange-steps.json   runs, figures, orders, errors and remarks, in SI
exchange-steps.csv    a row for each figure and step, in SI
exchange-steps.png    the picture
====================  ==========================================================================
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...core.results.own_files import FILES
from ...files import write_csv, write_json

if TYPE_CHECKING:
    from .result import ExchangeStepsResult

DATA, TABLE = "exchange-steps.json", "exchange-steps.csv"
NAMES = (DATA, TABLE, "exchange-steps.png")
"""All files of a study, the picture included."""


def write_files(result: "ExchangeStepsResult", folder: Path) -> list[Path]:
    """Write data and table.

    Parameters
    ----------
    result : ExchangeStepsResult
        The study.
    folder : Path
        Exists.

    Returns
    -------
    list of Path
        Of the files.
    """
    table = result.to_arrow()
    files = [folder / DATA, folder / TABLE]
    write_json(files[0], {**as_data(result), FILES: NAMES})
    write_csv(files[1], table.column_names, table.to_pydict().values())
    return files


def as_data(result: "ExchangeStepsResult") -> dict[str, Any]:
    """Return a study as plain data in SI.

    Parameters
    ----------
    result : ExchangeStepsResult
        The study.
    """
    return {
        "kind": result.kind,
        "name": result.name,
        "status": result.status,
        **result.origin,
        "accuracy": result.accuracy,
        "recommended_step": result.recommended_step,
        "levels": [
            {
                "exchange_step": level.step,
                "component_steps": dict(level.component_steps),
                "exchanges": level.exchanges,
                "energy_residual": level.residual,
                "coupling_energy": level.coupling,
                "wall_time": level.wall_time,
            }
            for level in result.levels
        ],
        "figures": [
            {
                "figure": figure.name,
                "unit": figure.unit,
                "values": list(figure.values),
                "differences": list(figure.differences),
                "order": figure.found.order,
                "reason": figure.found.reason,
                "limit": figure.limit,
                "errors": list(figure.found.errors),
                "scale": figure.scale,
                "step": result.step_for(figure),
            }
            for figure in result.figures_followed
        ],
        "warnings": result.warnings,
        "remarks": result.notes,
    }
