"""What a serialized state of the sand cushion looks like: bodies, box and contacts, for pictures and inspection.

Nothing is simulated here: positions are those of the state, and forces follow from them and from the springs it holds.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ..common.component import HEADER, MAGIC, ComponentError, Instance
from ..common.kernels import kernel, view
from . import COMPONENT
from .contact_search import base_top, beam_count, disc_count, first_of, second_of
from .declarations import (
    ANGLE,
    BEAM_DISCS,
    FLOOR,
    KIND,
    LAW,
    LAYOUT,
    ON_BEAM,
    RADIUS,
    ROW,
    UNBOUNDED,
)
from .forces import kind_of, touch

V, A = LAYOUT.scalar, LAYOUT.array

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_COLUMNS = 9
"""Numbers per contact that :func:`list_contacts` writes: bodies, both points, overlap, normal and tangential force."""


@dataclass(frozen=True, slots=True)
class Discs:
    """Discs of one kind: centres (m), radii (m), angles (rad, counter-clockwise) and velocities (m/s), an array each."""

    x: Floats
    y: Floats
    radius: Floats
    angle: Floats
    velocity_x: Floats
    velocity_y: Floats


@dataclass(frozen=True, slots=True)
class Box:
    """The box (m): inner face of the left wall, distance of the walls, height of the base's highest point; upper end (infinite if
    there is none) and thickness of the walls, for the rock."""

    left: float
    width: float
    base: float
    wall_top: float
    wall_thickness: float


@dataclass(frozen=True, slots=True)
class Contacts:
    """Contacts that touch, an array each.

    first, second: numbers of the bodies: sand discs from 0, then the rock, the beam discs, left wall, right wall, base.
    x1, y1: centre of the first body (m). x2, y2: centre of the second, or the foot on a plane (m).
    overlap: in m, positive.
    normal_force: k_n * overlap (N), the elastic part: the dashpot's depends on the step. Compression is positive.
    tangential_force: force of the tangential spring (N) at the last internal step; positive when it turns the first body
        counter-clockwise.
    """

    first: Integers
    second: Integers
    x1: Floats
    y1: Floats
    x2: Floats
    y2: Floats
    overlap: Floats
    normal_force: Floats
    tangential_force: Floats


@dataclass(frozen=True, slots=True)
class SandState:
    """A sand cushion at one instant. ``rock`` holds one disc."""

    discs: Discs
    rock: Discs
    beam: Discs
    box: Box
    contacts: Contacts


def read(content: bytes, sizes: Mapping[str, int]) -> SandState:
    """Decode what :meth:`rockshed.components.common.component.Instance.to_bytes` wrote for a cushion of these ``sizes``.

    Raises:
        ComponentError: not such a state, of another component or other sizes, or cut short.
    """
    instance = COMPONENT.instance(**sizes)
    instance.from_bytes(content)
    return snapshot(instance)


def snapshot(instance: Instance) -> SandState:
    """The present state of a cushion. The arrays are copies."""
    discs = instance.sizes["discs"]
    body = instance.state("body").reshape(-1, ROW)
    body = body[: discs + 1 + instance.sizes["elements"]]
    angle = np.concatenate((instance.state("angle"), body[discs:, ANGLE]))
    return SandState(
        _discs(body, angle, slice(0, discs)),
        _discs(body, angle, slice(discs, discs + 1)),
        _discs(body, angle, slice(discs + 1, None)),
        _box(instance),
        _contacts(instance),
    )


def _discs(body: Floats, angle: Floats, which: slice) -> Discs:
    x, y, vx, vy, _, radius = (np.copy(column[which]) for column in body.T[:6])
    return Discs(x, y, radius, np.copy(angle[which]), vx, vy)


def _box(instance: Instance) -> Box:
    base, height = float(_base(instance.w, instance.x, instance.k)), instance["box.wall_height"]
    foot = base if instance["walls"] == ON_BEAM else instance["base.y"]
    return Box(
        instance["box.left"],
        instance["box.width"],
        base,
        math.inf if height == UNBOUNDED else foot + height,
        instance["box.wall_thickness"],
    )


def _contacts(instance: Instance) -> Contacts:
    table = np.empty((instance.state("pair").size + instance.state("edge_partner").size, _COLUMNS))
    table = table[: list_contacts(instance.w, instance.x, instance.k, table)]
    bodies = table[:, :2].astype(np.int64)
    return Contacts(bodies[:, 0], bodies[:, 1], *(np.copy(column) for column in table.T[2:]))


@kernel
def _base(w, x, k):
    """Highest point (m) of whatever carries the sand."""
    n, m = disc_count(k), beam_count(k)
    body = view(x, k, A.body)
    if w[V.base] != BEAM_DISCS:
        return base_top(w, body, n, m)
    top = body[ROW * (n + 1) + 1]
    for b in range(n + 1, n + m + 1):
        top = max(top, body[ROW * b + 1])
    return top + w[V.beam_radius]


@kernel
def list_contacts(w, x, k, table):
    """Write a row of ``table`` for each contact that touches; returns their number. The lists of candidates have room for all."""
    found, pair, spring = 0, view(k, k, A.pair), view(x, k, A.spring)
    for p in range(view(k, k, A.across)[disc_count(k)]):
        if second_of(pair[p]) < disc_count(k):  # else it fills up a block
            found = _list(found, first_of(pair[p]), second_of(pair[p]), spring[p], w, x, k, table)
    owner, partner, spring = (
        view(k, k, A.edge_body),
        view(k, k, A.edge_partner),
        view(x, k, A.edge_spring),
    )
    for p in range(view(k, k, A.edge_row)[disc_count(k) + 1]):
        found = _list(found, owner[p], partner[p], spring[p], w, x, k, table)
    return found


@kernel
def _list(found, i, j, tangential, w, x, k, table):
    """Write a pair behind the rows found before, if it touches. Returns the number of rows."""
    n, m = disc_count(k), beam_count(k)
    body, law = view(x, k, A.body), view(x, k, A.law)
    nx, ny, gap, _, _ = touch(i, j, w, body, n, m)
    if gap >= 0.0:
        return found
    reach = body[ROW * i + RADIUS] + gap
    if j <= n + m:
        reach += body[ROW * j + RADIUS]
    stiffness = law[(KIND.sand if j < n else kind_of(i, j, n, m)) * len(LAW) + LAW.normal]
    table[found, 0], table[found, 1] = i, j
    table[found, 2], table[found, 3] = body[ROW * i], body[ROW * i + 1]
    table[found, 4], table[found, 5] = body[ROW * i] + nx * reach, body[ROW * i + 1] + ny * reach
    table[found, 6], table[found, 7], table[found, 8] = -gap, -stiffness * gap, tangential
    return found + 1


def sizes_of(content: bytes) -> dict[str, int]:
    """The sizes of the cushion that a state is of, for :func:`read`: the state's table of arrays tells them.

    Raises:
        ComponentError: not the state of a component, or cut short.
    """
    if len(content) < HEADER.size or len(content) != HEADER.size + 8 * sum(
        HEADER.unpack_from(content)[2:]
    ):
        raise ComponentError(COMPONENT.name, ["this is no serialized state of a component"])
    _, _, n_w, n_x, n_k = HEADER.unpack_from(content)
    table = np.frombuffer(content, np.int64, n_k, HEADER.size + 8 * (n_w + n_x))
    return {"discs": int(table[A.angle + 1]), "elements": int(table[A.beam_position_x + 1])}


def decoded(content: bytes) -> SandState:
    """Return the geometry in a state as an FMU of the cushion serializes it.

    Parameters
    ----------
    content : bytes
        State of the FMU, which ends with that of the component; the component's alone will do.

    Returns
    -------
    SandState
        Without beam discs where the sand lies on a floor: their places then mean nothing.

    Raises
    ------
    ComponentError
        Not such a state, of another version, or cut short.
    """
    state = content[max(content.find(MAGIC), 0) :]
    instance = COMPONENT.instance(**sizes_of(state))
    instance.from_bytes(state)
    shown = snapshot(instance)
    if instance["base"] != FLOOR:
        return shown
    none = Discs(*(np.zeros(0) for _ in fields(Discs)))
    return replace(shown, beam=none)
