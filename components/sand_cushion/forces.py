"""Contact forces on all bodies, and what they do to the energy."""

import math

from ..compilation import inlined, kernel
from ..ports import view
from .contact_law import (
    capillary_energy,
    capillary_pull,
    normal_force,
    permanent_overlap,
    rolling_moment,
    tangential_force,
    yield_loss,
)
from .contact_search import beam_count, disc_count
from .declarations import (
    BEAM_SURFACE,
    BLOCK,
    COLUMN,
    FORCE_ROW,
    FREE,
    HALF_ROOT,
    INDEX,
    KIND,
    LAW,
    LAYOUT,
    ON_BEAM,
    RADIUS,
    ROW,
    SPIN,
    SUM,
    UNBOUNDED,
)
from .vector_rows import LANES, columns_to_pairs, pairs_to_columns

V, A = LAYOUT.scalar, LAYOUT.array

ROLLING = 2.25
"""Rolling stiffness / (k_n (mu_r R)^2), after Ai et al. (2011), eq. (20)."""


@kernel
def clear(load, sums):
    """Forget the forces and the elastic energy of the step before."""
    for q in range(load.size):
        load[q] = 0.0
    sums[SUM.elastic], sums[SUM.transmitted] = 0.0, 0.0


@inlined
def block_law(block, spring, plastic, law, dt, lasting):
    """The law of contact_law.py for a block of pairs, in a form that the compiler turns into vector instructions: no branches,
    a quantity of all pairs beside the other. Pairs that do not touch come out with nothing.

    lasting: whether contacts may keep an overlap or stick together; a constant of the calling place, so that the plain law costs
    nothing more.
    """
    stiffness, damping, share = law[LAW.unloading], law[LAW.damping], law[LAW.yielding]
    tangential, tangential_damping, friction = law[LAW.tangential], law[LAW.tangential_damping], law[LAW.friction]
    for q in range(BLOCK):
        dx, dy = block[COLUMN.x * BLOCK + q], block[COLUMN.y * BLOCK + q]
        dvx, dvy = block[COLUMN.vx * BLOCK + q], block[COLUMN.vy * BLOCK + q]
        root = block[COLUMN.root * BLOCK + q]
        distance = math.sqrt(dx * dx + dy * dy)
        inverse = 1.0 / distance
        nx, ny = dx * inverse, dy * inverse
        reach = block[COLUMN.reach * BLOCK + q]
        overlap = reach - distance
        opening = dvx * nx + dvy * ny
        slip = dvy * nx - dvx * ny - block[COLUMN.spin * BLOCK + q]
        pull = 0.0
        if lasting:
            bridge, full = law[LAW.bridge] * reach, law[LAW.pull] * reach
            yielded = permanent_overlap(plastic[q], overlap, share)
            lost = yield_loss(plastic[q], yielded, stiffness, share, full) if yielded > plastic[q] else 0.0
            plastic[q] = yielded if overlap > -bridge else 0.0
            overlap -= plastic[q]
            pull = capillary_pull(overlap, full, bridge)
            block[COLUMN.plastic * BLOCK + q] += lost
            block[COLUMN.capillary * BLOCK + q] += capillary_energy(overlap, full, bridge)
        pressed = normal_force(overlap, opening, stiffness, damping * root)
        normal = pressed if overlap > 0.0 else 0.0
        dashpot, before = tangential_damping * root, spring[q]
        force, stretched, taken = tangential_force(before, slip, tangential, dashpot, friction * normal, dt)
        kept = stretched if overlap > 0.0 else 0.0
        spring[q] = kept
        elastic = overlap * overlap
        dashpot_n = (stiffness * overlap - normal) * opening
        dashpot_t = dashpot * taken * taken
        slid = force * (slip - taken) * dt
        released = 0.5 * before * before / tangential
        block[COLUMN.elastic * BLOCK + q] += elastic if overlap > 0.0 else 0.0
        block[COLUMN.tangential * BLOCK + q] += kept * kept
        block[COLUMN.normal_dashpot * BLOCK + q] += dashpot_n if overlap > 0.0 else 0.0
        block[COLUMN.tangential_dashpot * BLOCK + q] += dashpot_t if overlap > 0.0 else 0.0
        block[COLUMN.sliding * BLOCK + q] += slid if overlap > 0.0 else released
        attracted = normal - pull
        block[q] = attracted * nx + force * ny  # force that the first exerts on the second
        block[BLOCK + q] = attracted * ny - force * nx
        block[2 * BLOCK + q] = force
        block[3 * BLOCK + q] = normal


