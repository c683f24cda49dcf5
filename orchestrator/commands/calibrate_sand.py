"""The command ``rockshed calibrate sand``: E_bar of a sand from a measurement."""

import json
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ..analyses.calibration.files import DATA
from ..analyses.calibration.measurement import Measurement, of_text, table_4
from ..analyses.calibration.result import CalibrationResult
from ..analyses.calibration.run import COMPUTED, MeasurementLike, calibrate, measurements_of
from ..core.errors import InputRefused, Problem, RunFailed, all_causes
from ..runs.building import is_cold
from .analysis import kept_if_ended, options_named, stages
from .assignments import values_of
from .options import Assignments, Json, Quiet, Workers
from .results_place import Origin, free_folder, look_at_place
from .screen import COLD_START, RUN_FAILED, Screen, opened

PAPER = "sonoda1993"
"""Name of the six tests of table 4, in the place of a file."""

_OPTIONS = ("rotation", "values", "seeds", "workers", "folder")
"""Arguments of the analysis that are options of the command."""

_Curve = Annotated[
    str | None,
    typer.Argument(
        metavar="CURVE.csv|sonoda1993",
        show_default=False,
        help="Measured load-penetration curve, columns `penetration (cm)` and `load (kgf)` or "
        "other units; or table 4 of the paper.",
    ),
]
_Stiffness = Annotated[
    str | None,
    typer.Option(
        metavar="'NUMBER UNIT'",
        help="Measured secant spring constant at 4 cm instead: '39.1 kgf/cm', '38.3 kN/m'.",
    ),
]
_Rotation = Annotated[
    str,
    typer.Option(
        metavar="locked|free|fit",
        help="Rotation model of the sand; fit: the one that has the curve.",
    ),
]
_Seeds = Annotated[int, typer.Option(min=2, help="Samples of the sand for each E_bar.")]
_Folder = Annotated[
    Path | None, typer.Option(help="Folder of the results; default results/calibration.")
]


def command(
    target: _Curve = None,
    stiffness: _Stiffness = None,
    rotation: _Rotation = "locked",
    set_: Assignments = None,
    seeds: _Seeds = 5,
    output_dir: _Folder = None,
    workers: Workers = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find E_bar of a sand from a spring constant or a load-penetration curve.

    The static test is computed until it has what was measured.
    """
    with opened(quiet, as_json) as screen:
        problems: list[Problem] = []
        values = values_of("--set", set_ or [], problems)
        looks = (partial(_look_at_measurement, target, stiffness), look_at_place(output_dir))
        with all_causes(*looks):
            if problems:
                raise InputRefused(problems)
            measurement = measurement_from(target, stiffness)
        if is_cold(COMPUTED):
            screen.note(COLD_START)
        folder = output_dir or _folder(measurement, screen)
        kept = kept_if_ended(screen, folder)
        try:
            with kept, options_named(_OPTIONS), stages(screen) as progress:
                result = calibrate(
                    measurement,
                    rotation=rotation,
                    values=values,
                    seeds=seeds,
                    workers=workers,
                    folder=folder,
                    pictures=True,
                    progress=progress,
                    note=screen.note,
                )
        except RunFailed as failure:
            screen.fail(str(failure))
            raise typer.Exit(RUN_FAILED) from None
        _show(screen, result)


def _look_at_measurement(target: str | None, stiffness: str | None) -> None:
    """Look at what was measured alone."""
    measurements_of(measurement_from(target, stiffness))


def _folder(measurement: MeasurementLike, screen: Screen) -> Path:
    """Return the folder of the results of a measurement that the user has named no folder for."""
    origin: Origin = {}
    with suppress(InputRefused):  # the calibration itself refuses it, with all other problems
        measured = measurements_of(measurement)
        origin = {
            "measurement": [entry.name for entry in measured],
            "measured_load": [entry.load.tolist() for entry in measured],
        }
    return free_folder("calibration", origin, _measured, screen)


def _measured(folder: Path) -> Any:
    """Return the measurements of a calibration that is in a folder."""
    content = json.loads((folder / DATA).read_text(encoding="utf-8"))
    results = content["calibrations"][0]["results"]
    return {key: [entry[key] for entry in results] for key in ("measurement", "measured_load")}


def _show(screen: Screen, result: CalibrationResult) -> None:
    files = [*result.files, *result.pictures]
    if screen.as_json:
        listed = [str(file) for file in files]
        screen.dump({"status": result.status, **result.as_data(), "files": listed})
        return
    screen.show(*result.tables(), "")
    for text in result.notes:
        screen.say(text)
    screen.say(f"results in {result.folder}: " + ", ".join(file.name for file in files))


def measurement_from(
    target: str | None, stiffness: str | None
) -> Measurement | list[Measurement] | Path:
    """Return the measurement that the options of the command name.

    Parameters
    ----------
    target : str or None
        CSV file, or :data:`PAPER`.
    stiffness : str or None
        Spring constant with its unit.

    Returns
    -------
    Measurement, list of Measurement or Path
        As :func:`~rockshed.analyses.calibration.run.calibrate` takes it.

    Raises
    ------
    InputRefused
        None or both of them, or a spring constant that is none.
    """
    if (target is None) == (stiffness is None):
        text = "takes either a file or --stiffness" + (", not both" if target else "")
        example = "rockshed calibrate CURVE.csv, --stiffness '39.1 kgf/cm'"
        remedy = f"{example}, or {PAPER} for table 4"
        raise InputRefused([Problem("calibrate", text, remedy)])
    if stiffness is not None:
        return of_text(stiffness, "--stiffness")
    return table_4() if target == PAPER else Path(str(target))
