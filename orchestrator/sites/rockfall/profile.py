"""The nodes of a profile: from the site's file, a CSV file or a DXF drawing."""

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from ...core.errors import Problem
from ...core.system.names import nearest
from ...core.system.values import finite_number
from ...input_files.places import Places
from .site import Ground, Profile

FLAT = 0.01
"""Distance (m) between a curve of a drawing and the straight cells that replace it."""
TOUCH = 1e-6
"""Distance (m) at which ends of lines in a drawing are one point."""


@dataclass(frozen=True)
class Node:
    """A point of the profile (m), the material of the cell that begins there if it is named there, and where it was read."""

    x: float
    y: float
    material: str | None
    where: str


def read_nodes(
    profile: Profile, folder: Path, where: Places, known: Collection[str], problems: list[Problem]
) -> list[Node]:
    """The nodes as they were given. Relative paths count from ``folder``; known: names of materials."""
    if (profile.points is None) == (profile.file is None):
        problems.append(
            Problem(
                where.of(("profile",)),
                "a profile has points, or a file with them",
                "give one of the two",
            )
        )
        return []
    before = len(problems)
    if profile.points is not None:
        nodes = list(_from_points(profile.points, where, problems))
        place = where.of(("profile", "points"))
    else:
        path = folder / str(profile.file)
        place = str(path)
        reader = {".csv": _from_csv, ".dxf": _from_dxf}.get(path.suffix.lower())
        if reader is None:
            problems.append(
                Problem(
                    where.of(("profile", "file")),
                    f"{profile.file!r} is neither a CSV nor a DXF file",
                    "name a file that ends in .csv or .dxf",
                )
            )
            return []
        if not path.is_file():
            problems.append(
                Problem(
                    where.of(("profile", "file")), f"there is no file {path}", "correct the path"
                )
            )
            return []
        nodes = list(reader(path, profile, known, problems))
    if len(nodes) < 2 and len(problems) == before:
        problems.append(
            Problem(
                place,
                f"has {len(nodes)} node{'' if len(nodes) == 1 else 's'}",
                "a profile has two or more",
            )
        )
    problems += [
        Problem(
            node.where, f"there is no material {node.material!r}", nearest(node.material, known)
        )
        for node in nodes
        if node.material is not None and node.material not in known
    ]
    return nodes


def _from_points(points: list[Any], where: Places, problems: list[Problem]) -> Iterable[Node]:
    for i, point in enumerate(points):
        place = where.of(("profile", "points", i))
        good = isinstance(point, list) and len(point) in (2, 3) and all(map(_is_number, point[:2]))
        if not good or not isinstance(point[2] if len(point) == 3 else "", str):
            problems.append(
                Problem(
                    place,
                    f"{point!r} is no point",
                    'write [x, y] or [x, y, "material"], finite numbers in m',
                )
            )
        else:
            yield Node(
                float(point[0]), float(point[1]), point[2] if len(point) == 3 else None, place
            )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


# --- CSV ---


def _from_csv(
    path: Path, profile: Profile, known: Collection[str], problems: list[Problem]
) -> Iterable[Node]:
    """One node a line: x, y and, if wanted, the material of the cell that begins there. The first line names the columns."""
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
        problems.append(
            Problem(
                f"{path}, line {rows[0][0] if rows else 1}, column 1",
                "the first line does not name the columns",
                "write x,y or x,y,material, with commas between the columns and decimal points",
            )
        )
        return
    for number, line in rows[1:]:
        yield from _csv_node(path, number, line, len(header), problems)


def _csv_node(
    path: Path, number: int, line: str, columns: int, problems: list[Problem]
) -> Iterable[Node]:
    fields = line.split(",")
    starts = [1 + sum(len(text) + 1 for text in fields[:i]) for i in range(len(fields))]
    if not 2 <= len(fields) <= columns:
        problems.append(
            Problem(
                f"{path}, line {number}, column 1",
                f"has {len(fields)} fields",
                f"give {columns}, with commas between",
            )
        )
        return
    values = []
    for text, start in zip(fields[:2], starts):
        value = finite_number(text)
        if value is None:
            column = start + len(text) - len(text.lstrip())
            problems.append(
                Problem(
                    f"{path}, line {number}, column {column}",
                    f"{text.strip()!r} is no finite number",
                    "give a coordinate in m, with a point for decimals",
                )
            )
        else:
            values.append(value)
    if len(values) == 2:
        yield Node(
            values[0],
            values[1],
            (fields[2].strip() or None) if len(fields) == 3 else None,
            f"{path}, line {number}, column 1",
        )


# --- DXF ---


