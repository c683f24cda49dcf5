"""The result of a convergence study."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from ...core.results.columns import result_column, result_table
from ...core.results.metric import Metric
from ...tables import Table
from ..frame import Result, shared_folder
from .figures import QUANTITIES, Departure, Measured, departures
from .files import NAMES, write_files
from .meshes import DISCS, ELEMENTS
from .tables import departure_table, mesh_table


class ConvergenceResult(Result):
    """Figures of a shed with coarser and finer sand discs and beam elements.

    Attributes
    ----------
    measured : tuple of Measured
        Meshes of the discs, then of the elements, each from coarse to fine.
    packings : int
        Number of packings of the sand for each mesh.
    project_file : str
        Where the project stands; empty for content that stands in no file.
    """

    kind = "convergence"
    picture_folder = "."

    def __init__(
        self, name: str, measured: Sequence[Measured], packings: int, project_file: str = ""
    ) -> None:
        super().__init__()
        self._name = name
        self.measured = tuple(measured)
        self.packings = packings
        self.project_file = project_file

    @classmethod
    def opened(cls, folder: str | Path) -> AbstractContextManager[Path]:
        """Open the folder of the results, in which other files stay as they are."""
        return shared_folder(folder, NAMES)

    @property
    def name(self) -> str:
        """Name of the project, or of its file; it names the figures."""
        return self._name

    @property
    def departures(self) -> list[Departure]:
        """How far each figure of the project's own mesh is from that of the finest one."""
        return list(departures(self.measured))

    def metric_list(self) -> list[Metric]:
        """Return each departure from the finest mesh, with its standard error."""
        found = []
        for entry in self.departures:
            name = f"{entry.quantity.name} of the project / of the finest {entry.refined} - 1"
            found += [Metric(name, entry.share), Metric(f"standard error of {name}", entry.error)]
        return found

    @property
    def summary(self) -> str:
        """Number of figures that are converged, in one line."""
        found = self.departures
        return f"{sum(entry.converged for entry in found)} of {len(found)} figures converged"

    @property
    def notes(self) -> list[str]:
        """Meaning of the numbers, and of the verdicts."""
        return [
            f"means over {self.packings} packings of the sand, ± standard error; the sizes of the "
            "discs are refined with the project's elements, and the elements with its discs",
            "settled maxima of all meshes: without what is faster than the cut-off frequency of "
            "the project's own discs",
            "a figure counts as converged where its departure from the finest mesh and the "
            "standard error of that together are at most 3 %",
        ]

    @property
    def warnings(self) -> list[str]:
        """Runs without a result, each with its reason, which the means leave out."""
        return [
            f"{entry.mesh.discs} discs, {entry.mesh.elements} elements: a run has no result and is "
            f"left out: {reason}"
            for entry in self.measured
            for reason in entry.failed
        ]

    def tables(self) -> list[Table]:
        """Return the figures of the discs, of the elements, and the departures."""
        return [
            mesh_table(self.measured, DISCS),
            mesh_table(self.measured, ELEMENTS),
            departure_table(self.departures),
        ]

    def to_arrow(self) -> Any:
        """Return a row for each mesh: sizes, means and standard errors, in SI."""
        rows = self.measured
        columns = [
            result_column("refined", [e.mesh.refined for e in rows], "1", "what is refined"),
            result_column("disc_radius", [e.mesh.disc_radius for e in rows], "m", "mean radius"),
            result_column("discs", [e.mesh.discs for e in rows], "1", "number of sand discs"),
            result_column("elements", [e.mesh.elements for e in rows], "1", "beam elements"),
            result_column("runs", [e.runs for e in rows], "1", "runs with a result"),
        ]
        for quantity in QUANTITIES:
            found = [e.estimates.get(quantity.name) for e in rows]
            means = [e.mean if e else None for e in found]
            errors = [e.error if e else None for e in found]
            name = quantity.name.replace(" ", "_")
            unit = quantity.si_unit
            columns.append(result_column(name, means, unit, f"mean {quantity.name}"))
            columns.append(result_column(f"{name}_error", errors, unit, "standard error"))
        return result_table(columns)

    def write_files(self, folder: Path) -> list[Path]:
        """Write data and table into a folder, and return the files."""
        return write_files(self, folder)
