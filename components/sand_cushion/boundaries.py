"""Boundaries of the sand: a table of kinds, each with geometry and load.

Boundaries are numbered like bodies: the rock, the beam discs, and behind them the left wall, the
right wall and the base. ``boundary`` holds the :class:`Boundary` of each.
"""

import math
from collections import namedtuple

from ..common.kernels import inlined, kernel, view
from .beam_surface import (
    Lever,
    foot_of,
    lever_at,
    load_surface,
    surface_height,
    surface_velocity,
)
from .bodies import beam_count, bodies_of
from .contact_law import (
    Approach,
    permanent_overlap,
    respond,
    rolling_response,
    slip_resistance,
    yield_loss,
)
from .declarations import (
    BEAM_DISCS,
    BEAM_SURFACE,
    BOUNDARY_ROW,
    FREE,
    INDEX,
    KIND,
    LAW,
    LAYOUT,
    ON_BEAM,
    PLANES,
    SUM,
    UNBOUNDED,
    Boundary,
)
from .laws import law_of

V, A = LAYOUT.scalar, LAYOUT.array

DISC, WALL, FLOOR, BEAM_TOP, ABSENT = range(5)
"""Geometries: a round body; an upright plane, for the rock with an upper end; a level plane; the
beam's top as a surface; nothing."""
NOBODY, ITSELF, BEAM = range(3)
"""Carriers of the force on a boundary."""

ROCK = Boundary(DISC, KIND.rock, KIND.rock, ITSELF, transmits=0, beam_mass=0, side=0)
BEAM_DISC = Boundary(DISC, KIND.base, KIND.rock_base, ITSELF, transmits=1, beam_mass=1, side=0)
FIXED_WALL = Boundary(WALL, KIND.wall, KIND.rock_wall, NOBODY, transmits=0, beam_mass=0, side=1)
WALL_ON_BEAM = FIXED_WALL._replace(carrier=BEAM, transmits=1)
RIGID_FLOOR = Boundary(FLOOR, KIND.base, KIND.rock_base, NOBODY, transmits=1, beam_mass=0, side=0)
BEAM_AS_SURFACE = RIGID_FLOOR._replace(geometry=BEAM_TOP, carrier=BEAM, beam_mass=1)
NO_BASE = RIGID_FLOOR._replace(geometry=ABSENT)

Surface = namedtuple("Surface", "nx ny gap vx vy lever")
"""A boundary near a body: normal from the body to it, gap (m, negative when they overlap), velocity
of its surface at the contact (m/s), and where the beam carries it, if it does."""

_NOWHERE = Lever(0, 0, 0.0)
"""Place on the beam of what the beam does not carry."""

Edges = namedtuple("Edges", "owner partner spring plastic roll boundary law sums")
"""Contacts with boundaries, an element a contact: number of disc or rock, number of the boundary,
tangential spring force (N), permanent overlap (m), rolling moment (N m). Behind them the tables
that all contacts share."""

Work = namedtuple("Work", "elastic normal_dashpot tangential_dashpot sliding plastic")
"""Energies of contacts with boundaries: twice the elastic one (J), powers of the dashpots (W),
what slid and what yielded (J)."""


# --- the table ---


@inlined
def boundary_of(b, rock, table):
    """Return the row of boundary b in the table.

    Parameters
    ----------
    b : int
        Number of the boundary.
    rock : int
        Number of the rock.
    table : ndarray of int64
        Rows of the boundaries.

    Returns
    -------
    Boundary
    """
    at = BOUNDARY_ROW * (b - rock) & INDEX
    return Boundary(
        table[at],
        table[at + 1],
        table[at + 2],
        table[at + 3],
        table[at + 4],
        table[at + 5],
        table[at + 6],
    )


@inlined
def set_boundary(row, kind, side, table):
    """Write a row of the table, with the wall's side: -1 left, 1 right.

    Parameters
    ----------
    row : int
        Number of the row.
    kind : Boundary
        The row without the side.
    side : int
        -1 left, 1 right, 0 for what is no wall.
    table : ndarray of int64
        Rows of the boundaries.
    """
    at = BOUNDARY_ROW * row
    table[at] = kind.geometry
    table[at + 1] = kind.sand_contact
    table[at + 2] = kind.rock_contact
    table[at + 3] = kind.carrier
    table[at + 4] = kind.transmits
    table[at + 5] = kind.beam_mass
    table[at + 6] = side


