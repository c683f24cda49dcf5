"""The nodes of a profile: from the site itself, from a CSV file or from a DXF drawing."""

from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

from ...core.errors import Problem
from ...core.input_text import shown
from ...core.system.names import nearest
from ...input_files.form import LARGEST
from ...input_files.places import Places
from .profile import Node
from .profile_files import nodes_of_csv, nodes_of_dxf
from .site import Profile


def read_nodes(
    profile: Profile, folder: Path, where: Places, known: Collection[str], problems: list[Problem]
) -> list[Node]:
    """Read the nodes as the site or the file of the profile has them.

    Parameters
    ----------
    profile : Profile
        Of the site.
    folder : Path
        From which relative paths count.
    where : Places
        Of the values of the site.
    known : collection of str
        Names of the materials.
    problems : list of Problem
        Faults are appended.

    Returns
    -------
    list of Node
        From left to right; what could be read, where there are faults.
    """
    if (profile.points is None) == (profile.file is None):
        text = "a profile has points, or a file with them"
        problems.append(Problem(where.of(("profile",)), text, "give one of the two"))
        return []
    before = len(problems)
    if profile.points is not None:
        place = where.of(("profile", "points"))
        nodes = list(_from_points(profile.points, where, problems))
    else:
        place = str(folder / str(profile.file))
        nodes = _from_file(profile, folder, where, known, problems)
    if len(nodes) < 2 and len(problems) == before:
        text = f"has {len(nodes)} node{'' if len(nodes) == 1 else 's'}"
        problems.append(Problem(place, text, "a profile has two or more"))
    for node in nodes:
        if node.material is not None and node.material not in known:
            text = f"there is no material {node.material!r}"
            problems.append(Problem(node.where, text, nearest(node.material, known)))
    return nodes


def _from_points(points: Sequence[Any], where: Places, problems: list[Problem]) -> Iterator[Node]:
    for i, point in enumerate(points):
        place = where.of(("profile", "points", i))
        if _is_point(point):
            material = point[2] if len(point) == 3 else None
            yield Node(float(point[0]), float(point[1]), material, place)
        else:
            remedy = 'write [x, y] or [x, y, "material"], finite numbers in m'
            problems.append(Problem(place, f"{shown(point)} is no point", remedy))


def _is_point(point: Any) -> bool:
    return (
        isinstance(point, list | tuple)
        and len(point) in (2, 3)
        and all(map(_is_number, point[:2]))
        and all(isinstance(name, str) for name in point[2:])
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST


def _from_file(
    profile: Profile, folder: Path, where: Places, known: Collection[str], problems: list[Problem]
) -> list[Node]:
    path = folder / str(profile.file)
    place = where.of(("profile", "file"))
    suffix = path.suffix.lower()
    if suffix not in (".csv", ".dxf"):
        text = f"{profile.file!r} is neither a CSV nor a DXF file"
        problems.append(Problem(place, text, "name a file that ends in .csv or .dxf"))
        return []
    if not path.is_file():
        problems.append(Problem(place, f"there is no file {path}", "correct the path"))
        return []
    if suffix == ".csv":
        return list(nodes_of_csv(path, problems))
    return nodes_of_dxf(path, profile.layers, known, problems)
