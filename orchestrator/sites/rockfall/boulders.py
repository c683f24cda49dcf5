"""Measured boulders from a CSV file: mass and size of each."""

from collections.abc import Mapping
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
LONGEST = 10.0
"""Largest elongation of an ellipse."""
_REMEDY = "correct the value, or remove the line"
_Floats = NDArray[np.float64]

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
    table = titled_columns(path, UNITS, problems)
    columns = table.values
    by_radius = "radius" in columns
    names = ("mass", "radius") if by_radius else ("mass", *_LENGTHS)
    if len(problems) == before:
        problems += needed(path, columns, names, UNITS)
    if len(problems) > before:
        return []
    if not len(columns["mass"]):
        problems.append(Problem(str(path), "has no boulders", "give a line for each"))
    for name in names:
        for row in np.flatnonzero(~(columns[name] > 0.0)).tolist():
            text = f"boulder {row + 1} has no {name} above 0"
            problems.append(Problem(table.places[row], text, _REMEDY))
    if len(problems) > before:
        return []
    radius, elongation = _sizes(columns, by_radius, is_ellipse)
    for row in np.flatnonzero(~((elongation >= 1.0) & (elongation <= LONGEST))).tolist():
        text = f"boulder {row + 1} has the elongation {elongation[row]:.4g}; 1 to {LONGEST:g} is"
        problems.append(Problem(table.places[row], f"{text} allowed", _REMEDY))
    rows = zip(columns["mass"], radius, elongation, strict=True)
    return [(float(mass), float(size), float(long)) for mass, size, long in rows]


def _sizes(
    columns: Mapping[str, _Floats], by_radius: bool, is_ellipse: bool
) -> tuple[_Floats, _Floats]:
    """Return radii (m) and elongations."""
    if by_radius:
        return columns["radius"], columns.get("elongation", np.ones_like(columns["radius"]))
    lengths = -np.sort(-np.array([columns[name] for name in _LENGTHS]), axis=0)
    if is_ellipse:
        return 0.5 * np.sqrt(lengths[0] * lengths[1]), lengths[0] / lengths[1]
    return 0.5 * np.prod(lengths, axis=0) ** (1 / 3), np.ones_like(lengths[0])
