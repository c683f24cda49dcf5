"""Contact forces on all bodies, and what they do to the energy."""

import math

from ..compilation import inlined, kernel
from ..ports import view
from .contact_law import normal_force, rolling_moment, tangential_force
from .contact_search import beam_count, disc_count
from .declarations import BEAM_SURFACE, FORCE_ROW, FREE, INDEX, KIND, LAW, LAYOUT, ON_BEAM, ROW, SUM

V, A = LAYOUT.scalar, LAYOUT.array

ROLLING = 2.25
"""Rolling stiffness / (k_n (mu_r R)^2), after Ai et al. (2011), eq. (20)."""


@kernel
def clear(load, sums):
    """Forget the forces and the elastic energy of the step before."""
    for q in range(load.size):
        load[q] = 0.0
    sums[SUM.elastic], sums[SUM.transmitted] = 0.0, 0.0


@kernel
def between_discs(n, dt, rotating, body, load, row, partner, spring, roll, law, sums):
    """Forces between sand discs: eq. (1) of the paper with the law of contact_law.py, pair by pair.

    Indices are masked with a number larger than all of them: the compiler then knows that none is negative and leaves out
    numba's handling of negative indices, a fifth of the time.
    """
    stiffness, damping = law[LAW.normal], law[LAW.damping]
    tangential, tangential_damping = law[LAW.tangential], law[LAW.tangential_damping]
    friction, rolling = law[LAW.friction], law[LAW.rolling]
    rolls = rotating and rolling > 0.0
    normal_elastic, tangential_elastic, rolling_elastic = 0.0, 0.0, 0.0
    dashpot_n, dashpot_t, slid, rolled = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        at = ROW * i & INDEX
        xi, yi, vxi, vyi = body[at], body[at + 1], body[at + 2], body[at + 3]
        wi, ri, qi = body[at + 4], body[at + 5], body[at + 7]
        fx, fy, torque = 0.0, 0.0, 0.0
        for p in range(row[2 * i] & INDEX, row[2 * i + 1] & INDEX):
            j = ROW * partner[p] & INDEX
            dx, dy, rj = body[j] - xi, body[j + 1] - yi, body[j + 5]
            square, reach = dx * dx + dy * dy, ri + rj
            if square >= reach * reach:
                if spring[p] != 0.0:
                    slid += 0.5 * spring[p] * spring[p] / tangential
                spring[p], roll[p] = 0.0, 0.0
                continue
            distance = math.sqrt(square)
            inverse = 1.0 / distance
            nx, ny = dx * inverse, dy * inverse
            dvx, dvy, wj = body[j + 2] - vxi, body[j + 3] - vyi, body[j + 4]
            overlap = reach - distance
            opening = dvx * nx + dvy * ny
            slip = dvy * nx - dvx * ny - (ri * wi + rj * wj)
            q = qi * body[j + 7]  # sqrt of the geometric mean of both masses
            normal = normal_force(overlap, opening, stiffness, damping * q)
            dashpot = tangential_damping * q
            force, kept, taken = tangential_force(spring[p], slip, tangential, dashpot, friction * normal, dt)
            spring[p] = kept
            normal_elastic += overlap * overlap
            tangential_elastic += kept * kept
            dashpot_n += (stiffness * overlap - normal) * opening
            dashpot_t += dashpot * taken * taken
            slid += force * (slip - taken) * dt
            turn = 0.0
            if rolls:
                radius = ri * rj / reach
                bend = ROLLING * stiffness * rolling * rolling * radius * radius
                turn, lost = rolling_moment(roll[p], wj - wi, bend, rolling * radius * normal, dt)
                roll[p] = turn
                rolled += lost
                rolling_elastic += turn * turn / bend
            px, py = normal * nx + force * ny, normal * ny - force * nx  # force that i exerts on j
            fx -= px
            fy -= py
            torque += ri * force + turn
            j = FORCE_ROW * partner[p] & INDEX
            load[j] += px
            load[j + 1] += py
            load[j + 2] += rj * force - turn
        at = FORCE_ROW * i & INDEX
        load[at] += fx
        load[at + 1] += fy
        load[at + 2] += torque
    sums[SUM.elastic] += 0.5 * (stiffness * normal_elastic + tangential_elastic / tangential + rolling_elastic)
    sums[SUM.normal_dashpot] += dashpot_n * dt
    sums[SUM.tangential_dashpot] += dashpot_t * dt
    sums[SUM.sliding] += slid
    sums[SUM.rolling] += rolled


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
def touch(i, b, w, body, n, m):
    """Geometry of a contact of disc i (or the rock) with boundary b.

    Returns normal (from i to b), gap (m, negative when they overlap) and the velocity of the boundary's surface at
    the contact (m/s).
    """
    xi, yi, ri = body[ROW * i], body[ROW * i + 1], body[ROW * i + 5]
    if b <= n + m:
        dx, dy = body[ROW * b] - xi, body[ROW * b + 1] - yi
        distance = math.sqrt(dx * dx + dy * dy)
        nx, ny = dx / distance, dy / distance
        turning = body[ROW * b + 4] * body[ROW * b + 5]  # surface speed; the contact lies at -n * radius from b's centre
        return nx, ny, distance - ri - body[ROW * b + 5], body[ROW * b + 2] + turning * ny, body[ROW * b + 3] - turning * nx
    if b == n + m + 3:
        if w[V.base] != BEAM_SURFACE:
            return 0.0, -1.0, yi - w[V.base_y] - ri, 0.0, 0.0
        a, share = beam_place(xi, body, n, m)
        c = a if m == 1 else a + 1
        top = (1.0 - share) * body[ROW * a + 1] + share * body[ROW * c + 1] + body[ROW * a + 5]
        vx = (1.0 - share) * (body[ROW * a + 2] - body[ROW * a + 4] * body[ROW * a + 5]) \
            + share * (body[ROW * c + 2] - body[ROW * c + 4] * body[ROW * c + 5])
        vy = (1.0 - share) * body[ROW * a + 3] + share * body[ROW * c + 3]
        return 0.0, -1.0, yi - top - ri, vx, vy
    vy = 0.0
    nx = -1.0 if b == n + m + 1 else 1.0
    face = w[V.box_left] if b == n + m + 1 else w[V.box_left] + w[V.box_width]
    if w[V.walls] == ON_BEAM:
        a, share = beam_place(face, body, n, m)
        vy = (1.0 - share) * body[ROW * a + 3] + (0.0 if m == 1 else share * body[ROW * (a + 1) + 3])
    return nx, 0.0, (xi - face) * -nx - ri, 0.0, vy


