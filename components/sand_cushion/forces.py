"""Contact forces on all bodies, and what they do to the energy."""

import math

from ..common.kernels import inlined, kernel, view
from .contact_law import (
    normal_force,
    permanent_overlap,
    rolling_moment,
    tangential_force,
    yield_loss,
)
from .contact_search import beam_count, disc_count, first_of, part_count, second_of
from .declarations import (
    BEAM_SURFACE,
    BLOCK,
    COLUMN,
    FORCE_ROW,
    FREE,
    HALF_ROOT,
    INDEX,
    KIND,
    LANES,
    LAW,
    LAYOUT,
    MOTION,
    ON_BEAM,
    RADIUS,
    ROLL,
    ROW,
    SPIN,
    SUM,
    TALLY,
    UNBOUNDED,
)
from .vector.law import lasting_law, plain_law
from .vector.rows import (
    FASTEST,
    KINETIC,
    POTENTIAL,
    columns_to_pairs,
    forces_to_pairs,
    move_rows,
    pairs_to_columns,
)
from .vector.threads import shared_among_threads

V, A = LAYOUT.scalar, LAYOUT.array

ROLLING = 2.25
"""Rolling stiffness / (k_n (mu_r R)^2), after Ai et al. (2011), eq. (20)."""


@inlined
def set_to_zero(numbers):
    """All of them."""
    for q in range(numbers.size):
        numbers[q] = 0.0


@kernel
def clear(begin, load, sums):
    """Forget the forces on the bodies from ``begin`` on, and what refers to the step before."""
    set_to_zero(load[FORCE_ROW * begin :])
    sums[SUM.elastic], sums[SUM.transmitted], sums[SUM.capillary] = 0.0, 0.0, 0.0


@inlined
def press_block(
    p,
    turning,
    rolls,
    lasting,
    dt,
    body,
    load,
    pair,
    spring,
    plastic,
    roll,
    law,
    block,
    tally,
    rolling,
):
    """Forces of a block of pairs, those from ``p`` on."""
    pairs_to_columns(body, pair, p, block)
    if lasting:
        lasting_law(block, spring, plastic, law, dt, p, tally)
    else:
        plain_law(block, spring, plastic, law, dt, p, tally)
    if turning:
        columns_to_pairs(load, pair, p, block)
    else:
        forces_to_pairs(load, pair, p, block)
    if rolls:
        block_rolling(p, dt, body, load, pair, roll, block, law, rolling)


@kernel
def block_rolling(begin, dt, body, load, pair, roll, block, law, rolling):
    """Rolling resistance of a block of pairs."""
    stiffness, resistance = law[LAW.normal], law[LAW.rolling]
    for q in range(BLOCK):
        normal = block[3 * BLOCK + q]
        if normal <= 0.0:
            roll[begin + q] = 0.0
            continue
        first, second = first_of(pair[begin + q]), second_of(pair[begin + q])
        i, j = ROW * first, ROW * second
        ri, rj = body[i + RADIUS], body[j + RADIUS]
        radius = ri * rj / (ri + rj)
        bend = ROLLING * stiffness * resistance * resistance * radius * radius
        turning = body[j + SPIN] / rj - body[i + SPIN] / ri
        moment, lost = rolling_moment(
            roll[begin + q], turning, bend, resistance * radius * normal, dt
        )
        roll[begin + q] = moment
        rolling[ROLL.lost] += lost
        rolling[ROLL.elastic] += 0.5 * moment * moment / bend
        load[FORCE_ROW * first + 2] += moment / ri
        load[FORCE_ROW * second + 2] -= moment / rj


@inlined
def part_of(buffer, k, entry, c, length):
    """The room of part c in an array that holds ``length`` numbers for each part."""
    begin = k[entry] + c * length
    return buffer[begin : begin + length]


@kernel
def press_pairs(begin, end, c, moving, dt, w, x, k):
    """Forces between the discs of the pairs from ``begin`` to before ``end``, whole blocks: eq. (1) of the paper. With ``moving``,
    these are the pairs of part c, and its discs go on in time, each as soon as it has been given its last force.
    """
    body, load, pair = view(x, k, A.body), view(x, k, A.load), view(k, k, A.pair)
    spring, plastic, roll = view(x, k, A.spring), view(x, k, A.plastic), view(x, k, A.roll)
    law, block = view(x, k, A.law), part_of(x, k, A.block, c, BLOCK * len(COLUMN))
    tally, rolling = (
        part_of(x, k, A.tally, c, LANES * len(TALLY)),
        part_of(x, k, A.rolling, c, len(ROLL)),
    )
    motion, angle, part = (
        part_of(x, k, A.motion, c, MOTION),
        view(x, k, A.angle),
        view(k, k, A.part),
    )
    turning = w[V.rotation] == FREE
    rolls = turning and w[V.rolling_resistance] > 0.0
    lasting = w[V.unloading_ratio] > 1.0 or w[V.cohesion] > 0.0
    done, last = part[c], part[c + 1]
    for p in range(begin, end, BLOCK):
        press_block(
            p,
            turning,
            rolls,
            lasting,
            dt,
            body,
            load,
            pair,
            spring,
            plastic,
            roll,
            law,
            block,
            tally,
            rolling,
        )
        if moving:
            ready = first_of(pair[p + BLOCK]) if p + BLOCK < end else last
            move_discs(done, ready, dt, w[V.gravity], turning, body, load, angle, motion)
            done = ready
    if moving:
        move_discs(done, last, dt, w[V.gravity], turning, body, load, angle, motion)


