"""Measured end points of rocks, and what was measured at search lines, from a CSV file."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rockshed.components.slope_rockfall.records import OUTCOME, PASSAGE, RESTED

from ...campaigns.campaign import Campaign, TrialRecords
from ...core.errors import InputRefused, Problem
from ...core.input_text import shown
from ...core.system.names import nearest
from ...input_files.form import first
from ...input_files.titled_table import TitledColumns, needed, titled_columns
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
_OF_LINE = re.compile(r"\s*(.+)\.(height|speed|energy)\b", re.IGNORECASE)
"""Title of a column of a search line, with or without a unit."""


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
    table = titled_columns(path, units, problems)
    problems += needed(path, table.values, [X], {X: "m"}) if not problems else []
    problems += _unknown_lines(table, campaign)
    if X in table.values:
        problems += _end_problems(path, table, campaign)
    for title, (name, *_) in known.items():
        problems += _line_problems(path, table, title, name)
    if problems:
        raise InputRefused(first(problems))
    observed = [Observed(X, "m", _there(table, X), scatter)]
    for title, (name, line, column, unit) in known.items():
        values = _there(table, title)
        if len(values):
            wide = max(0.1 * float(values.std(ddof=1)), 1e-3 * float(values.max()))
            observed.append(Observed(name, unit, values, wide, line, column))
    return observed


def _there(table: TitledColumns, title: str) -> FloatArray:
    """Return the measured values of a column, none of one that is not there."""
    values = table.values.get(title, np.empty(0))
    return values[np.isfinite(values)]


def _unknown_lines(table: TitledColumns, campaign: Campaign) -> Iterator[Problem]:
    """Yield the columns of lines that the site does not have."""
    for title, place in table.others.items():
        found = _OF_LINE.match(title)
        if found and found[1].strip().lower() not in map(str.lower, campaign.names):
            text = f"{shown(title)}: the site has no line {shown(found[1].strip())}"
            yield Problem(place, text, nearest(found[1].strip(), campaign.names))
        elif found:
            text = f"{shown(title)} is no column with a unit"
            _, unit = _AT_LINE[found[2].lower()]
            yield Problem(place, text, f"write {found[1]}.{found[2]} ({unit})")


def _line_problems(path: Path, table: TitledColumns, title: str, name: str) -> Iterator[Problem]:
    """Yield values at a line that no rock has, and such of which nothing can be inferred."""
    column = table.values.get(title, np.empty(0))
    for row in np.flatnonzero(column < 0.0).tolist():
        text = f"{name} = {column[row]:g} is negative"
        yield Problem(table.places[row], text, "correct it, or leave the field empty")
    values = _there(table, title)
    if len(values) == 1 or (len(values) and not values.any()):
        text = f"has one value of {name}" if len(values) == 1 else f"has no {name} above 0"
        yield Problem(str(path), text, "give two or more, or leave the column out")


def _end_problems(path: Path, table: TitledColumns, campaign: Campaign) -> list[Problem]:
    """Return end points that are off the profile, or too few."""
    ends = table.values[X]
    problems = [
        Problem(
            table.places[row],
            f"x = {ends[row]:g} m is off the profile, which has {campaign.left:g} to "
            f"{campaign.right:g} m",
            "give x in the frame of the profile, or a longer profile",
        )
        for row in np.flatnonzero((ends < campaign.left) | (ends > campaign.right)).tolist()
    ]
    count = int(np.isfinite(ends).sum())
    if count < FEWEST:
        text = f"has {count} end points, from which nothing can be inferred"
        problems.append(Problem(str(path), text, f"give {FEWEST} or more"))
    return problems