@kernel
def describe_boundaries(w, k):
    """Write the table of boundaries, from the parameters.

    Parameters
    ----------
    w, k : ndarray
        Variables and integers of the instance.
    """
    m, table = beam_count(k), view(k, k, A.boundary)
    set_boundary(0, ROCK, 0, table)
    for row in range(1, m + 1):
        set_boundary(row, BEAM_DISC, 0, table)
    wall = WALL_ON_BEAM if w[V.walls] == ON_BEAM else FIXED_WALL
    set_boundary(m + 1, wall, -1, table)
    set_boundary(m + 2, wall, 1, table)
    base = RIGID_FLOOR
    if w[V.base] == BEAM_DISCS:
        base = NO_BASE
    elif w[V.base] == BEAM_SURFACE:
        base = BEAM_AS_SURFACE
    set_boundary(m + PLANES, base, 0, table)


# --- geometry ---


@inlined
def face_of(boundary, w):
    """Return the x (m) of a wall's inner face.

    Parameters
    ----------
    boundary : Boundary
        Row of the table of boundaries.
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        Place (m).
    """
    if boundary.side < 0:
        return w[V.box_left]
    return w[V.box_left] + w[V.box_width]


@inlined
def touch_disc(i, b, bodies):
    """Return the :class:`Surface` of the round boundary b near body i.

    Parameters
    ----------
    i : int
        Number of the disc, or of the rock.
    b : int
        Number of the boundary.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    Surface
    """
    dx, dy = bodies.x[b] - bodies.x[i], bodies.y[b] - bodies.y[i]
    distance = math.sqrt(dx * dx + dy * dy)
    nx, ny = 0.0, -1.0
    if distance > 0.0:
        nx, ny = dx / distance, dy / distance
    turning = bodies.spin[b]  # the contact lies at -n * radius from b's centre
    return Surface(
        nx,
        ny,
        distance - bodies.radius[i] - bodies.radius[b],
        bodies.vx[b] + turning * ny,
        bodies.vy[b] - turning * nx,
        _NOWHERE,
    )


@inlined
def touch_base(i, boundary, w, bodies):
    """Return the :class:`Surface` of floor or beam near body i.

    There is no base for a rock on or beyond the walls; walls without end let none out.

    Parameters
    ----------
    i : int
        Number of the disc, or of the rock.
    boundary : Boundary
        Row of the table of boundaries.
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    Surface
    """
    xi, yi, ri = bodies.x[i], bodies.y[i], bodies.radius[i]
    inside = w[V.box_left] <= xi <= w[V.box_left] + w[V.box_width]
    if i == bodies.rock and w[V.box_wall_height] != UNBOUNDED and not inside:
        return Surface(0.0, -1.0, UNBOUNDED, 0.0, 0.0, _NOWHERE)
    if boundary.geometry == FLOOR:
        return Surface(0.0, -1.0, yi - w[V.base_y] - ri, 0.0, 0.0, _NOWHERE)
    foot = foot_of(xi, yi, bodies)
    vx, vy = surface_velocity(foot.lever, bodies)
    return Surface(foot.nx, foot.ny, foot.height - ri, vx, vy, foot.lever)


@inlined
def touch_wall(i, boundary, w, bodies):
    """Return the :class:`Surface` of a wall near body i: a plane for sand, a block for the rock.

    Parameters
    ----------
    i : int
        Number of the disc, or of the rock.
    boundary : Boundary
        Row of the table of boundaries.
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    Surface
    """
    xi, ri = bodies.x[i], bodies.radius[i]
    face = face_of(boundary, w)
    nx = float(boundary.side)
    foot, vy, lever = w[V.base_y], 0.0, _NOWHERE
    if boundary.carrier == BEAM:
        lever = lever_at(face, bodies)
        foot = surface_height(lever, bodies)
        _, vy = surface_velocity(lever, bodies)
    out, over = (xi - face) * nx, bodies.y[i] - foot - w[V.box_wall_height]
    endless = i != bodies.rock or w[V.box_wall_height] == UNBOUNDED
    if endless or (over <= 0.0 and out <= 0.0):
        return Surface(nx, 0.0, (xi - face) * -nx - ri, 0.0, vy, lever)
    beyond = min(out, 0.0) + max(out - w[V.box_wall_thickness], 0.0)
    above = max(over, 0.0)
    distance = math.sqrt(beyond * beyond + above * above)
    if distance == 0.0:
        return Surface(nx, 0.0, -out - ri, 0.0, vy, lever)
    return Surface(-nx * beyond / distance, -above / distance, distance - ri, 0.0, vy, lever)


