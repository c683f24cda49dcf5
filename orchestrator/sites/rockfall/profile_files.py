"""Nodes of a profile from a CSV file or from a DXF drawing."""

import math
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

from ...core.errors import Problem
from ...core.system.values import finite_number
from .profile import Node

FLAT = 0.01
"""Distance (m) between a curve of a drawing and the straight cells that replace it."""
TOUCH = 1e-6
"""Distance (m) at which ends of lines in a drawing are one point."""

# --- CSV ---


def nodes_of_csv(path: Path, problems: list[Problem]) -> Iterator[Node]:
    """Read a CSV file with one node a line.

    Parameters
    ----------
    path : Path
        Of the file. Its first line names the columns: ``x,y`` or ``x,y,material`` (m); lines that
        begin with # are comments.
    problems : list of Problem
        Faults are appended, with line and column.

    Yields
    ------
    Node
        In the order of the file.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        problems.append(Problem(str(path), f"cannot be read: {error}", "save it as UTF-8 text"))
        return
    rows = [
        (i, line)
        for i, line in enumerate(lines, 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    header = [name.strip().lower() for name in rows[0][1].split(",")] if rows else []
    if header[:2] != ["x", "y"] or header[2:] not in ([], ["material"]):
        remedy = "write x,y or x,y,material, with commas between the columns and decimal points"
        place = f"{path}, line {rows[0][0] if rows else 1}, column 1"
        problems.append(Problem(place, "the first line does not name the columns", remedy))
        return
    for number, line in rows[1:]:
        yield from _csv_node(f"{path}, line {number}", line.split(","), len(header), problems)


def _csv_node(
    place: str, fields: Sequence[str], columns: int, problems: list[Problem]
) -> Iterator[Node]:
    if not 2 <= len(fields) <= columns:
        text = f"has {len(fields)} fields"
        remedy = f"give {columns}, with commas between"
        problems.append(Problem(f"{place}, column 1", text, remedy))
        return
    values = []
    for i, text in enumerate(fields[:2]):
        value = finite_number(text)
        if value is None:
            blanks = len(text) - len(text.lstrip())
            column = 1 + sum(len(before) + 1 for before in fields[:i]) + blanks
            fault = f"{text.strip()!r} is no finite number"
            remedy = "give a coordinate in m, with a point for decimals"
            problems.append(Problem(f"{place}, column {column}", fault, remedy))
        else:
            values.append(value)
    if len(values) == 2:
        material = fields[2].strip() if len(fields) == 3 else ""
        yield Node(values[0], values[1], material or None, f"{place}, column 1")


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
    except (OSError, ezdxf.DXFError) as error:
        text = f"is no DXF drawing that can be read: {error}"
        problems.append(Problem(str(path), text, "save it again as DXF"))
        return []
    pieces = [piece for piece in _pieces(path, drawing, layers, known) if len(piece) > 1]
    if not pieces:
        names = sorted({entity.dxf.layer for entity in drawing.modelspace()})
        text = "has no line, polyline or curve on the layers that are read"
        remedy = f"set profile.layers; there are {', '.join(names)}" if names else ""
        problems.append(Problem(str(path), text, remedy or "draw the profile"))
        return []
    return _joined(pieces, problems)


def _pieces(
    path: Path, drawing: Any, layers: Collection[str] | None, known: Collection[str]
) -> Iterator[list[Node]]:
    """Yield the nodes (m) of each line, polyline and curve."""
    from ezdxf.path import make_path

    scale = _metres(drawing)
    for entity in drawing.modelspace().query("LINE LWPOLYLINE POLYLINE ARC SPLINE"):
        layer = entity.dxf.layer
        if layers is not None and layer not in layers:
            continue
        material = layer if layer in known else None
        place = f"{path}, entity {entity.dxf.handle} ({entity.dxftype()} on layer {layer})"
        points = make_path(entity).flattening(FLAT / scale)
        yield [Node(scale * p.x, scale * p.y, material, place) for p in points]


def _metres(drawing: Any) -> float:
    """Return the length (m) of the drawing's unit; one without a unit counts in metres."""
    from ezdxf import units

    if not drawing.units:
        return 1.0
    return units.conversion_factor(units.InsertUnits(drawing.units), units.InsertUnits.Meters)


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
