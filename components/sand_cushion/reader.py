"""Geometry of a serialized state of the sand cushion: bodies, box and contacts.

Nothing is simulated here: positions are those of the state, and forces follow from them and from
the springs that it holds.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ..common.component import HEADER, MAGIC, ComponentError, Instance
from ..common.kernels import kernel, view
from . import COMPONENT
from .bodies import bodies_of
from .boundaries import boundary_of, contact_kind, touch, touch_disc
from .contact_search import base_top, first_of, second_of
from .declarations import ANGLE, FLOOR, KIND, LAYOUT, ON_BEAM, ROW, UNBOUNDED
from .laws import law_of

A = LAYOUT.array

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_COLUMNS = 9
"""Numbers per contact that :func:`list_contacts` writes: bodies, both points (m), overlap (m),
normal and tangential force (N)."""


@dataclass(frozen=True, slots=True)
class Discs:
    """Discs of one kind, an array each.

    Attributes
    ----------
    x, y : ndarray of shape (n,)
        Centres (m).
    radius, angle : ndarray of shape (n,)
        Radii (m) and angles (rad, counter-clockwise).
    velocity_x, velocity_y : ndarray of shape (n,)
        Velocities (m/s).
    """

    x: Floats
    y: Floats
    radius: Floats
    angle: Floats
    velocity_x: Floats
    velocity_y: Floats


@dataclass(frozen=True, slots=True)
class Box:
    """The box of the sand (m).

    Attributes
    ----------
    left, width : float
        Inner face of the left wall, and distance of the walls.
    base : float
        Height of the base's highest point.
    wall_top, wall_thickness : float
        Upper end (infinite if there is none) and thickness of the walls, for the rock.
    """

    left: float
    width: float
    base: float
    wall_top: float
    wall_thickness: float


@dataclass(frozen=True, slots=True)
class Contacts:
    """Contacts that touch, an array each.

    Attributes
    ----------
    first, second : ndarray of shape (n,)
        Numbers of the bodies: sand discs from 0, rock, beam discs, left wall, right wall, base.
    x1, y1 : ndarray of shape (n,)
        Centre of the first body (m).
    x2, y2 : ndarray of shape (n,)
        Centre of the second body, or the foot on a plane (m).
    overlap : ndarray of shape (n,)
        Overlap (m), positive.
    normal_force : ndarray of shape (n,)
        k_n times the overlap (N), the elastic part: the dashpot's depends on the step. Compression
        is positive.
    tangential_force : ndarray of shape (n,)
        Force of the tangential spring (N) at the last internal step; positive when it turns the
        first body counter-clockwise.
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
    """A sand cushion at one instant; ``rock`` holds one disc."""

    discs: Discs
    rock: Discs
    beam: Discs
    box: Box
    contacts: Contacts


def read(content: bytes, sizes: Mapping[str, int]) -> SandState:
    """Decode a serialized state of a cushion, see :meth:`..common.component.Instance.to_bytes`.

    Parameters
    ----------
    content : bytes
        The state.
    sizes : mapping of str to int
        Sizes of the cushion.

    Returns
    -------
    SandState
        Its geometry.

    Raises
    ------
    ComponentError
        Not such a state, of another component or other sizes, or cut short.
    """
    instance = COMPONENT.instance(**sizes)
    instance.from_bytes(content)
    return snapshot(instance)


def snapshot(instance: Instance) -> SandState:
    """Return the present geometry of a cushion, in copies.

    Parameters
    ----------
    instance : Instance
        The cushion.

    Returns
    -------
    SandState
        Its geometry.
    """
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
    base = float(base_top(instance.w, instance.x, instance.k))
    height = instance["box.wall_height"]
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
def list_contacts(w, x, k, table):
    """Write a row of ``table`` for each contact that touches; returns their number.

    The lists of candidates have room for all.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.
    table : ndarray of float64, shape (n, columns)
        Gets the contacts.

    Returns
    -------
    int
    """
    bodies = bodies_of(x, k)
    pair, spring = view(k, k, A.pair), view(x, k, A.spring)
    sand = law_of(KIND.sand, 1.0, view(x, k, A.law))
    rows = 0
    for p in range(view(k, k, A.across)[bodies.rock]):
        i, j = first_of(pair[p]), second_of(pair[p])
        if j < bodies.rock:  # else it fills up a block
            surface = touch_disc(i, j, bodies)
            forces = (-sand.normal * surface.gap, spring[p])
            rows = _write((i, j), surface, bodies.radius[j], forces, bodies, table, rows)
    owner, partner = view(k, k, A.edge_body), view(k, k, A.edge_partner)
    spring = view(x, k, A.edge_spring)
    for p in range(view(k, k, A.edge_row)[bodies.rock + 1]):
        i, b = owner[p], partner[p]
        boundary = boundary_of(b, bodies.rock, view(k, k, A.boundary))
        law = law_of(contact_kind(i, boundary, bodies), 1.0, view(x, k, A.law))
        surface = touch(i, b, boundary, w, bodies)
        radius = bodies.radius[b] if b < bodies.end else 0.0
        forces = (-law.normal * surface.gap, spring[p])
        rows = _write((i, b), surface, radius, forces, bodies, table, rows)
    return rows


@kernel
def _write(pair, surface, radius, forces, bodies, table, rows):
    """Write a contact behind the rows that are there, if it touches; return their number."""
    if surface.gap >= 0.0:
        return rows
    i, j = pair
    x, y, reach = bodies.x[i], bodies.y[i], bodies.radius[i] + surface.gap + radius
    table[rows, 0], table[rows, 1] = i, j
    table[rows, 2], table[rows, 3] = x, y
    table[rows, 4], table[rows, 5] = x + surface.nx * reach, y + surface.ny * reach
    table[rows, 6] = -surface.gap
    table[rows, 7], table[rows, 8] = forces
    return rows + 1


def sizes_of(content: bytes) -> dict[str, int]:
    """Return the sizes of the cushion that a state belongs to, from its table of arrays.

    Parameters
    ----------
    content : bytes
        Serialized state.

    Returns
    -------
    dict of str to int
        Sizes for :func:`read`.

    Raises
    ------
    ComponentError
        Not the state of a component, or cut short.
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