@inlined
def touch(i, b, boundary, w, bodies):
    """Return the :class:`Surface` of boundary b near body i, a disc or the rock.

    Parameters
    ----------
    i, b : int
        Numbers of body and boundary.
    boundary : Boundary
        Row of the table of boundaries.
    w : ndarray of float64
        Parameters.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    Surface
        Geometry and velocity at the contact.
    """
    if boundary.geometry == DISC:
        return touch_disc(i, b, bodies)
    if boundary.geometry == WALL:
        return touch_wall(i, boundary, w, bodies)
    return touch_base(i, boundary, w, bodies)


# --- loads ---


@inlined
def carry(b, boundary, force, surface, bodies):
    """Hand the force on boundary b to whoever carries it.

    Parameters
    ----------
    b : int
        Number of the boundary.
    boundary : Boundary
        Row of the table of boundaries.
    force : tuple of float
        To the right and upwards (N). A wall has no mass, and hands down the vertical part.
    surface : Surface
        Geometry of the contact.
    bodies : Bodies
        Columns of all bodies.
    """
    fx, fy = force
    if boundary.carrier == ITSELF:
        bodies.force_x[b] += fx
        bodies.force_y[b] += fy
        bodies.turn[b] += surface.ny * fx - surface.nx * fy
    elif boundary.carrier == BEAM:
        load_surface(surface.lever, 0.0 if boundary.geometry == WALL else fx, fy, bodies)


# --- contacts ---


@inlined
def contact_kind(i, boundary, bodies):
    """Return the kind of the contact of disc or rock i with a boundary, one of :data:`KIND`.

    Parameters
    ----------
    i : int
        Number of the disc, or of the rock.
    boundary : Boundary
        Row of the table of boundaries.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    int
    """
    return boundary.rock_contact if i == bodies.rock else boundary.sand_contact


@inlined
def dashpot_root(i, boundary, w, bodies):
    """Return the root of the mass m in c_n = 2 h sqrt(m k_n) (kg^0.5, eq. 1).

    That of the disc or the rock, but the beam disc's where sand lies on a beam.

    Parameters
    ----------
    i : int
        Number of the disc, or of the rock.
    boundary : Boundary
        Row of the table of boundaries.
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    float
        Root of mass (kg^0.5).
    """
    on_beam = boundary.beam_mass == 1 and i < bodies.rock
    if on_beam and w[V.beam_disc_mass] > 0.0:
        return 2.0 * bodies.half_root[bodies.rock + 1]
    return 2.0 * bodies.half_root[i]


@inlined
def roll_on(p, is_round, normal, law, dt, bodies, edges):
    """Let rolling resistance act in the contact p with a boundary. Planes take no moment.

    Parameters
    ----------
    p : int
        Number of the contact.
    is_round : bool
        Whether the boundary is a round body.
    normal : float
        Normal force (N).
    law : Law
        Constants of the contact.
    dt : float
        Time step (s).
    bodies : Bodies
        Columns of all bodies.
    edges : Edges
        Contacts with boundaries.
    """
    i, b = edges.owner[p] & INDEX, edges.partner[p] & INDEX
    radius = bodies.radius[i]
    speed, reduced = -bodies.spin[i] / radius, radius
    if is_round:
        speed += bodies.spin[b] / bodies.radius[b]
        reduced = radius * bodies.radius[b] / (radius + bodies.radius[b])
    rolling = rolling_response(edges.roll[p], speed, reduced, normal, law, dt)
    edges.roll[p] = rolling.moment
    edges.sums[SUM.rolling] += rolling.dissipated
    edges.sums[SUM.elastic] += rolling.elastic
    bodies.turn[i] += rolling.moment / radius
    if is_round:
        bodies.turn[b] -= rolling.moment / bodies.radius[b]


@inlined
def let_go(p, lost, kind, edges):
    """Forget the spring of a contact that is open: its energy counts as slid, as :class:`Work`.

    Parameters
    ----------
    p : int
        Number of the contact.
    lost : float
        Energy that has yielded (J).
    kind : int
        Kind of the contact, one of :data:`KIND`.
    edges : Edges
        Contacts with boundaries.

    Returns
    -------
    Work
    """
    before, compliance = edges.spring[p], edges.law[kind * len(LAW) + LAW.compliance & INDEX]
    edges.spring[p] = 0.0
    edges.roll[p] = 0.0
    return Work(0.0, 0.0, 0.0, 0.5 * before * before * compliance, lost)


@inlined
def approach_of(i, overlap, surface, bodies):
    """Return how body i meets a surface, with the elastic overlap (m); no root of mass in it.

    Parameters
    ----------
    i : int
        Number of the disc, or of the rock.
    overlap : float
        Elastic overlap (m).
    surface : Surface
        Geometry and velocity at the contact.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    Approach
    """
    nx, ny = surface.nx, surface.ny
    vx, vy = surface.vx - bodies.vx[i], surface.vy - bodies.vy[i]
    return Approach(overlap, vx * nx + vy * ny, vy * nx - vx * ny - bodies.spin[i], 1.0)


