"""Files of a calibration.

====================  ==========================================================================
calibration.json      fits, tests and remarks, in SI
calibration.csv       the table, in the units of the paper
curve.csv             measured and computed loads, where a curve was measured
calibration.png       the picture
====================  ==========================================================================
"""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rockshed.components.common.units import cm, kgf

from ...core.results.columns import result_column, result_table
from ...core.results.own_files import FILES
from ...files import whole_file, write_json
from .fit import Fit
from .search import Calibration
from .tables import HEADINGS, cells, settings

DATA, TABLE, CURVE = "calibration.json", "calibration.csv", "curve.csv"
NAMES = (DATA, TABLE, CURVE, "calibration.png")
"""All files of a calibration, the picture included."""
_CURVE_HEADINGS = ("penetration (cm)", "load (kgf)", "computed load (kgf)", "spread (kgf)")


def as_data(calibrations: Sequence[Calibration], remarks: Sequence[str]) -> dict[str, Any]:
    """Return calibrations as plain data in SI.

    Parameters
    ----------
    calibrations : sequence of Calibration
        The best first.
    remarks : sequence of str
        For the reader.

    Returns
    -------
    dict
        Content of ``calibration.json``.
    """
    return {
        "calibrations": [
            {
                "rotation": made.rotation,
                "settings": settings(made),
                "tests": [{"e_bar": push.modulus, "seed": push.seed} for push in made.pushes],
                "results": [_fit_data(fit) for fit in made.fits],
            }
            for made in calibrations
        ],
        "unit_of_e_bar": "Pa",
        "remarks": list(remarks),
    }


def _fit_data(fit: Fit) -> dict[str, Any]:
    measured = fit.measured
    return {
        "measurement": measured.name,
        "e_bar": fit.modulus,
        "uncertainty": fit.uncertainty,
        "spread_of_samples": fit.spread,
        "error_of_the_curve": fit.misfit if measured.is_curve else None,
        "exponent": fit.exponent,
        "printed": measured.printed,
        "penetration": measured.depth.tolist(),
        "measured_load": measured.load.tolist(),
        "computed_load": fit.load.tolist(),
        "computed_load_spread": fit.load_spread.tolist(),
    }


def modulus_columns(calibrations: Sequence[Calibration]) -> Any:
    """Return a row for each measurement with each model.

    Parameters
    ----------
    calibrations : sequence of Calibration
        The best first.

    Returns
    -------
    pyarrow.Table
        Spring constant (N/m), E_bar and its uncertainty (Pa), exponent, error of the curve; null
        where there is none.
    """
    fits = [(made.rotation, fit) for made in calibrations for fit in made.fits]
    misfits = [fit.misfit if fit.measured.is_curve else None for _, fit in fits]
    entries: list[tuple[str, list[Any], str, str]] = [
        ("measurement", [fit.measured.name for _, fit in fits], "1", "name of the measurement"),
        ("rotation", [rotation for rotation, _ in fits], "1", "rotation model of the sand"),
        ("stiffness", [fit.measured.stiffness for _, fit in fits], "N/m", "at the deepest point"),
        ("e_bar", [fit.modulus for _, fit in fits], "Pa", "fictitious modulus"),
        ("uncertainty", [fit.uncertainty for _, fit in fits], "Pa", "standard uncertainty"),
        ("spread", [fit.spread for _, fit in fits], "Pa", "standard deviation of the samples"),
        ("exponent", [fit.exponent for _, fit in fits], "1", "power of the load over E_bar"),
        ("error_of_the_curve", misfits, "1", "root mean square of the load / measured one"),
        ("printed", [fit.measured.printed for _, fit in fits], "Pa", "modulus in the paper"),
    ]
    return result_table([result_column(*entry) for entry in entries])


def write_files(
    calibrations: Sequence[Calibration], remarks: Sequence[str], folder: Path
) -> list[Path]:
    """Write data, table, and curve where one was measured.

    Parameters
    ----------
    calibrations : sequence of Calibration
        The best first.
    remarks : sequence of str
        For the reader.
    folder : Path
        Exists.

    Returns
    -------
    list of Path
        Of the files.
    """
    files = [folder / DATA, folder / TABLE]
    write_json(files[0], {**as_data(calibrations, remarks), FILES: NAMES})
    _write_csv(files[1], HEADINGS, cells(calibrations))
    best = calibrations[0].fits[0]
    if best.measured.is_curve:
        files.append(folder / CURVE)
        loads = (best.measured.load / kgf, best.load / kgf, best.load_spread / kgf)
        columns = (best.measured.depth / cm, *loads)
        rows = [[f"{value:.5g}" for value in row] for row in zip(*columns, strict=True)]
        _write_csv(files[-1], _CURVE_HEADINGS, rows)
    return files


def _write_csv(file: Path, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    with whole_file(file) as temporary, temporary.open("w", newline="", encoding="utf-8") as text:
        csv.writer(text).writerows([head, *rows])
