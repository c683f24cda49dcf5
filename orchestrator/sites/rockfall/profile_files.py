"""Nodes of a profile from a CSV file or from a DXF drawing."""

import math
from collections.abc import Collection, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from ...core.errors import InputRefused, Problem, counted
from ...core.input_text import shown
from ...input_files.csv_table import CsvRow, CsvTable, read_csv
from ...input_files.form import LARGEST
from .profile import Node

FLAT = 0.01
"""Distance (m) between a curve of a drawing and the straight cells that replace it."""
TOUCH = 1e-6
"""Distance (m) at which ends of lines in a drawing are one point."""

FARTHEST = 1e8
"""Largest coordinate (m) of a drawing."""
MOST_POINTS = 100_000
"""Largest number of straight cells that replace a curve."""
_FOOT, _SURVEY_FOOT = 0.3048, 1200.0 / 3937.0
UNITS = {
    0: 1.0,
    1: _FOOT / 12.0,
    2: _FOOT,
    3: 5280.0 * _FOOT,
    4: 1e-3,
    5: 1e-2,
    6: 1.0,
    7: 1e3,
    8: 1e-6 * _FOOT / 12.0,
    9: 1e-3 * _FOOT / 12.0,
    10: 3.0 * _FOOT,
    11: 1e-10,
    12: 1e-9,
    13: 1e-6,
    14: 0.1,
    15: 10.0,
    16: 100.0,
    17: 1e9,
    18: 149597870700.0,
    19: 9460730472580800.0,
    20: 3.0856775814913673e16,
    21: _SURVEY_FOOT,
    22: _SURVEY_FOOT / 12.0,
    23: 3.0 * _SURVEY_FOOT,
    24: 5280.0 * _SURVEY_FOOT,
}
"""Lengths (m) of the units of a drawing by their number in DXF ($INSUNITS).

A foot is 0.3048 m, a US survey foot 1200/3937 m; a drawing without a unit counts in metres.
"""

# --- CSV ---


def nodes_of_csv(path: Path, problems: list[Problem]) -> Iterator[Node]:
    """Read a CSV file with one node a line.

    Parameters
    ----------
    path : Path
        Of the file, see :mod:`rockshed.input_files.csv_table`. Its first line names the columns:
        ``x,y`` or ``x,y,material`` (m).
    problems : list of Problem
        Faults are appended, with line and column.

    Yields
    ------
    Node
        In the order of the file.
    """
    try:
        table = read_csv(path)
    except InputRefused as refusal:
        problems += refusal.problems
        return
    header = [field.text.lower() for field in table.rows[0].fields] if table.rows else []
    if header[:2] != ["x", "y"] or header[2:] not in ([], ["material"]):
        remedy = "write x,y or x,y,material; commas, semicolons or tabs separate the columns"
        place = table.place(table.rows[0], 0) if table.rows else f"{path}, line 1, column 1"
        problems.append(Problem(place, "the first line does not name the columns", remedy))
        return
    for row in table.rows[1:]:
        yield from _csv_node(table, row, len(header), problems)


def _csv_node(
    table: CsvTable, row: CsvRow, columns: int, problems: list[Problem]
) -> Iterator[Node]:
    place = table.place(row, 0)
    if not 2 <= len(row.fields) <= columns:
        text = f"has {counted(len(row.fields), 'field')}"
        remedy = f"give {columns}, separated as in the first line"
        problems.append(Problem(place, text, remedy))
        return
    values = []
    for i, field in enumerate(row.fields[:2]):
        value = table.number(field)
        if value is None or abs(value) > LARGEST:
            fault = f"{shown(field.text)} is no finite number"
            problems.append(Problem(table.place(row, i), fault, "give a coordinate in m"))
        else:
            values.append(value)
    if len(values) == 2:
        material = row.fields[2].text if len(row.fields) == 3 else ""
        yield Node(values[0], values[1], material or None, place)


# --- DXF ---


def nodes_of_dxf(
    path: Path, layers: Collection[str] | None, known: Collection[str], problems: list[Problem]
) -> list[Node]:
    """Read lines, polylines and curves of a drawing's model space, joined end to end.

    Parameters
    ----------
    path : Path
        Of the drawing.
    layers : collection of str or None
        Layers that are read; None for all.
    known : collection of str
        Names of materials; a layer with such a name gives its cells this material.
    problems : list of Problem
        Faults are appended.

    Returns
    -------
    list of Node
        From left to right (m).
    """
    try:
        import ezdxf
    except ImportError:
        text = "reading a DXF drawing needs the package ezdxf"
        problems.append(Problem(str(path), text, 'install it: pip install "rockshed[dxf]"'))
        return []
    try:
        drawing = ezdxf.readfile(path)
        scale = _metres(path, drawing.units, problems)
        pieces = list(_pieces(path, drawing, layers, known, scale)) if scale else []
    except InputRefused as refusal:
        problems += refusal.problems
        return []
    except Exception as error:  # what a damaged drawing ends in is anything
        own = isinstance(error, (ezdxf.DXFError, OSError))  # others speak of Python, not of DXF
        reason = _reason(error) if own else "its entities are damaged"
        text = f"is no DXF drawing that can be read: {reason}"
        problems.append(Problem(str(path), text, "save it again as DXF"))
        return []
    if scale and not pieces:
        names = sorted({str(entity.dxf.layer) for entity in drawing.modelspace()})
        text = "has no line, polyline or curve on the layers that are read"
        remedy = f"set profile.layers; there are {', '.join(names[:12])}" if names else ""
        problems.append(Problem(str(path), text, remedy or "draw the profile"))
    return _joined(pieces, problems) if pieces else []


