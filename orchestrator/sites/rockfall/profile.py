"""The profile of a slope: its nodes, and the material of each cell between two of them."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ...core.errors import Problem
from ...core.system.names import nearest
from ...input_files.places import Places
from .site import GroundRange


@dataclass(frozen=True)
class Node:
    """A point of the profile.

    Attributes
    ----------
    x, y : float
        Position (m), to the right and upwards.
    material : str or None
        Of the cell that begins here, where it is named here.
    where : str
        Place in the file from which the node was read.
    """

    x: float
    y: float
    material: str | None
    where: str


def unfolded(nodes: list[Node], problems: list[Problem]) -> list[Node]:
    """Return the nodes of a profile that runs from left to right, and none of another one.

    What else would be wrong with a profile that folds back follows from that, and is not told.

    Parameters
    ----------
    nodes : list of Node
        As they were read.
    problems : list of Problem
        The nodes at which the profile folds back are appended.

    Returns
    -------
    list of Node
        Empty where it folds back.
    """
    folded = [
        Problem(
            after.where,
            f"the profile folds back from x = {node.x:.6g} m to {after.x:.6g} m: its right node "
            "must lie to the right of its left node",
            "order the nodes by x, remove repeated ones, and give an overhang as a steep cell",
        )
        for node, after in pairwise(nodes)
        if after.x <= node.x
    ]
    problems += folded
    return [] if folded else nodes


# --- materials of the cells ---


def with_ground(
    nodes: list[Node],
    ground: Sequence[GroundRange],
    where: Places,
    known: Collection[str],
    problems: list[Problem],
) -> list[Node]:
    """Give every cell its material; a cell in which a range of ground begins or ends is divided.

    Parameters
    ----------
    nodes : list of Node
        From left to right.
    ground : sequence of GroundRange
        Later ones come before earlier ones.
    where : Places
        Of the values of the site.
    known : collection of str
        Names of the materials.
    problems : list of Problem
        Ranges that are wrong and cells without a material are appended.

    Returns
    -------
    list of Node
        The nodes, and those where cells are divided.
    """
    problems += _ground_problems(ground, where, known)
    borders = sorted({x for entry in ground for x in (entry.left, entry.right) if x is not None})
    divided = list(_divided(nodes, borders))
    named = [_with_material(node, after, ground) for node, after in pairwise(divided)]
    for i, node in enumerate(named, 1):
        if node.material is None:
            text = f"cell {i}, which begins at x = {node.x:.6g} m, has no material"
            problems.append(Problem(node.where, text, "name it at this point or in a [[ground]]"))
    return named + divided[-1:]


def _ground_problems(
    ground: Sequence[GroundRange], where: Places, known: Collection[str]
) -> Iterator[Problem]:
    for i, entry in enumerate(ground):
        if entry.material not in known:
            place = where.of(("ground", i, "material"))
            text = f"there is no material {entry.material!r}"
            yield Problem(place, text, nearest(entry.material, known))
        if entry.left is not None and entry.right is not None and entry.left >= entry.right:
            text = f"from = {entry.left:g} m is not left of to = {entry.right:g} m"
            yield Problem(where.of(("ground", i)), text, "exchange them")


def _divided(nodes: list[Node], borders: Sequence[float]) -> Iterator[Node]:
    for node, after in pairwise(nodes):
        yield node
        for x in borders:
            if node.x < x < after.x:
                y = node.y + (after.y - node.y) * (x - node.x) / (after.x - node.x)
                yield replace(node, x=x, y=y)
    yield from nodes[-1:]


def _with_material(node: Node, after: Node, ground: Sequence[GroundRange]) -> Node:
    """Return a node with the material of its cell.

    It is the last ground that covers the middle of the cell; a name at the node comes first.
    """
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


def surface(nodes: Sequence[Node], x: float) -> float:
    """Return the height of the profile.

    Parameters
    ----------
    nodes : sequence of Node
        Two at least, from left to right.
    x : float
        Place (m); the first and the last cell go on without end.

    Returns
    -------
    float
        Height y (m).
    """
    i = min(max(sum(node.x <= x for node in nodes) - 1, 0), len(nodes) - 2)
    left = nodes[i]
    right = nodes[i + 1]
    return left.y + (right.y - left.y) * (x - left.x) / (right.x - left.x)
