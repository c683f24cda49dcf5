"""A run as one looks at it: variables with units, metrics, warnings, tables and pictures."""

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from ..core.errors import InputRefused, Problem
from ..core.results import reading
from ..core.results.own_files import add_files
from ..metrics import comparison
from ..metrics.practice import formula_table
from ..tables import Table
from .building import Note, silent
from .formats.choice import export_run
from .overlay import overlay

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Run(reading.StoredRun):
    """Results of a run.

    ``run["rock.position.x"]`` is a series with ``unit``, ``description`` and ``time``;
    ``run.metrics["peak_transmitted_force"]`` a value with ``unit`` and ``references``. A name that
    does not exist is a KeyError that names the nearest ones.
    """

    @property
    def warnings(self) -> list[str]:
        """Warnings of the run, and doubts about its figures."""
        return comparison.warnings(self)

    @property
    def caption(self) -> list[str]:
        """Case, what is other than there, model of the sand, exchange and steps; in short lines."""
        return comparison.caption(self)

    @property
    def notes(self) -> list[str]:
        """Origin of the references in :meth:`table`, and why something is not compared."""
        return comparison.notes(self, comparison.known_of(self))

    def table(self) -> Table:
        """Return the metrics that a designer asks for first, beside what others found.

        Returns
        -------
        Table
            Quantity, unit, computed value, references and deviations.
        """
        return comparison.table(self, comparison.known_of(self))

    def formulas(self) -> Table:
        """Return the formulas of practice for the impact, beside peak force and penetration.

        Returns
        -------
        Table
            Estimates with the deviation of the run from each; no row where it is no impact of a
            rock on a cushion. Its notes have parameters, ranges and sources.
        """
        return formula_table(self)

    def plot(
        self,
        *names: str,
        beside: Sequence[reading.StoredRun] = (),
        measured: str | Path | None = None,
        side_by_side: bool = False,
    ) -> "Figure":
        """Draw variables over time, a panel for each unit.

        Parameters
        ----------
        *names : str
            Names of recorded variables; ``*`` stands for any text.
        beside : sequence of Run
            Other runs whose variables of these names are drawn too.
        measured : str or Path, optional
            CSV file of measured curves that are drawn too: a column ``time (ms)`` and others with
            their units, ``force (kN)``. The errors in peak, impulse and duration stand below.
        side_by_side : bool
            Whether each run has a column of panels of its own.

        Returns
        -------
        matplotlib.figure.Figure
            A notebook shows it; ``savefig`` writes it.

        Raises
        ------
        UnknownName
            The run has no variable of a name.
        InputRefused
            No name is there, another run has no such variable, or the file of measured curves.

        Examples
        --------
        >>> import rockshed
        >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
        >>> figure = rockshed.simulate(system).plot("rock.velocity.y", "sand.rock.force.*")
        >>> [axes.get_ylabel() for axes in figure.axes]
        ['velocity (m/s)', 'force (N)']
        """
        for name in names:
            _ = self[name]  # of an unknown name a KeyError, as everywhere in Python
        return overlay([self, *beside], names, measured).figure(side_by_side)

    def against(self, measured: str | Path, *names: str) -> Table:
        """Return the errors of variables in peak, impulse and duration, beside measured curves.

        Parameters
        ----------
        measured : str or Path
            CSV file, as :meth:`plot` takes it.
        *names : str
            Names of recorded variables; ``*`` stands for any text.

        Returns
        -------
        Table
            A row for each number of each variable.

        Raises
        ------
        InputRefused
            No name is there, the run has no variable of a name, or the file of measured curves.
        """
        return overlay([self], names, measured).table()

    def figures(
        self, folder: str | Path | None = None, *, note: Note = silent, warn: Note = silent
    ) -> dict[str, Path]:
        """Draw every picture that the results of the run allow.

        Parameters
        ----------
        folder : str or Path, optional
            Folder of the PNG files; by default ``figures`` in the folder of the run.
        note : callable, optional
            Called with a line for each picture that the results have no data for.
        warn : callable, optional
            Called with a line for each picture that could not be drawn, and why.

        Returns
        -------
        dict of str to Path
            Files by the name of the picture: ``forces``, ``energy``, ...

        Raises
        ------
        InputRefused
            The folder cannot be written.
        """
        from .. import pictures  # imports matplotlib

        place = Path(folder) if folder is not None else self.folder / "figures"
        files = pictures.draw_all(self, place, note, warn)
        add_files(self.folder, files)
        return {file.stem: file for file in files}

    def export(self, format: str, output: str | Path | None = None) -> list[Path]:
        """Write the run in a format of other programs.

        Parameters
        ----------
        format : str
            ``csv``: time series as fmpy reads them. ``mat4``: time series and parameters as Dymola
            and OpenModelica have them. ``vtk``: recorded states for ParaView.
        output : str or Path, optional
            File, of ``vtk`` a folder; by default in the folder ``export`` of the run.

        Returns
        -------
        list of Path
            The files.

        Raises
        ------
        InputRefused
            The format is unknown, a library for it is missing, the run has nothing to write,
            something is there already, or it cannot be written.
        """
        return export_run(self, format, None if output is None else Path(output))

    def animate(
        self, file: str | Path | None = None, *, progress: Callable[[int, int], None] | None = None
    ) -> Path:
        """Write rock, sand with its force chains, and beam over time as an animation.

        Parameters
        ----------
        file : str or Path, optional
            Ends in ``.mp4`` or ``.gif``; by default in the folder of the pictures of the run.
        progress : callable, optional
            Called with the numbers of frames that are done, and of all.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputRefused
            The run has too few recorded states, the format is unknown or its packages are missing,
            or something else is there.
        """
        from ..pictures.sand_animation import animate_run  # imports matplotlib

        place = Path(file) if file is not None else None
        written = animate_run(self, place, progress or (lambda done, total: None))
        add_files(self.folder, [written])
        return written

    def save(self, folder: str | Path) -> Path:
        """Copy the results into a folder that does not exist yet.

        Parameters
        ----------
        folder : str or Path
            The new folder.

        Returns
        -------
        Path
            The folder, for :func:`rockshed.read_run` and ``rockshed plot``.

        Raises
        ------
        InputRefused
            There is such a folder, or it cannot be written.
        """
        place = Path(folder)
        try:
            shutil.copytree(self.folder, place)
        except OSError as error:
            reason = f"cannot be written: {error.strerror or error}"
            raise InputRefused([Problem(str(place), reason, "name a new folder")]) from error
        return place

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self)[1:-1])}</p>{self.table()._repr_html_()}"


def read_run(folder: str | Path) -> Run:
    """Read the results of a run, finished or not.

    Parameters
    ----------
    folder : str or Path
        Folder of the run.

    Returns
    -------
    Run
        Of a run that was killed, what it has left.

    Raises
    ------
    InputRefused
        There is no run, or a file of it is damaged.

    Examples
    --------
    >>> import rockshed, tempfile
    >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     done = rockshed.simulate(system, f"{folder}/run")
    ...     again = rockshed.read_run(f"{folder}/run")
    >>> again["rock.position.y"].unit
    'm'
    >>> list(again["rock.position.y"]) == list(done["rock.position.y"])
    True
    """
    return Run(**vars(reading.read_run(Path(folder))))
