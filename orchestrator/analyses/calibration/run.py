"""Carry out a calibration of the sand."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import NamedTuple

from rockshed.components.catalogue import component

from ...core.errors import InputRefused, Problem
from ...core.system.fields import Value
from ...runs.building import Note, silent
from ...runs.first_compilation import tell_first_compilation
from ...runs.kept import FINISHED, KeptRuns
from ..asked import remembering
from ..frame import StageProgress, counter, no_progress
from .curve_file import read_curve
from .measurement import Measurement, as_data, is_spring_constant, of_stiffness, of_text
from .result import CalibrationResult
from .search import ROTATIONS, SOUGHT, Means, by_misfit, calibration_of

COMPUTED = ("FallingRock", "SandCushion")
"""Components of the static test, by their names in the catalogue."""
BEST = "fit"
"""Name of the choice of the rotation model that has the curve."""

MeasurementLike = Measurement | Sequence[Measurement] | str | Path | float
"""Measurements, the CSV file of a load-penetration curve, or a spring constant: a number (N/m) or
text with its unit."""


def calibrate(
    measurement: MeasurementLike,
    *,
    rotation: str = "locked",
    values: Mapping[str, Value] | None = None,
    seeds: int = 5,
    workers: int | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
    note: Note = silent,
) -> CalibrationResult:
    """Find the fictitious modulus E_bar of a sand from a measured static loading test.

    The static test of Sonoda et al. 1993 is computed with several moduli and samples of the sand.

    Parameters
    ----------
    measurement : float, str, path, Measurement or sequence of Measurement
        Secant spring constant at 4 cm, a number (N/m) or with its unit (``"39.1 kgf/cm"``); CSV
        file of a load-penetration curve; measurements.
    rotation : str
        Rotation model of the sand: ``locked``, ``free``, or ``fit`` for the one that has the curve.
    values : mapping of str to Value, optional
        Further changes of the case ``static-test``, by ``component.parameter``.
    seeds : int
        Number of samples of the sand for each modulus, two at least.
    workers : int, optional
        Number of processes, by default one for each core.
    folder : path, optional
        Where the results are saved; other files stay there. Tests that have ended are kept there
        until all have: a calibration that was killed or interrupted goes on.
    pictures : bool
        Whether the figure is drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    CalibrationResult
        Fits, tables, metrics and figure.

    Raises
    ------
    InputRefused
        Everything that is wrong with the arguments, or loads that the sand does not have.
    RunFailed
        A static test could not go on.

    Examples
    --------
    >>> import rockshed
    >>> result = rockshed.calibrate(38.3e3, seeds=2)  # doctest: +SKIP
    >>> result.metrics["e_bar"].unit  # doctest: +SKIP
    'Pa'
    """
    place = Path(folder) / FINISHED if folder else None
    files = [measurement.absolute()] if isinstance(measurement, Path) else []
    if isinstance(measurement, str) and not is_spring_constant(measurement):
        files = [Path(measurement).absolute()]
    asked = {
        "measurement": str(files[0]) if files else as_data(measurement),
        "rotation": rotation,
        "values": values,
        "seeds": seeds,
        "workers": workers,
        "pictures": pictures,
    }
    with remembering(place, CalibrationResult.kind, asked, files):
        measurements = _checked(measurement, rotation, dict(values or {}), seeds)
        search = _Search(measurements, rotation, dict(values or {}), seeds, workers)
        return _calibrated(search, Path(folder) if folder else None, pictures, progress, note)


class _Search(NamedTuple):
    """A search for the moduli of measurements, and how it is made."""

    measurements: list[Measurement]
    rotation: str
    values: dict[str, Value]
    seeds: int
    workers: int | None


def _calibrated(
    search: _Search,
    folder: Path | None,
    pictures: bool,
    progress: StageProgress | None,
    note: Note,
) -> CalibrationResult:
    """Carry out a calibration, and save it where a folder is given."""
    show = progress or no_progress
    measurements, rotation, changes, seeds, workers = search
    models = list(ROTATIONS) if rotation == BEST else [rotation]
    kept = KeptRuns(folder / FINISHED) if folder else None
    means = Means(workers, note, counter(show, "static tests"), kept)
    with ExitStack() as opened:
        place = opened.enter_context(CalibrationResult.opened(folder)) if folder else None
        tell_first_compilation(map(component, COMPUTED))
        calibrations, refused = by_misfit(
            {
                model: partial(calibration_of, measurements, model, changes, seeds, means)
                for model in models
            }
        )
        result = CalibrationResult(calibrations, refused, rotation == BEST)
        if place is not None:
            result.write(place, pictures, show)
    if kept is not None:
        kept.clear()
    result.folder = folder
    return result


def measurements_of(measurement: MeasurementLike) -> list[Measurement]:
    """Return the measurements that a value stands for.

    Parameters
    ----------
    measurement : float, path, Measurement or sequence of Measurement
        Spring constant (N/m, or text with its unit), CSV file of a curve, or measurements.

    Returns
    -------
    list of Measurement
        One at least.

    Raises
    ------
    InputRefused
        The file is wrong, a spring constant is not above zero, or there is no measurement.
    """
    if isinstance(measurement, Measurement):
        return [measurement]
    if isinstance(measurement, str) and is_spring_constant(measurement):
        return [of_text(measurement)]
    if isinstance(measurement, str | Path):
        return [read_curve(Path(measurement))]
    if isinstance(measurement, int | float):
        if not measurement > 0.0:
            text = f"{measurement:g} N/m is not above zero"
            remedy = "give the measured spring constant"
            raise InputRefused([Problem("measurement", text, remedy)])
        return [of_stiffness(measurement)]
    if not measurement:
        raise InputRefused([Problem("measurement", "there is none", "give one at least")])
    return list(measurement)


def _checked(
    measurement: MeasurementLike, rotation: str, values: Mapping[str, Value], seeds: int
) -> list[Measurement]:
    """Return the measurements; everything that is wrong is refused at once."""
    problems = _problems(rotation, values, seeds)
    measurements: list[Measurement] = []
    try:
        measurements = measurements_of(measurement)
    except InputRefused as refusal:
        problems += refusal.problems
    if rotation == BEST and not all(measured.is_curve for measured in measurements):
        text = "needs a curve: any model has a given spring constant with some E_bar"
        remedy = "give a load-penetration curve, or choose free or locked"
        problems.append(Problem("rotation fit", text, remedy))
    if problems:
        raise InputRefused(problems)
    return measurements


def _problems(rotation: str, values: Mapping[str, Value], seeds: int) -> list[Problem]:
    """Return what is wrong with the choice of the model and of the samples."""
    problems = [
        Problem(name, "is chosen by the calibration", "leave it out")
        for name in values
        if name in SOUGHT
    ]
    if rotation not in (*ROTATIONS, BEST):
        remedy = f"choose one of {', '.join((*ROTATIONS, BEST))}"
        problems.append(Problem("rotation", f"{rotation!r} is unknown", remedy))
    if rotation == BEST and "sand.rotation" in values:
        text = "is what the rotation fit chooses"
        problems.append(Problem("sand.rotation", text, "leave one of them out"))
    if seeds < 2:
        text = f"{seeds} samples show no scatter"
        problems.append(Problem("seeds", text, "give two at least"))
    return problems