@kernel
def block_rolling(begin, end, dt, body, load, first, second, roll, block, law, sums):
    """Rolling resistance of a block of pairs."""
    stiffness, rolling = law[LAW.normal], law[LAW.rolling]
    for p in range(begin, end):
        normal = block[3 * BLOCK + p - begin]
        if normal <= 0.0:
            roll[p] = 0.0
            continue
        i, j = ROW * first[p], ROW * second[p]
        ri, rj = body[i + RADIUS], body[j + RADIUS]
        radius = ri * rj / (ri + rj)
        bend = ROLLING * stiffness * rolling * rolling * radius * radius
        turning = body[j + SPIN] / rj - body[i + SPIN] / ri
        roll[p], lost = rolling_moment(roll[p], turning, bend, rolling * radius * normal, dt)
        sums[SUM.rolling] += lost
        sums[SUM.elastic] += 0.5 * roll[p] * roll[p] / bend
        load[FORCE_ROW * first[p] + 2] += roll[p] / ri
        load[FORCE_ROW * second[p] + 2] -= roll[p] / rj


@kernel
def between_discs(dt, pairs, rolls, lasting, body, load, first, second, spring, plastic, roll, law, block, sums):
    """Forces between sand discs: eq. (1) of the paper, block by block."""
    for q in range(COLUMN.elastic * BLOCK, len(COLUMN) * BLOCK):
        block[q] = 0.0
    for b in range((pairs + BLOCK - 1) // BLOCK):
        begin = b * BLOCK & INDEX
        for q in range(0, BLOCK, LANES):
            pairs_to_columns(body, first, second, begin + q, block, q, BLOCK)
        if lasting:
            block_law(block, spring[begin:begin + BLOCK], plastic[begin:begin + BLOCK], law, dt, True)
        else:
            block_law(block, spring[begin:begin + BLOCK], plastic[begin:begin + BLOCK], law, dt, False)
        for q in range(0, BLOCK, LANES):
            columns_to_pairs(load, first, second, begin + q, block, q, BLOCK)
        if rolls:
            block_rolling(begin, min(begin + BLOCK, pairs), dt, body, load, first, second, roll, block, law, sums)
    sums[SUM.elastic] += 0.5 * (law[LAW.unloading] * lane_sum(block, COLUMN.elastic)
                                + lane_sum(block, COLUMN.tangential) / law[LAW.tangential])
    sums[SUM.normal_dashpot] += lane_sum(block, COLUMN.normal_dashpot) * dt
    sums[SUM.tangential_dashpot] += lane_sum(block, COLUMN.tangential_dashpot) * dt
    sums[SUM.sliding] += lane_sum(block, COLUMN.sliding)
    sums[SUM.plastic] += lane_sum(block, COLUMN.plastic)
    sums[SUM.capillary] = lane_sum(block, COLUMN.capillary)


@kernel
def lane_sum(block, column):
    """Sum over a column of the block."""
    total = 0.0
    for q in range(BLOCK):
        total += block[column * BLOCK + q]
    return total


@inlined
def beam_place(px, body, n, m):
    """The beam disc left of ``px`` and the share of the next one, by the lever rule."""
    if m == 1:
        return n + 1, 0.0
    first, last = body[ROW * (n + 1)], body[ROW * (n + m)]
    position = (px - first) / (last - first) * (m - 1)
    left = min(m - 2, max(0, math.floor(position)))
    return n + 1 + left, min(1.0, max(0.0, position - left))


@inlined
def away_from_wall(out, over, thickness):
    """How far (m) a point ``out`` outside a wall's inner face and ``over`` its top is from the wall: outwards, upwards."""
    beyond = min(out, 0.0) + max(out - thickness, 0.0)
    return beyond, max(over, 0.0)


@inlined
def is_beside(px, w):
    """Whether a rock at ``px`` (m) is on or beyond the walls, where there is no base. Walls without end let none out."""
    inside = w[V.box_left] <= px <= w[V.box_left] + w[V.box_width]
    return w[V.box_wall_height] != UNBOUNDED and not inside


@inlined
def touch(i, b, w, body, n, m):
    """Geometry of a contact of disc i (or the rock) with boundary b.

    Returns normal (from i to b), gap (m, negative when they overlap) and the velocity of the boundary's surface at
    the contact (m/s).
    """
    xi, yi, ri = body[ROW * i], body[ROW * i + 1], body[ROW * i + RADIUS]
    if b <= n + m:
        dx, dy = body[ROW * b] - xi, body[ROW * b + 1] - yi
        distance = math.sqrt(dx * dx + dy * dy)
        nx, ny = dx / distance, dy / distance
        turning = body[ROW * b + SPIN]  # the contact lies at -n * radius from b's centre
        return nx, ny, distance - ri - body[ROW * b + RADIUS], body[ROW * b + 2] + turning * ny, body[ROW * b + 3] - turning * nx
    if b == n + m + 3:
        if i == n and is_beside(xi, w):
            return 0.0, -1.0, UNBOUNDED, 0.0, 0.0
        if w[V.base] != BEAM_SURFACE:
            return 0.0, -1.0, yi - w[V.base_y] - ri, 0.0, 0.0
        a, share = beam_place(xi, body, n, m)
        c = a if m == 1 else a + 1
        top = (1.0 - share) * body[ROW * a + 1] + share * body[ROW * c + 1] + body[ROW * a + RADIUS]
        vx = (1.0 - share) * (body[ROW * a + 2] - body[ROW * a + SPIN]) + share * (body[ROW * c + 2] - body[ROW * c + SPIN])
        vy = (1.0 - share) * body[ROW * a + 3] + share * body[ROW * c + 3]
        return 0.0, -1.0, yi - top - ri, vx, vy
    vy, foot = 0.0, w[V.base_y]
    nx = -1.0 if b == n + m + 1 else 1.0
    face = w[V.box_left] if b == n + m + 1 else w[V.box_left] + w[V.box_width]
    if w[V.walls] == ON_BEAM:
        a, share = beam_place(face, body, n, m)
        c = a if m == 1 else a + 1
        vy = (1.0 - share) * body[ROW * a + 3] + (0.0 if m == 1 else share * body[ROW * c + 3])
        foot = (1.0 - share) * body[ROW * a + 1] + share * body[ROW * c + 1] + body[ROW * a + RADIUS]
    out, over = (xi - face) * nx, yi - foot - w[V.box_wall_height]
    if i != n or (over <= 0.0 and out <= 0.0) or w[V.box_wall_height] == UNBOUNDED:
        return nx, 0.0, (xi - face) * -nx - ri, 0.0, vy
    beyond, above = away_from_wall(out, over, w[V.box_wall_thickness])
    distance = math.sqrt(beyond * beyond + above * above)
    if distance == 0.0:
        return nx, 0.0, -out - ri, 0.0, vy
    return -nx * beyond / distance, -above / distance, distance - ri, 0.0, vy


@inlined
def load_boundary(b, i, fx, fy, nx, ny, w, body, load, sums, n, m):
    """Hand the force (fx, fy) of body i on boundary b to whoever carries it."""
    if b <= n + m:
        at = FORCE_ROW * b & INDEX
        load[at] += fx
        load[at + 1] += fy
        load[at + 2] += ny * fx - nx * fy
        if b > n:
            sums[SUM.transmitted] -= fy
        return
    base = b == n + m + 3
    if base or w[V.walls] == ON_BEAM:
        sums[SUM.transmitted] -= fy
    if (base and w[V.base] == BEAM_SURFACE) or (not base and w[V.walls] == ON_BEAM):
        place = body[ROW * i] if base else (w[V.box_left] if b == n + m + 1 else w[V.box_left] + w[V.box_width])
        a, share = beam_place(place, body, n, m)
        load_beam(a, 1.0 - share, fx if base else 0.0, fy, load)
        if m > 1:
            load_beam(a + 1, share, fx if base else 0.0, fy, load)


@inlined
def load_beam(a, share, fx, fy, load):
    """Give beam disc a its share of a force at the beam's top."""
    load[FORCE_ROW * a] += share * fx
    load[FORCE_ROW * a + 1] += share * fy
    load[FORCE_ROW * a + 2] -= share * fx


@kernel
def with_boundaries(dt, w, x, k):
    """Forces of discs and rock with rock, beam, base and walls."""
    n, m = disc_count(k), beam_count(k)
    body, load, law, sums = view(x, k, A.body), view(x, k, A.load), view(x, k, A.law), view(x, k, A.sums)
    owner, partner = view(k, k, A.edge_body), view(k, k, A.edge_partner)
    spring, plastic, roll = view(x, k, A.edge_spring), view(x, k, A.edge_plastic), view(x, k, A.edge_roll)
    rolls = w[V.rotation] == FREE and w[V.rolling_resistance] > 0.0
    elastic, dashpot_n, dashpot_t, slid, lost = 0.0, 0.0, 0.0, 0.0, 0.0
    for p in range(view(k, k, A.edge_row)[n + 1] & INDEX):
        i, b = owner[p] & INDEX, partner[p] & INDEX
        at, force_at = ROW * i & INDEX, FORCE_ROW * i & INDEX
        nx, ny, gap, vx, vy = touch(i, b, w, body, n, m)
        kind = kind_of(i, b, n, m) * len(LAW) & INDEX
        tangential = law[kind + LAW.tangential]
        stiffness, share = law[kind + LAW.unloading], law[kind + LAW.yielding]
        yielded = permanent_overlap(plastic[p], -gap, share)
        if yielded > plastic[p]:
            lost += yield_loss(plastic[p], yielded, stiffness, share, 0.0)
        plastic[p] = yielded if gap < 0.0 else 0.0
        gap += plastic[p]
        if gap >= 0.0:
            if spring[p] != 0.0:
                slid += 0.5 * spring[p] * spring[p] / tangential
                spring[p] = 0.0
            roll[p] = 0.0
            continue
        dvx, dvy = vx - body[at + 2], vy - body[at + 3]
        opening = dvx * nx + dvy * ny
        slip = dvy * nx - dvx * ny - body[at + SPIN]
        mass_root = dashpot_root(i, b, w, body, n, m)
        normal = normal_force(-gap, opening, stiffness, law[kind + LAW.damping] * mass_root)
        dashpot = law[kind + LAW.tangential_damping] * mass_root
        force, kept, taken = tangential_force(spring[p], slip, tangential, dashpot, law[kind + LAW.friction] * normal, dt)
        spring[p] = kept
        elastic += stiffness * gap * gap + kept * kept / tangential
        dashpot_n += (-stiffness * gap - normal) * opening
        dashpot_t += dashpot * taken * taken
        slid += force * (slip - taken) * dt
        px, py = normal * nx + force * ny, normal * ny - force * nx  # force that i exerts on b
        load[force_at] -= px
        load[force_at + 1] -= py
        load[force_at + 2] += force
        load_boundary(b, i, px, py, nx, ny, w, body, load, sums, n, m)
        if rolls and law[kind + LAW.rolling] > 0.0:
            roll[p] = roll_on_boundary(dt, i, b, b <= n + m, roll[p], normal, law[kind + LAW.normal], law[kind + LAW.rolling], body,
                                       load, sums)
    sums[SUM.elastic] += 0.5 * elastic
    sums[SUM.normal_dashpot] += dashpot_n * dt
    sums[SUM.tangential_dashpot] += dashpot_t * dt
    sums[SUM.sliding] += slid
    sums[SUM.plastic] += lost


@inlined
def dashpot_root(i, b, w, body, n, m):
    """Root of the mass m in c_n = 2 h sqrt(m k_n) (eq. 1): that of the disc or the rock, but the beam disc's where sand lies on a
    beam."""
    on_beam = i < n and b > n and (b <= n + m or (b == n + m + 3 and w[V.base] == BEAM_SURFACE))
    if on_beam and w[V.beam_disc_mass] > 0.0:
        return 2.0 * body[ROW * (n + 1) + HALF_ROOT]
    return 2.0 * body[ROW * i + HALF_ROOT]


@inlined
def roll_on_boundary(dt, i, b, is_round, moment, normal, stiffness, rolling, body, load, sums):
    """Rolling resistance of disc i on boundary b. Returns the moment (N m) on i. Planes do not turn, and take no moment."""
    radius = body[ROW * i + RADIUS]
    turning, reduced = -body[ROW * i + SPIN] / radius, radius
    if is_round:
        turning += body[ROW * b + SPIN] / body[ROW * b + RADIUS]
        reduced = radius * body[ROW * b + RADIUS] / (radius + body[ROW * b + RADIUS])
    bend = ROLLING * stiffness * rolling * rolling * reduced * reduced
    moment, lost = rolling_moment(moment, turning, bend, rolling * reduced * normal, dt)
    sums[SUM.rolling] += lost
    sums[SUM.elastic] += 0.5 * moment * moment / bend
    load[FORCE_ROW * i + 2] += moment / radius
    if is_round:
        load[FORCE_ROW * b + 2] -= moment / body[ROW * b + RADIUS]
    return moment


@inlined
def kind_of(i, b, n, m):
    """Kind of the contact of disc or rock i with boundary b."""
    wall = b == n + m + 1 or b == n + m + 2
    if i == n:
        return KIND.rock_wall if wall else KIND.rock_base
    if b == n:
        return KIND.rock
    return KIND.wall if wall else KIND.base


@kernel
def contact_forces(dt, w, x, k):
    """All contact forces, into ``load``; contact springs advance by dt (s)."""
    sums = view(x, k, A.sums)
    clear(view(x, k, A.load), sums)
    rolls = w[V.rotation] == FREE and w[V.rolling_resistance] > 0.0
    lasting = w[V.unloading_ratio] > 1.0 or w[V.cohesion] > 0.0
    between_discs(dt, view(k, k, A.row)[disc_count(k)], rolls, lasting, view(x, k, A.body), view(x, k, A.load),
                  view(k, k, A.first), view(k, k, A.second), view(x, k, A.spring), view(x, k, A.plastic), view(x, k, A.roll),
                  view(x, k, A.law), view(x, k, A.block), sums)
    with_boundaries(dt, w, x, k)