@inlined
def move_discs(begin, end, dt, gravity, turning, body, load, angle, motion):
    """Semi-implicit Euler for the discs from ``begin`` to before ``end``, whose forces are forgotten."""
    move_rows(body, load, begin, end, dt, gravity, 2.0 if turning else 0.0, motion)
    if turning:
        for i in range(begin, end):
            angle[i] += body[ROW * i + SPIN] / body[ROW * i + RADIUS] * dt


@kernel
def press_part(c, moving, dt, w, x, k):
    """:func:`press_pairs` for the pairs within part c."""
    part, row = view(k, k, A.part), view(k, k, A.row)
    press_pairs(row[part[c]], row[part[c + 1]], c, moving, dt, w, x, k)


press_parts = shared_among_threads(press_part)


@kernel
def between_discs(dt, moving, w, x, k):
    """Forces between sand discs, added to ``load``, and what they do to the energy. With ``moving`` the discs go on in time.

    Returns kinetic and potential energy (J) at the beginning of the step, where the contact forces were computed: with
    velocities half a step before and after it, m v_before v_after / 2. They are nothing without ``moving``.
    """
    across, parts = view(k, k, A.across), part_count(k)
    for entry in (A.tally, A.motion, A.rolling):
        set_to_zero(view(x, k, entry))
    press_pairs(across[0], across[across.size - 1], 0, False, dt, w, x, k)
    press_parts(int(w[V.threads]), parts, moving, dt, w, x, k)
    add_energies(
        dt,
        view(x, k, A.law),
        view(x, k, A.tally)[: parts * LANES * len(TALLY)],
        view(x, k, A.rolling),
        view(x, k, A.sums),
    )
    return add_motion(dt, w[V.gravity], view(x, k, A.motion)[: parts * MOTION], view(x, k, A.sums))


@kernel
def add_energies(dt, law, tally, rolling, sums):
    """Add what the parts have added up to the sums, and give it its scale."""
    sums[SUM.elastic] += 0.5 * (
        total(TALLY.elastic, tally) + total(TALLY.stretched, tally) * law[LAW.softness]
    )
    sums[SUM.normal_dashpot] += total(TALLY.normal_dashpot, tally) * dt
    sums[SUM.tangential_dashpot] += (
        law[LAW.tangential_damping] * total(TALLY.tangential_dashpot, tally) * dt
    )
    sums[SUM.sliding] += (
        total(TALLY.sliding, tally) * dt + 0.5 * total(TALLY.released, tally) * law[LAW.softness]
    )
    sums[SUM.plastic] += total(TALLY.plastic, tally)
    sums[SUM.capillary] += total(TALLY.capillary, tally)
    for q in range(0, rolling.size, len(ROLL)):
        sums[SUM.elastic] += rolling[q + ROLL.elastic]
        sums[SUM.rolling] += rolling[q + ROLL.lost]


@kernel
def total(energy, tally):
    """One of the energies of TALLY, of all parts: the sum of the lanes in four pairs."""
    result = 0.0
    for begin in range(LANES * energy, tally.size, LANES * len(TALLY)):
        lane = tally[begin : begin + LANES]
        result += (
            (lane[0] + lane[4]) + (lane[1] + lane[5]) + ((lane[2] + lane[6]) + (lane[3] + lane[7]))
        )
    return result


