"""Files of a convergence study.

====================  ==========================================================================
convergence.json      meshes, figures, departures and remarks, in SI
convergence.csv       the table of the meshes, in SI
convergence.png       the picture
====================  ==========================================================================
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...core.results.own_files import FILES
from ...files import write_csv, write_json

if TYPE_CHECKING:
    from .result import ConvergenceResult

DATA, TABLE = "convergence.json", "convergence.csv"
NAMES = (DATA, TABLE, "convergence.png")
"""All files of a study, the picture included."""


def write_files(result: "ConvergenceResult", folder: Path) -> list[Path]:
    """Write data and table.

    Parameters
    ----------
    result : ConvergenceResult
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
    write_json(files[0], {**as_data(result, table), FILES: NAMES})
    write_csv(files[1], table.column_names, table.to_pydict().values())
    return files


def as_data(result: "ConvergenceResult", table: Any) -> dict[str, Any]:
    """Return a study as plain data in SI.

    Parameters
    ----------
    result : ConvergenceResult
        The study.
    table : pyarrow.Table
        Its meshes.
    """
    return {
        "kind": result.kind,
        "name": result.name,
        "status": result.status,
        "project_file": result.project_file,
        "packings": result.packings,
        "meshes": table.to_pylist(),
        "departures": [
            {
                "figure": entry.quantity.name,
                "refined": entry.refined,
                "share": entry.share,
                "standard_error": entry.error,
                "verdict": entry.verdict,
            }
            for entry in result.departures
        ],
        "warnings": result.warnings,
        "remarks": result.notes,
    }
