"""Measured end points of rocks, and what was measured at search lines, from a CSV file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rockshed.components.slope_rockfall.records import OUTCOME, PASSAGE, RESTED

from ...campaigns.campaign import Campaign, TrialRecords
from ...core.errors import InputRefused, Problem
from ...input_files.form import first
from ...input_files.titled_table import needed, titled_columns
from ..frame import FloatArray

FEWEST = 5
"""Least number of measured end points."""
X = "x"
"""Title of the column of the end points."""
_AT_LINE = {
    "height": (PASSAGE.height, "m"),
    "speed": (PASSAGE.speed, "m/s"),
    "energy": (PASSAGE.kinetic, "J"),
}
"""Column of the passages, and unit, of what may be measured at a line."""


@dataclass(frozen=True)
class Observed:
    """Measured values of one quantity, each of another rock.

    Attributes
    ----------
    name : str
        ``x``, or ``LINE.height``, ``LINE.speed``, ``LINE.energy``.
    unit : str
        In SI.
    values : array of float, shape (n,)
        Measured.
    scatter : float
        Standard deviation by which measured values may lie beside computed ones.
    line, column : int
        Of the passages of the campaign; -1 for the end points.
    """

    name: str
    unit: str
    values: FloatArray
    scatter: float
    line: int = -1
    column: int = -1

    def computed(self, records: TrialRecords) -> FloatArray:
        """Return the computed values: of rocks that come to rest, or that pass the line."""
        if self.line < 0:
            rested = records.outcomes[:, OUTCOME.end] == RESTED
            return np.asarray(records.outcomes[rested, OUTCOME.x])
        passed = records.passages[:, self.line, PASSAGE.count] > 0.0
        return np.asarray(records.passages[passed, self.line, self.column])


def read_endpoints(path: Path, campaign: Campaign, scatter: float) -> list[Observed]:
    """Read measured end points, and what was measured at search lines.

    Parameters
    ----------
    path : Path
        CSV file with a column ``x (m)``, and any of ``LINE.height (m)``, ``LINE.speed (m/s)`` and
        ``LINE.energy (kJ)`` for search lines of the site; empty fields are values not measured.
    campaign : Campaign
        With the profile's ends and the search lines.
    scatter : float
        Of the end points (m); that of other quantities is a tenth of their deviation.

    Returns
    -------
    list of Observed
        The end points first.

    Raises
    ------
    InputRefused
        Everything that is wrong with the file, with line and column.
    """
    known = {
        f"{line}.{name}".lower(): (f"{line}.{name}", i, column, unit)
        for i, line in enumerate(campaign.names)
        for name, (column, unit) in _AT_LINE.items()
    }
    units = {X: "m", **{title: entry[3] for title, entry in known.items()}}
    problems: list[Problem] = []
    columns = titled_columns(path, units, problems)
    problems += needed(path, columns, [X], {X: "m"}) if not problems else []
    if X in columns:
        problems += _off_profile(path, columns, campaign)
    if problems:
        raise InputRefused(first(problems))
    ends = columns.pop(X)
    observed = [Observed(X, "m", ends[np.isfinite(ends)], scatter)]
    for title, (name, line, column, unit) in known.items():
        values = columns.get(title, np.empty(0))
        values = values[np.isfinite(values)]
        if len(values) > 1:
            wide = max(0.1 * float(values.std(ddof=1)), 1e-3 * float(np.abs(values).max()))
            observed.append(Observed(name, unit, values, wide, line, column))
    return observed


def _off_profile(
    path: Path, columns: Mapping[str, FloatArray], campaign: Campaign
) -> Sequence[Problem]:
    ends = columns[X]
    problems = [
        Problem(
            f"{path}, end point {row + 1}",
            f"x = {ends[row]:g} m is off the profile, which has {campaign.left:g} to "
            f"{campaign.right:g} m",
            "give x in the frame of the profile, or a longer profile",
        )
        for row in np.flatnonzero((ends < campaign.left) | (ends > campaign.right))
    ]
    count = int(np.isfinite(ends).sum())
    if count < FEWEST:
        text = f"has {count} end points, from which nothing can be inferred"
        problems.append(Problem(str(path), text, f"give {FEWEST} or more"))
    return problems
