"""Measured boulders from a CSV file: mass and size of each."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...core.errors import Problem
from ...input_files.titled_table import needed, titled_columns

UNITS = {
    "mass": "kg",
    "length1": "m",
    "length2": "m",
    "length3": "m",
    "radius": "m",
    "elongation": "1",
}
"""Titles of the columns that are read, and their units."""
_LENGTHS = ("length1", "length2", "length3")

Boulder = tuple[float, float, float]
"""Mass (kg), radius (m) and elongation."""


def read_boulders(path: Path, is_ellipse: bool, problems: list[Problem]) -> list[Boulder]:
    """Read boulders with their masses, and their radii or the lengths of their bounding boxes.

    Of three lengths an ellipse has the two longest as its axes: a fast block turns about its
    shortest axis. Any other shape has half the cube root of their product as its radius.

    Parameters
    ----------
    path : Path
        CSV file with the columns mass, and radius (and elongation) or length1, length2, length3.
    is_ellipse : bool
        Whether the rocks are ellipses.
    problems : list of Problem
        Faults are appended.

    Returns
    -------
    list of Boulder
        One for each line.
    """
    before = len(problems)
    columns = titled_columns(path, UNITS, problems)
    by_radius = "radius" in columns
    names = ("mass", "radius") if by_radius else ("mass", *_LENGTHS)
    if len(problems) == before:
        problems += needed(path, columns, names, UNITS)
    if len(problems) > before:
        return []
    used = [name for name in (*names, "elongation") if name in columns]
    for name in used:
        low = 1.0 if name == "elongation" else 0.0
        good = columns[name] >= low if name == "elongation" else columns[name] > low
        for row in np.flatnonzero(~good):
            text = f"boulder {row + 1} has no {name} above {low:g}"
            problems.append(Problem(str(path), text, "correct the value, or remove the line"))
    if not len(columns["mass"]):
        problems.append(Problem(str(path), "has no boulders", "give a line for each"))
    if len(problems) > before:
        return []
    if by_radius:
        long = columns.get("elongation", np.ones(len(columns["mass"])))
        return _rows(columns["mass"], columns["radius"], long)
    lengths = -np.sort(-np.array([columns[name] for name in _LENGTHS]), axis=0)
    if is_ellipse:
        radius = 0.5 * np.sqrt(lengths[0] * lengths[1])
        return _rows(columns["mass"], radius, lengths[0] / lengths[1])
    return _rows(
        columns["mass"], 0.5 * np.prod(lengths, axis=0) ** (1 / 3), np.ones_like(columns["mass"])
    )


def _rows(*columns: NDArray[np.float64]) -> list[Boulder]:
    return [(float(m), float(r), float(e)) for m, r, e in zip(*columns, strict=True)]