def _reason(error: Exception) -> str:
    """Return the first line of an error's message, or its kind where it has none."""
    lines = str(error).splitlines()
    return lines[0][:200] if lines and lines[0] else type(error).__name__


def _metres(path: Path, code: Any, problems: list[Problem]) -> float | None:
    """Return the length (m) of the drawing's unit; one without a unit counts in metres."""
    if isinstance(code, int) and code in UNITS:
        return UNITS[code]
    text = f"has the unit number {shown(code)} ($INSUNITS), which DXF does not have"
    remedy = "set the unit of the drawing, and save it again: 6 is m, 2 ft, 21 US survey feet"
    problems.append(Problem(str(path), text, remedy))
    return None


def _pieces(
    path: Path, drawing: Any, layers: Collection[str] | None, known: Collection[str], scale: float
) -> Iterator[list[Node]]:
    """Yield the nodes (m) of each line, polyline and curve."""
    lines = []
    for entity in drawing.modelspace().query("LINE LWPOLYLINE POLYLINE ARC SPLINE"):
        layer = entity.dxf.layer
        if layers is None or layer in layers:
            place = f"{path}, entity {entity.dxf.handle} ({entity.dxftype()} on layer {layer})"
            lines.append((place, layer, _points(place, entity, scale)))
    height = _height(path, [point for _, _, points in lines for point in points])
    for place, layer, points in lines:
        material = layer if layer in known else None
        nodes = [Node(p[0], p[height], material, place) for p in points]
        if len(nodes) > 1:
            yield nodes


def _points(place: str, entity: Any, scale: float) -> list[tuple[float, float, float]]:
    """Return the points (m) of an entity; of a curve, those of straight cells along it."""
    from ezdxf.path import make_path

    path = make_path(entity)
    for point in path.control_vertices():
        # of curves that are larger, no end would come of the division into straight cells
        if not all(abs(scale * value) <= FARTHEST for value in point.xyz):
            text = f"has a coordinate beyond {FARTHEST:g} m, or one that is no number"
            remedy = "check the unit of the drawing, and draw it nearer to the origin"
            raise InputRefused([Problem(place, text, remedy)])
    points = [
        (scale * point.x, scale * point.y, scale * point.z)
        for point in islice(path.flattening(FLAT / scale), MOST_POINTS + 1)
    ]
    if len(points) > MOST_POINTS:
        text = f"is a curve of more than {MOST_POINTS} straight cells of {FLAT:g} m precision"
        raise InputRefused([Problem(place, text, "check the unit of the drawing")])
    return points


def _height(path: Path, points: Sequence[tuple[float, float, float]]) -> int:
    """Return the coordinate that is the height: z of a section that is drawn upright in space.

    Raises
    ------
    InputRefused
        y and z both change: the lines are no section.
    """
    y = [point[1] for point in points]
    z = [point[2] for point in points]
    if not points or max(z) - min(z) <= TOUCH:
        return 1
    if max(y) - min(y) <= TOUCH:
        return 2
    text = "has lines that run through space: both y and z change along them"
    remedy = "draw the section in the plane x, y, or upright in x, z with one y"
    raise InputRefused([Problem(str(path), text, remedy)])


def _joined(pieces: Sequence[list[Node]], problems: list[Problem]) -> list[Node]:
    """Join pieces to one line from left to right; a piece's material holds for all its cells."""
    from_left = (piece if piece[0].x <= piece[-1].x else piece[::-1] for piece in pieces)
    ordered = sorted(from_left, key=lambda piece: piece[0].x)
    joined = list(ordered[0])
    for piece in ordered[1:]:
        begin = piece[0]
        end = joined[-1]
        gap = math.hypot(begin.x - end.x, begin.y - end.y)
        if gap > TOUCH:
            text = (
                f"begins at ({begin.x:.6g}, {begin.y:.6g}) m, {gap:.3g} m from where the "
                f"piece on its left ends, at ({end.x:.6g}, {end.y:.6g}) m"
            )
            remedy = "a profile is one line: join the pieces, or name its layers in profile.layers"
            problems.append(Problem(begin.where, text, remedy))
        joined = [*joined[:-1], *piece]
    return joined
