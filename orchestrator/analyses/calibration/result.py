"""The result of a calibration."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from ...core.results.metric import Metric
from ...tables import Table
from ..frame import Result, shared_folder
from .files import NAMES, as_data, modulus_columns, write_files
from .fit import Fit, Unreachable
from .search import Calibration
from .tables import E_BAR, modulus_table, notes


class CalibrationResult(Result):
    """The moduli E_bar that belong to measured static tests.

    Attributes
    ----------
    calibrations : sequence of Calibration
        One for each model of the sand, the best fit first.
    refused : mapping of str to Unreachable
        Models that do not have such loads, and why.
    was_chosen : bool
        Whether the best of several models was wanted.
    """

    kind = "calibration"
    picture_folder = "."

    def __init__(
        self,
        calibrations: Sequence[Calibration],
        refused: Mapping[str, Unreachable],
        was_chosen: bool,
    ) -> None:
        super().__init__()
        self.calibrations = tuple(calibrations)
        self.refused = refused
        self.was_chosen = was_chosen

    @classmethod
    def opened(cls, folder: str | Path) -> AbstractContextManager[Path]:
        """Open the folder of the results, in which other files stay as they are."""
        return shared_folder(folder, NAMES)

    @property
    def name(self) -> str:
        """Names of the measurements, in their order."""
        return ", ".join(fit.measured.name for fit in self.calibrations[0].fits)

    @property
    def best(self) -> Fit:
        """Fit to the first measurement with the best model."""
        return self.calibrations[0].fits[0]

    def metric_list(self) -> list[Metric]:
        """Return modulus, uncertainty, exponent and error of the curve of each fit."""
        return [metric for made in self.calibrations for metric in self._metrics_of(made)]

    def _metrics_of(self, made: Calibration) -> Iterator[Metric]:
        model = "" if made is self.calibrations[0] else f"{made.rotation}."
        for fit in made.fits:
            prefix = model if len(made.fits) == 1 else f"{model}{fit.measured.name}."
            yield Metric(f"{prefix}e_bar", fit.modulus, "Pa")
            yield Metric(f"{prefix}uncertainty", fit.uncertainty, "Pa")
            yield Metric(f"{prefix}exponent", fit.exponent)
            if fit.measured.is_curve:
                yield Metric(f"{prefix}error_of_the_curve", fit.misfit)

    @property
    def summary(self) -> str:
        """Modulus and uncertainty of the best fit in one line."""
        value = f"{self.best.modulus / E_BAR:.1f} ± {self.best.uncertainty / E_BAR:.1f} kgf/cm²"
        more = len(self.calibrations[0].fits) - 1
        return f"E_bar {value}" + (f", and {more} more" if more else "")

    @property
    def notes(self) -> list[str]:
        """Model of the sand, number of tests, meaning of the uncertainty."""
        reasons = [
            f"rotation {name} not possible: {problem.what}"
            for name, reason in self.refused.items()
            for problem in reason.problems
        ]
        return [*notes(self.calibrations[0], self.was_chosen), *reasons]

    def tables(self) -> list[Table]:
        """Return the moduli, in the units of the paper.

        Returns
        -------
        list of Table
            One table, with a row for each measurement and model.
        """
        return [modulus_table(self.calibrations)]

    def to_arrow(self) -> Any:
        """Return a row for each measurement and model.

        Returns
        -------
        pyarrow.Table
            Spring constant (N/m), E_bar and its uncertainty (Pa), exponent, error of the curve.
        """
        return modulus_columns(self.calibrations)

    def as_data(self) -> dict[str, Any]:
        """Return the content of ``calibration.json``: fits, tests and remarks, in SI."""
        return as_data(self.calibrations, self.notes)

    def write_files(self, folder: Path) -> list[Path]:
        """Write data, table, and curve where one was measured, into a folder, and return them."""
        return write_files(self.calibrations, self.notes, folder)