@inlined
def load_boundary(b, i, fx, fy, nx, ny, w, body, load, sums, n, m):
    """Hand the force (fx, fy) of body i on boundary b to whoever carries it."""
    if b <= n + m:
        at = FORCE_ROW * b & INDEX
        load[at] += fx
        load[at + 1] += fy
        load[at + 2] += body[ROW * b + 5] * (ny * fx - nx * fy)
        if b > n:
            sums[SUM.transmitted] -= fy
        return
    base = b == n + m + 3
    if base or w[V.walls] == ON_BEAM:
        sums[SUM.transmitted] -= fy
    if (base and w[V.base] == BEAM_SURFACE) or (not base and w[V.walls] == ON_BEAM):
        place = body[ROW * i] if base else (w[V.box_left] if b == n + m + 1 else w[V.box_left] + w[V.box_width])
        a, share = beam_place(place, body, n, m)
        load_beam(a, 1.0 - share, fx if base else 0.0, fy, body, load)
        if m > 1:
            load_beam(a + 1, share, fx if base else 0.0, fy, body, load)


@inlined
def load_beam(a, share, fx, fy, body, load):
    """Give beam disc a its share of a force at the beam's top."""
    load[FORCE_ROW * a] += share * fx
    load[FORCE_ROW * a + 1] += share * fy
    load[FORCE_ROW * a + 2] -= share * fx * body[ROW * a + 5]


@kernel
def with_boundaries(dt, w, x, k):
    """Forces of discs and rock with rock, beam, base and walls."""
    n, m = disc_count(k), beam_count(k)
    body, load, law, sums = view(x, k, A.body), view(x, k, A.load), view(x, k, A.law), view(x, k, A.sums)
    row, partner = view(k, k, A.row), view(k, k, A.partner)
    spring = view(x, k, A.spring)
    elastic, dashpot_n, dashpot_t, slid = 0.0, 0.0, 0.0, 0.0
    for i in range(n + 1):
        at, force_at = ROW * i & INDEX, FORCE_ROW * i & INDEX
        for p in range(row[2 * i + 1] & INDEX, row[2 * i + 2] & INDEX):
            b = partner[p] & INDEX
            nx, ny, gap, vx, vy = touch(i, b, w, body, n, m)
            kind = kind_of(i, b, n, m) * len(LAW) & INDEX
            tangential = law[kind + LAW.tangential]
            if gap >= 0.0:
                if spring[p] != 0.0:
                    slid += 0.5 * spring[p] * spring[p] / tangential
                    spring[p] = 0.0
                continue
            ri = body[at + 5]
            dvx, dvy = vx - body[at + 2], vy - body[at + 3]
            opening = dvx * nx + dvy * ny
            slip = dvy * nx - dvx * ny - ri * body[at + 4]
            mass_root = body[at + 7] * body[at + 7]  # sqrt of the mass of disc or rock
            stiffness = law[kind + LAW.normal]
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
            load[force_at + 2] += ri * force
            load_boundary(b, i, px, py, nx, ny, w, body, load, sums, n, m)
    sums[SUM.elastic] += 0.5 * elastic
    sums[SUM.normal_dashpot] += dashpot_n * dt
    sums[SUM.tangential_dashpot] += dashpot_t * dt
    sums[SUM.sliding] += slid


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
    between_discs(disc_count(k), dt, w[V.rotation] == FREE, view(x, k, A.body), view(x, k, A.load), view(k, k, A.row),
                  view(k, k, A.partner), view(x, k, A.spring), view(x, k, A.roll), view(x, k, A.law), sums)
    with_boundaries(dt, w, x, k)