def _from_dxf(
    path: Path, profile: Profile, known: Collection[str], problems: list[Problem]
) -> Iterable[Node]:
    """Lines, polylines and curves of the model space, joined end to end. A layer with the name of a material gives it."""
    try:
        import ezdxf
        from ezdxf.path import make_path
    except ImportError:
        problems.append(
            Problem(
                str(path),
                "reading a DXF drawing needs the package ezdxf",
                'install it: pip install "rockshed[dxf]"',
            )
        )
        return []
    try:
        drawing = ezdxf.readfile(path)
    except (OSError, ezdxf.DXFError) as error:
        problems.append(
            Problem(
                str(path), f"is no DXF drawing that can be read: {error}", "save it again as DXF"
            )
        )
        return []
    scale = _metres(drawing)
    pieces = []
    for entity in drawing.modelspace().query("LINE LWPOLYLINE POLYLINE ARC SPLINE"):
        layer = entity.dxf.layer
        if profile.layers is not None and layer not in profile.layers:
            continue
        material = layer if layer in known else None
        place = f"{path}, entity {entity.dxf.handle} ({entity.dxftype()} on layer {layer})"
        pieces.append(
            [
                Node(scale * p.x, scale * p.y, material, place)
                for p in make_path(entity).flattening(FLAT / scale)
            ]
        )
    return _joined(pieces, path, drawing, problems)


def _metres(drawing: Any) -> float:
    """Length (m) of the drawing's unit; one without a unit counts in metres."""
    from ezdxf import units

    return (
        units.conversion_factor(units.InsertUnits(drawing.units), units.InsertUnits.Meters)
        if drawing.units
        else 1.0
    )


def _joined(
    pieces: list[list[Node]], path: Path, drawing: Any, problems: list[Problem]
) -> list[Node]:
    """One line from left to right. The material of a piece holds for all its cells."""
    ordered = sorted(
        (
            piece if piece[0].x <= piece[-1].x else _turned(piece)
            for piece in pieces
            if len(piece) > 1
        ),
        key=lambda piece: piece[0].x,
    )
    if not ordered:
        names = sorted({entity.dxf.layer for entity in drawing.modelspace()})
        problems.append(
            Problem(
                str(path),
                "has no line, polyline or curve on the layers that are read",
                f"set profile.layers; there are {', '.join(names)}"
                if names
                else "draw the profile",
            )
        )
        return []
    joined = list(ordered[0])
    for piece in ordered[1:]:
        gap = math.hypot(piece[0].x - joined[-1].x, piece[0].y - joined[-1].y)
        if gap > TOUCH:
            problems.append(
                Problem(
                    piece[0].where,
                    f"begins at ({piece[0].x:.6g}, {piece[0].y:.6g}) m, {gap:.3g} m from where the "
                    f"piece on its left ends, at ({joined[-1].x:.6g}, {joined[-1].y:.6g}) m",
                    "a profile is one line: join the pieces, or name its layers in profile.layers",
                )
            )
        joined = [*joined[:-1], *piece]
    return joined


def _turned(piece: list[Node]) -> list[Node]:
    return piece[::-1]


# --- materials of the cells ---


def with_ground(
    nodes: list[Node],
    ground: list[Ground],
    where: Places,
    known: Collection[str],
    problems: list[Problem],
) -> list[Node]:
    """The nodes with a material for every cell; where a ground begins or ends inside a cell, the cell is divided."""
    for i, entry in enumerate(ground):
        if entry.material not in known:
            problems.append(
                Problem(
                    where.of(("ground", i, "material")),
                    f"there is no material {entry.material!r}",
                    nearest(entry.material, known),
                )
            )
        if entry.left is not None and entry.right is not None and entry.left >= entry.right:
            problems.append(
                Problem(
                    where.of(("ground", i)),
                    f"from = {entry.left:g} m is not left of to = {entry.right:g} m",
                    "exchange them",
                )
            )
    borders = sorted({x for entry in ground for x in (entry.left, entry.right) if x is not None})
    divided = list(_divided(nodes, borders))
    named = [_with_material(node, after, ground) for node, after in pairwise(divided)]
    bare = [(i, node) for i, node in enumerate(named, 1) if node.material is None]
    problems += [
        Problem(
            node.where,
            f"cell {i}, which begins at x = {node.x:.6g} m, has no material",
            "name it at this point or in a [[ground]]",
        )
        for i, node in bare
    ]
    return named + divided[-1:]


def _divided(nodes: list[Node], borders: list[float]) -> Iterable[Node]:
    for node, after in pairwise(nodes):
        yield node
        for x in borders:
            if node.x < x < after.x:
                yield replace(
                    node, x=x, y=node.y + (after.y - node.y) * (x - node.x) / (after.x - node.x)
                )
    yield from nodes[-1:]


def _with_material(node: Node, after: Node, ground: list[Ground]) -> Node:
    """The last ground that covers the middle of the cell; what the node itself names comes first."""
    if node.material is not None:
        return node
    middle = 0.5 * (node.x + after.x)
    covering = [
        entry.material
        for entry in ground
        if (entry.left is None or entry.left <= middle)
        and (entry.right is None or middle <= entry.right)
    ]
    return replace(node, material=covering[-1] if covering else None)


def surface(nodes: list[Node], x: float) -> float:
    """Height y (m) of the profile at x; its first and last cell go on without end."""
    i = min(max(sum(node.x <= x for node in nodes) - 1, 0), len(nodes) - 2)
    left, right = nodes[i], nodes[i + 1]
    return left.y + (right.y - left.y) * (x - left.x) / (right.x - left.x)