@inlined
def hand_on(i, b, boundary, response, surface, bodies):
    """Give the contact force to body i and boundary b; returns what counts as transmitted (N).

    Parameters
    ----------
    i : int
        Number of the disc, or of the rock.
    b : int
        Number of the boundary.
    boundary : Boundary
        Row of the table of boundaries.
    response : Response
        Forces of the contact law (N).
    surface : Surface
        Geometry and velocity at the contact.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    float
        Force (N).
    """
    normal, tangential = response.normal, response.tangential
    fx = normal * surface.nx + tangential * surface.ny  # of i on b
    fy = normal * surface.ny - tangential * surface.nx
    bodies.force_x[i] -= fx
    bodies.force_y[i] -= fy
    bodies.turn[i] += tangential
    carry(b, boundary, (fx, fy), surface, bodies)
    return fy if boundary.transmits == 1 else 0.0


@inlined
def press_on(p, dt, rolls, w, bodies, edges):
    """Compute the contact p of a disc or the rock with a boundary; returns its :class:`Work`.

    Parameters
    ----------
    p : int
        Number of the contact.
    dt : float
        Time step (s).
    rolls : bool
        Whether there is rolling resistance.
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.
    edges : Edges
        Contacts with boundaries.

    Returns
    -------
    Work
    """
    i, b = edges.owner[p] & INDEX, edges.partner[p] & INDEX
    boundary = boundary_of(b, bodies.rock, edges.boundary)
    surface = touch(i, b, boundary, w, bodies)
    kind = contact_kind(i, boundary, bodies)
    if surface.gap >= 0.0:
        edges.plastic[p] = 0.0
        return let_go(p, 0.0, kind, edges)
    law = law_of(kind, dashpot_root(i, boundary, w, bodies), edges.law)
    yielded, spring = edges.plastic[p], edges.spring[p]
    permanent = permanent_overlap(yielded, -surface.gap, law)
    lost = yield_loss(yielded, permanent, 0.0, law)
    edges.plastic[p] = permanent
    approach = approach_of(i, -surface.gap - permanent, surface, bodies)
    if approach.overlap <= 0.0:
        return let_go(p, lost, kind, edges)
    response = respond(approach, spring, slip_resistance(1.0, law, dt), law, dt)
    edges.spring[p] = response.spring
    edges.sums[SUM.transmitted] -= hand_on(i, b, boundary, response, surface, bodies)
    if rolls and law.rolling > 0.0:
        roll_on(p, boundary.geometry == DISC, response.normal, law, dt, bodies, edges)
    return Work(
        response.elastic * approach.overlap + response.spring * response.spring * law.compliance,
        (response.elastic - response.normal) * approach.opening,
        law.tangential_damping * response.creep * response.creep,
        response.tangential * (approach.slip - response.creep) * dt,
        lost,
    )


@kernel
def press_boundaries(dt, w, x, k):
    """Add the contact forces of discs and rock with boundaries, and what they do to the energy.

    Parameters
    ----------
    dt : float
        Time step (s) by which contact springs advance.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    bodies = bodies_of(x, k)
    edges = Edges(
        view(k, k, A.edge_body),
        view(k, k, A.edge_partner),
        view(x, k, A.edge_spring),
        view(x, k, A.edge_plastic),
        view(x, k, A.edge_roll),
        view(k, k, A.boundary),
        view(x, k, A.law),
        view(x, k, A.sums),
    )
    rolls = w[V.rotation] == FREE and w[V.rolling_resistance] > 0.0
    elastic, normal_dashpot, tangential_dashpot, sliding, plastic = 0.0, 0.0, 0.0, 0.0, 0.0
    for p in range(view(k, k, A.edge_row)[bodies.rock + 1] & INDEX):
        work = press_on(p, dt, rolls, w, bodies, edges)
        elastic += work.elastic
        normal_dashpot += work.normal_dashpot
        tangential_dashpot += work.tangential_dashpot
        sliding += work.sliding
        plastic += work.plastic
    edges.sums[SUM.elastic] += 0.5 * elastic
    edges.sums[SUM.normal_dashpot] += normal_dashpot * dt
    edges.sums[SUM.tangential_dashpot] += tangential_dashpot * dt
    edges.sums[SUM.sliding] += sliding
    edges.sums[SUM.plastic] += plastic
