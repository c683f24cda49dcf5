"""Variables of several runs and measured curves over one axis of time."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..core.errors import InputRefused, Problem
from ..core.results.reading import StoredRun
from ..core.results.series import Series
from ..core.system.names import nearest, select
from ..metrics import comparison, measured
from ..tables import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOST_WORDS = 6
"""Lines below a picture that tell how computed and measured curves agree, at most."""


@dataclass(frozen=True)
class Overlay:
    """Variables of runs, and measured curves beside them.

    Attributes
    ----------
    runs : mapping of str to sequence of Series
        Variables by the name of their run.
    curves : sequence of MeasuredCurve
        What was measured.
    caption : sequence of str
        What was run.
    """

    runs: Mapping[str, Sequence[Series]]
    curves: Sequence[measured.MeasuredCurve]
    caption: Sequence[str]

    @property
    def agreements(self) -> list[measured.Agreement]:
        """Errors of each computed curve in peak, impulse and duration."""
        return measured.agreements(self.runs, self.curves)

    def table(self) -> Table:
        """Return the errors as a table."""
        return measured.table(self.agreements)

    def figure(self, side_by_side: bool = False) -> "Figure":
        """Draw all, with the errors below.

        Parameters
        ----------
        side_by_side : bool
            Whether each run has a column of panels of its own.

        Returns
        -------
        matplotlib.figure.Figure
            With a panel for each unit.
        """
        from ..pictures.variables import draw  # imports matplotlib

        words = [entry.in_words() for entry in self.agreements]
        more = len(words) - _MOST_WORDS
        words = words[:_MOST_WORDS] + ([f"and {more} more"] if more > 0 else [])
        return draw(self.runs, self.curves, [*words, *self.caption], side_by_side)


def overlay(
    runs: Sequence[StoredRun], names: Iterable[str], file: str | Path | None = None
) -> Overlay:
    """Lay variables of runs over one another, and measured curves over them.

    Parameters
    ----------
    runs : sequence of StoredRun
        The runs.
    names : iterable of str
        Names of recorded variables; ``*`` stands for any text.
    file : path, optional
        CSV file of measured curves, see :func:`rockshed.metrics.measured.read_measured`.

    Returns
    -------
    Overlay
        Of all variables of these names.

    Raises
    ------
    InputRefused
        No name is there, a run has no such variable, or something is wrong with the file.
    """
    wanted = list(names)
    labels = _labels(runs)
    problems = [
        Problem(f"variable {name}", f"{label} has none of this name", nearest(name, run.series))
        for label, run in zip(labels, runs, strict=True)
        for name in wanted
        if not _chosen(run, [name])
    ]
    if not wanted:
        some = ", ".join([*runs[0]][1:4])
        remedy = f"name some, {some} for instance; * stands for any text"
        problems.append(Problem("plot", "there is no variable to draw", remedy))
    if problems:
        raise InputRefused(problems)
    series = {
        label: [run[name] for name in _chosen(run, wanted)]
        for label, run in zip(labels, runs, strict=True)
    }
    units = [entry.unit for part in series.values() for entry in part]
    curves = measured.read_measured(file, units) if file is not None else []
    return Overlay(series, curves, _caption(runs, labels))


def _chosen(run: StoredRun, names: Iterable[str]) -> list[str]:
    """Return the variables of these names, each once."""
    known = [name for name in run if name != "time"]
    return list(dict.fromkeys(found for name in names for found in select(name, known)))


def _labels(runs: Sequence[StoredRun]) -> list[str]:
    """Return a name for each run, each once: of its folder, with those above where it has to be."""
    names = [run.folder.absolute().name for run in runs]
    if len(set(names)) == len(names):
        return names
    return [f"{number}: {run.folder}" for number, run in enumerate(runs, 1)]


def _caption(runs: Sequence[StoredRun], labels: Sequence[str]) -> list[str]:
    """Return what was run: of several runs, case and changes of each."""
    if len(runs) == 1:
        return comparison.caption(runs[0])
    return [
        f"{label}: {'; '.join(comparison.caption(run)[:2])}"
        for label, run in zip(labels, runs, strict=True)
    ]