@kernel
def add_motion(dt, gravity, motion, sums):
    """Add the way of the fastest disc to the sums. Returns kinetic and potential energy (J), see :func:`between_discs`."""
    kinetic, potential, fastest = 0.0, 0.0, 0.0
    for q in range(0, motion.size, MOTION):
        kinetic += motion[q + KINETIC] + motion[q + KINETIC + 1] + 0.5 * motion[q + KINETIC + 2]
        potential += motion[q + POTENTIAL + 1]
        fastest = max(fastest, motion[q + FASTEST])
    sums[SUM.travelled] += math.sqrt(fastest) * dt
    return 2.0 * kinetic, 4.0 * potential * gravity


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
        return (
            nx,
            ny,
            distance - ri - body[ROW * b + RADIUS],
            body[ROW * b + 2] + turning * ny,
            body[ROW * b + 3] - turning * nx,
        )
    if b == n + m + 3:
        if i == n and is_beside(xi, w):
            return 0.0, -1.0, UNBOUNDED, 0.0, 0.0
        if w[V.base] != BEAM_SURFACE:
            return 0.0, -1.0, yi - w[V.base_y] - ri, 0.0, 0.0
        a, share = beam_place(xi, body, n, m)
        c = a if m == 1 else a + 1
        top = (1.0 - share) * body[ROW * a + 1] + share * body[ROW * c + 1] + body[ROW * a + RADIUS]
        vx = (1.0 - share) * (body[ROW * a + 2] - body[ROW * a + SPIN]) + share * (
            body[ROW * c + 2] - body[ROW * c + SPIN]
        )
        vy = (1.0 - share) * body[ROW * a + 3] + share * body[ROW * c + 3]
        return 0.0, -1.0, yi - top - ri, vx, vy
    vy, foot = 0.0, w[V.base_y]
    nx = -1.0 if b == n + m + 1 else 1.0
    face = w[V.box_left] if b == n + m + 1 else w[V.box_left] + w[V.box_width]
    if w[V.walls] == ON_BEAM:
        a, share = beam_place(face, body, n, m)
        c = a if m == 1 else a + 1
        vy = (1.0 - share) * body[ROW * a + 3] + (0.0 if m == 1 else share * body[ROW * c + 3])
        foot = (
            (1.0 - share) * body[ROW * a + 1] + share * body[ROW * c + 1] + body[ROW * a + RADIUS]
        )
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
        place = (
            body[ROW * i]
            if base
            else (w[V.box_left] if b == n + m + 1 else w[V.box_left] + w[V.box_width])
        )
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
    body, load, law, sums = (
        view(x, k, A.body),
        view(x, k, A.load),
        view(x, k, A.law),
        view(x, k, A.sums),
    )
    owner, partner = view(k, k, A.edge_body), view(k, k, A.edge_partner)
    spring, plastic, roll = (
        view(x, k, A.edge_spring),
        view(x, k, A.edge_plastic),
        view(x, k, A.edge_roll),
    )
    rolls = w[V.rotation] == FREE and w[V.rolling_resistance] > 0.0
    elastic, dashpot_n, dashpot_t, slid, lost = 0.0, 0.0, 0.0, 0.0, 0.0
    for p in range(view(k, k, A.edge_row)[n + 1] & INDEX):
        i, b = owner[p] & INDEX, partner[p] & INDEX
        at, force_at = ROW * i & INDEX, FORCE_ROW * i & INDEX
        nx, ny, gap, vx, vy = touch(i, b, w, body, n, m)
        kind = kind_of(i, b, n, m) * len(LAW) & INDEX
        softness = law[kind + LAW.softness]
        stiffness, share = law[kind + LAW.unloading], law[kind + LAW.yielding]
        yielded = permanent_overlap(plastic[p], -gap, share)
        if yielded > plastic[p]:
            lost += yield_loss(plastic[p], yielded, stiffness, share, 0.0)
        plastic[p] = yielded if gap < 0.0 else 0.0
        gap += plastic[p]
        if gap >= 0.0:
            if spring[p] != 0.0:
                slid += 0.5 * spring[p] * spring[p] * softness
                spring[p] = 0.0
            roll[p] = 0.0
            continue
        dvx, dvy = vx - body[at + 2], vy - body[at + 3]
        opening = dvx * nx + dvy * ny
        slip = dvy * nx - dvx * ny - body[at + SPIN]
        mass_root = dashpot_root(i, b, w, body, n, m)
        normal = normal_force(-gap, opening, stiffness, law[kind + LAW.damping] * mass_root)
        dashpot = law[kind + LAW.tangential_damping] * mass_root
        limit = law[kind + LAW.friction] * normal
        force, kept, taken = tangential_force(
            spring[p], slip, law[kind + LAW.tangential], dashpot, limit, dt
        )
        spring[p] = kept
        elastic += stiffness * gap * gap + kept * kept * softness
        dashpot_n += (-stiffness * gap - normal) * opening
        dashpot_t += dashpot * taken * taken
        slid += force * (slip - taken) * dt
        px, py = normal * nx + force * ny, normal * ny - force * nx  # force that i exerts on b
        load[force_at] -= px
        load[force_at + 1] -= py
        load[force_at + 2] += force
        load_boundary(b, i, px, py, nx, ny, w, body, load, sums, n, m)
        if rolls and law[kind + LAW.rolling] > 0.0:
            roll[p] = roll_on_boundary(
                dt,
                i,
                b,
                b <= n + m,
                roll[p],
                normal,
                law[kind + LAW.normal],
                law[kind + LAW.rolling],
                body,
                load,
                sums,
            )
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
    """All contact forces, into ``load``; contact springs advance by dt (s). See :func:`forget_forces`."""
    clear(0, view(x, k, A.load), view(x, k, A.sums))
    with_boundaries(dt, w, x, k)
    between_discs(dt, False, w, x, k)


@kernel
def forget_forces(x, k):
    """Forget the forces on the discs, as :func:`advance_discs` needs it; those on rock and beam stay."""
    set_to_zero(view(x, k, A.load)[: FORCE_ROW * disc_count(k)])


@kernel
def advance_discs(dt, w, x, k):
    """All contact forces, and a step dt (s) of the discs with them. Leaves the forces on rock and beam in ``load``.

    Returns kinetic and potential energy (J) at the beginning of the step.
    """
    clear(disc_count(k), view(x, k, A.load), view(x, k, A.sums))
    with_boundaries(dt, w, x, k)
    return between_discs(dt, True, w, x, k)
