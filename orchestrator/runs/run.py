"""A run as one looks at it: variables with units, metrics, warnings, tables and pictures."""

import shutil
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from ..core.errors import InputRefused, Problem
from ..core.results import reading
from ..core.results.own_files import add_files
from ..core.system.names import select
from ..metrics import comparison
from ..metrics.practice import formula_table
from ..tables import Table
from .building import Note, silent

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

    def plot(self, *names: str) -> "Figure":
        """Draw variables over time, a panel for each unit.

        Parameters
        ----------
        *names : str
            Names of recorded variables; ``*`` stands for any text.

        Returns
        -------
        matplotlib.figure.Figure
            A notebook shows it; ``savefig`` writes it.

        Raises
        ------
        UnknownName
            The run has no variable of a name.
        InputRefused
            No name is there.

        Examples
        --------
        >>> import rockshed
        >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
        >>> figure = rockshed.simulate(system).plot("rock.velocity.y", "sand.rock.force.*")
        >>> [axes.get_ylabel() for axes in figure.axes]
        ['velocity (m/s)', 'force (N)']
        """
        if not names:
            remedy = f"name some, {', '.join([*self][1:4])} for instance; * stands for any text"
            raise InputRefused([Problem("plot", "there is no variable to draw", remedy)])
        from ..pictures.variables import draw  # imports matplotlib

        chosen = dict.fromkeys(
            match for name in names for match in (select(name, list(self)) or [name])
        )
        return draw([self[name] for name in chosen], self.caption)

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
