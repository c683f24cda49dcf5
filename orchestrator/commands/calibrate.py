"""The command ``rockshed calibrate``."""

import re
from collections.abc import Mapping
from pathlib import Path

from ..analyses.calibration.measurement import FORCES, LENGTHS, Measurement, of_stiffness, table_4
from ..analyses.calibration.run import calibrate
from ..core.errors import InputRefused, Problem
from ..core.system.system import Value
from ..core.system.values import finite_number
from .analysis import options_named, stages
from .screen import Screen

PAPER = "sonoda1993"
"""Name of the six tests of table 4, in the place of a file."""
STIFFNESSES = {
    f"{force}/{length}": factor / size
    for force, factor in FORCES.items()
    for length, size in LENGTHS.items()
}
"""Units of spring constants and their sizes (N/m)."""


def show_calibration(
    screen: Screen,
    results: Path,
    target: str | None,
    *,
    stiffness: str | None,
    rotation: str,
    values: Mapping[str, Value],
    seeds: int,
    output_dir: Path | None,
    workers: int | None,
) -> None:
    """Calibrate the sand and show its moduli or JSON.

    Parameters
    ----------
    screen : Screen
        Of the command.
    results : Path
        Folder of the results that name no other.
    target, stiffness, rotation, values, seeds, output_dir, workers
        Options of the command.

    Raises
    ------
    InputRefused
        Everything that is wrong with the options or the measurement.
    RunFailed
        A static test could not go on.
    """
    measurement = measurement_from(target, stiffness)
    with options_named(("rotation", "seeds")), stages(screen) as progress:
        result = calibrate(
            measurement,
            rotation=rotation,
            values=values,
            seeds=seeds,
            workers=workers,
            folder=output_dir or results / "calibration",
            pictures=True,
            progress=progress,
            note=screen.note,
        )
    files = [*result.files, *result.pictures]
    if screen.as_json:
        listed = [str(file) for file in files]
        screen.dump({"status": result.status, **result.as_data(), "files": listed})
        return
    for table in result.tables():
        screen.table(table)
    screen.say("")
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
        return of_stiffness(stiffness_from(stiffness), f"k = {stiffness}")
    return table_4() if target == PAPER else Path(str(target))


def stiffness_from(text: str) -> float:
    """Read a spring constant.

    Parameters
    ----------
    text : str
        Number and unit: ``39.1 kgf/cm``.

    Returns
    -------
    float
        Spring constant (N/m).

    Raises
    ------
    InputRefused
        No number, no or another unit, not above zero.
    """
    parts = re.fullmatch(r"\s*(\S*?\d\.?)\s*([A-Za-z]+/[A-Za-z]+)?\s*", text)
    value = finite_number(parts.group(1)) if parts else None
    remedy = f"write a number and one of {', '.join(STIFFNESSES)}: --stiffness '39.1 kgf/cm'"
    if parts is None or value is None:
        fault = f"{text!r} is no spring constant"
    elif parts.group(2) not in STIFFNESSES:
        unit = f"the unit {parts.group(2)}" if parts.group(2) else "no unit"
        fault = f"{text!r} has {unit}"
    elif value <= 0.0:
        fault = f"{text!r} is not above zero"
        remedy = "give the measured spring constant"
    else:
        return value * STIFFNESSES[parts.group(2)]
    raise InputRefused([Problem("--stiffness", fault, remedy)])
