"""The profile of a slope: its nodes, and the material of each cell between two of them."""

import math
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


STEEPEST = math.radians(89.9)
"""Steepest cell (rad) of the component; vertical ones become as steep as that."""
_LEAN = math.cos(STEEPEST) / math.sin(STEEPEST) * (1.0 + 1e-6)
"""Length / height of such a cell, not less than the component accepts."""
_ON = 1e-9
"""Least length (m) of a cell between two nodes of one height."""


def unfolded(nodes: list[Node], problems: list[Problem], notes: list[str]) -> list[Node]:
    """Return a profile that runs from left to right, as rocks from above see it.

    An overhang is seen as a vertical face at its lip, and a vertical face becomes a cell of 89.9
    degrees. Of a profile that folds back otherwise nothing is returned: what else would be wrong
    with it follows from that, and is not told.

    Parameters
    ----------
    nodes : list of Node
        As they were read.
    problems : list of Problem
        The nodes at which the profile folds back are appended.
    notes : list of str
        Overhangs are appended.

    Returns
    -------
    list of Node
        Empty where it folds back.
    """
    folded = [_folding(node, after) for node, after in pairwise(nodes) if _folds(node, after)]
    problems += folded
    if folded:
        return []
    seen = _from_above(nodes, problems, notes)
    return _leaning(seen)


def _folds(node: Node, after: Node) -> bool:
    """Tell whether a cell goes back by more than an overhang of 45 degrees does."""
    back = node.x - after.x
    return back > abs(after.y - node.y) or (back == 0.0 and after.y == node.y)


def _folding(node: Node, after: Node) -> Problem:
    return Problem(
        after.where,
        f"the profile folds back from x = {node.x:.6g} m to {after.x:.6g} m: its right node "
        "must lie to the right of its left node",
        "order the nodes by x and remove repeated ones; a face may be vertical, and overhang by up "
        "to 45 degrees",
    )


def _from_above(nodes: list[Node], problems: list[Problem], notes: list[str]) -> list[Node]:
    """Return a profile without what lies below overhangs."""
    seen = nodes[:1]
    lip: Node | None = None
    for before, after in pairwise(nodes):
        if lip is not None and after.x <= lip.x:
            continue
        if lip is not None:
            seen += [_between(before, after, lip.x), after]
            lip = None
        elif after.x >= before.x:
            seen.append(after)
        elif after.y < before.y:
            lip = before
        else:
            while len(seen) > 1 and seen[-2].x >= after.x:
                seen.pop()
            foot = _between(seen[-2], seen[-1], after.x) if len(seen) > 1 else before
            seen = [*seen[:-1], replace(foot, material=before.material), after]
        if after.x < before.x:
            notes.append(_overhang(before, after))
    if lip is not None:
        text = f"the profile ends below the overhang that begins at x = {lip.x:.6g} m"
        problems.append(Problem(nodes[-1].where, text, "let it end beyond the overhang"))
        return []
    return seen


def _overhang(before: Node, after: Node) -> str:
    lip = before if after.y < before.y else after
    return (
        f"the overhang of {before.x - after.x:.3g} m at x = {lip.x:.6g} m is a vertical face at "
        "its lip here: no rock comes below it"
    )


def _between(node: Node, after: Node, x: float) -> Node:
    """Return the point of a cell at x (m), with the cell's material."""
    part = (x - node.x) / (after.x - node.x)
    return replace(node, x=x, y=node.y + part * (after.y - node.y))


def _leaning(nodes: Sequence[Node]) -> list[Node]:
    """Return a profile in which no cell is steeper than :data:`STEEPEST`."""
    leaning = list(nodes[:1])
    for after in nodes[1:]:
        node = leaning[-1]
        least = node.x + abs(after.y - node.y) * _LEAN
        if after.x < least or after.x <= node.x:
            leaning.append(replace(after, x=max(least, node.x + _ON)))
        else:
            leaning.append(after)
    return leaning


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
