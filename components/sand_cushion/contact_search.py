"""Candidates for contact: a Verlet list made on a grid of cells, whose contact springs survive a rebuild.

Bodies are numbered: discs 0 .. N-1, the rock N, beam discs N+1 .. N+M, then the planes: left wall, right wall, base. There are
two lists. ``pair`` names the pairs of discs, see :func:`pair_of`, the lower number first and in ascending order. The discs are
divided into parts, part c from ``part[c]`` on, so that threads can share the work: the list begins with the pairs within the
parts, part by part, those of disc i from ``row[i]`` on; the pairs between two parts follow, those of disc i from ``across[i]`` on.
Each part fills whole blocks. ``edge_body`` and ``edge_partner`` name what discs and rock have near them else: rock, beam discs and
planes; those of disc i begin at ``edge_row[i]``. A pair is listed while its gap is below the skin; the lists are made anew before
two bodies can have closed a gap of one skin.
"""

import math

from ..common.kernels import inlined, kernel, view
from .declarations import BEAM_DISCS, BEAM_SURFACE, BLOCK, LAYOUT, PART, PLANES, RADIUS, ROW, SUM

V, A = LAYOUT.scalar, LAYOUT.array

SKIN = 0.6
"""Largest gap of a listed pair, in radii of a sand disc; capillary bridges come on top."""


@kernel
def disc_count(k):
    """Number of sand discs N."""
    return k[A.angle + 1]


@kernel
def beam_count(k):
    """Number of beam discs M."""
    return k[A.beam_position_x + 1]


@inlined
def pair_of(i, j):
    """A pair as one number: the begin of its second disc's row in ``body`` above that of the first, 32 bits each."""
    return ROW * i | ROW * j << 32


@inlined
def first_of(pair):
    """The disc of a pair that has the lower number."""
    return (pair & 0xFFFFFFFF) // ROW


@inlined
def second_of(pair):
    """The other disc of a pair."""
    return (pair >> 32) // ROW


@kernel
def part_count(k):
    """Number of parts in use; behind them the room is empty."""
    part, parts = view(k, k, A.part), 1
    while part[parts] < disc_count(k):
        parts += 1
    return parts


@kernel
def divide(k):
    """Divide the discs into parts of equal size, of which small cushions have one. The rest of the room stays empty."""
    n, part = disc_count(k), view(k, k, A.part)
    parts = max(1, n // PART)
    for c in range(part.size):
        part[c] = min(n, n * c // parts)


@kernel
def listed_gap(w):
    """Largest gap (m) of a listed pair."""
    bridge = w[V.cohesion_range] * 2.0 * w[V.disc_radius] * (1.0 + w[V.disc_spread])
    return SKIN * w[V.disc_radius] + (bridge if w[V.cohesion] > 0.0 else 0.0)


@kernel
def boundary_travel(body, reference, n, m):
    """Longest way (m) that the rock or a beam disc has gone since the list was made."""
    longest = 0.0
    for b in range(m + 1):
        dx = body[ROW * (n + b)] - reference[2 * b]
        dy = body[ROW * (n + b) + 1] - reference[2 * b + 1]
        longest = max(longest, dx * dx + dy * dy)
    return math.sqrt(longest)


@kernel
def is_stale(w, x, k):
    """Whether two bodies may have closed a gap of one skin since the list was made."""
    n, m = disc_count(k), beam_count(k)
    travel = view(x, k, A.sums)[SUM.travelled]
    others = boundary_travel(view(x, k, A.body), view(x, k, A.boundary_reference), n, m)
    return 2.0 * max(travel, others) > SKIN * w[V.disc_radius]


@kernel
def sort_into_cells(body, n, cell_start, cell_disc, disc_cell, left, bottom, size, columns, rows):
    """Counting sort of the discs into cells; discs outside the grid count to its rim."""
    for c in range(columns * rows + 1):
        cell_start[c] = 0
    for i in range(n):
        column = min(columns - 1, max(0, int((body[ROW * i] - left) / size)))
        line = min(rows - 1, max(0, int((body[ROW * i + 1] - bottom) / size)))
        disc_cell[i] = line * columns + column
        cell_start[disc_cell[i] + 1] += 1
    for c in range(columns * rows):
        cell_start[c + 1] += cell_start[c]
    for i in range(n - 1, -1, -1):  # backwards, so that a cell lists its discs in ascending order
        cell_start[disc_cell[i] + 1] -= 1
        cell_disc[cell_start[disc_cell[i] + 1]] = i


@kernel
def disc_partners(
    i, lowest, end, body, cell_start, cell_disc, disc_cell, columns, rows, skin, pair, at
):
    """List the discs near disc i whose numbers are at least ``lowest`` and less than ``end``. Returns the end of the list, or -1
    where there is no room."""
    xi, yi, ri = body[ROW * i], body[ROW * i + 1], body[ROW * i + RADIUS]
    line, column = disc_cell[i] // columns, disc_cell[i] % columns
    for near in range(max(0, line - 1), min(rows, line + 2)):
        for c in range(
            near * columns + max(0, column - 1), near * columns + min(columns, column + 2)
        ):
            # after the backwards sort, entry c + 1 of cell_start is the begin of cell c
            for q in range(
                cell_start[c + 1], disc_cell.size if c + 2 > columns * rows else cell_start[c + 2]
            ):
                j = cell_disc[q]
                if lowest <= j < end:
                    dx, dy = body[ROW * j] - xi, body[ROW * j + 1] - yi
                    reach = ri + body[ROW * j + RADIUS] + skin
                    if dx * dx + dy * dy < reach * reach:
                        if at + BLOCK >= pair.size:
                            return -1
                        pair[at] = pair_of(i, j)
                        at += 1
    return at


@kernel
def fill_up(at, first, far, pair):
    """Fill up the last block with pairs that cannot touch. Returns the end of the list."""
    while at % BLOCK:
        pair[at] = pair_of(first, far)
        at += 1
    return at


@kernel
def boundary_partners(i, w, body, n, m, skin, partner, at):
    """List rock, beam discs and planes near disc i, or, for i = N, beam discs and planes near the rock."""
    if at + m + 1 + PLANES > partner.size:
        return -1
    xi, yi, reach = body[ROW * i], body[ROW * i + 1], body[ROW * i + RADIUS] + skin
    for b in range(n if i < n else n + 1, n + m + 1):
        if b > n and w[V.base] != BEAM_DISCS:
            break
        dx, dy, distance = (
            body[ROW * b] - xi,
            body[ROW * b + 1] - yi,
            reach + body[ROW * b + RADIUS],
        )
        if dx * dx + dy * dy < distance * distance:
            partner[at] = b
            at += 1
    if xi - w[V.box_left] < reach:
        partner[at] = n + m + 1
        at += 1
    if w[V.box_left] + w[V.box_width] - xi < reach:
        partner[at] = n + m + 2
        at += 1
    if w[V.base] != BEAM_DISCS and yi - base_top(w, body, n, m) < reach:
        partner[at] = n + m + 3
        at += 1
    return at


@kernel
def base_top(w, body, n, m):
    """Highest point (m) of the base when it is a surface."""
    if w[V.base] != BEAM_SURFACE:
        return w[V.base_y]
    top = -math.inf
    for b in range(n + 1, n + m + 1):
        top = max(top, body[ROW * b + 1] + body[ROW * b + RADIUS])
    return top


@kernel
def inherit(rows, row, partner, spring, row_before, partner_before, spring_before):
    """Give the pairs of a list the springs that they had in the list before."""
    for i in range(rows):
        for p in range(row[i], row[i + 1]):
            spring[p] = 0.0
            for q in range(row_before[i], row_before[i + 1]):
                if partner_before[q] == partner[p]:
                    spring[p] = spring_before[q]
                    break


@kernel
def inherit_pairs(n, spring, spring_before, k):
    """:func:`inherit` for the pairs of discs."""
    pair, before = view(k, k, A.pair), view(k, k, A.pair_before)
    inherit(n, view(k, k, A.row), pair, spring, view(k, k, A.row_before), before, spring_before)
    inherit(
        n, view(k, k, A.across), pair, spring, view(k, k, A.across_before), before, spring_before
    )


@kernel
def inherit_edges(n, spring, spring_before, k):
    """:func:`inherit` for the contacts with all else."""
    inherit(
        n + 1,
        view(k, k, A.edge_row),
        view(k, k, A.edge_partner),
        spring,
        view(k, k, A.edge_row_before),
        view(k, k, A.edge_partner_before),
        spring_before,
    )


@kernel
def forget(x, k):
    """Empty the lists, and with them all contact springs."""
    row, across, edge_row = view(k, k, A.row), view(k, k, A.across), view(k, k, A.edge_row)
    for i in range(row.size):
        row[i], across[i] = 0, 0
    for i in range(edge_row.size):
        edge_row[i] = 0


@kernel
def set_aside(count, source, target):
    """Copy the first ``count`` numbers."""
    for q in range(count):
        target[q] = source[q]


@kernel
def keep_for_inheritance(x, k):
    """Set the present lists aside."""
    n = disc_count(k)
    row, across, edge_row = view(k, k, A.row), view(k, k, A.across), view(k, k, A.edge_row)
    pairs, edges = across[n], edge_row[n + 1]
    set_aside(n + 1, row, view(k, k, A.row_before))
    set_aside(n + 1, across, view(k, k, A.across_before))
    set_aside(n + 2, edge_row, view(k, k, A.edge_row_before))
    set_aside(pairs, view(k, k, A.pair), view(k, k, A.pair_before))
    set_aside(edges, view(k, k, A.edge_partner), view(k, k, A.edge_partner_before))
    set_aside(pairs, view(x, k, A.spring), view(x, k, A.spring_before))
    set_aside(pairs, view(x, k, A.plastic), view(x, k, A.plastic_before))
    set_aside(pairs, view(x, k, A.roll), view(x, k, A.roll_before))
    set_aside(edges, view(x, k, A.edge_spring), view(x, k, A.edge_spring_before))
    set_aside(edges, view(x, k, A.edge_plastic), view(x, k, A.edge_plastic_before))
    set_aside(edges, view(x, k, A.edge_roll), view(x, k, A.edge_roll_before))


@kernel
def list_discs(w, x, k):
    """Make the list of pairs of discs anew. Returns False where the room for it does not suffice."""
    n, m = disc_count(k), beam_count(k)
    body = view(x, k, A.body)
    cell_start, cell_disc, disc_cell = (
        view(k, k, A.cell_start),
        view(k, k, A.cell_disc),
        view(k, k, A.disc_cell),
    )
    skin = listed_gap(w)
    size = 2.0 * w[V.disc_radius] * (1.0 + w[V.disc_spread]) + skin
    bottom = base_top(w, body, n, m) if w[V.base] != BEAM_DISCS else body[ROW * (n + 1) + 1]
    cells = cell_start.size - 1
    columns = min(cells, max(1, int(w[V.box_width] / size)))
    rows = max(1, cells // columns)
    sort_into_cells(
        body,
        n,
        cell_start,
        cell_disc,
        disc_cell,
        w[V.box_left],
        bottom,
        max(size, w[V.box_width] / columns),
        columns,
        rows,
    )
    pair, part = view(k, k, A.pair), view(k, k, A.part)
    parts = part.size - 1
    at = 0
    for between in (False, True):
        row = view(k, k, A.across if between else A.row)
        for c in range(parts):
            for i in range(part[c], part[c + 1]):
                row[i] = at
                if between and part[c + 1] == n:
                    continue  # the last part
                at = disc_partners(
                    i,
                    part[c + 1] if between else i + 1,
                    n if between else part[c + 1],
                    body,
                    cell_start,
                    cell_disc,
                    disc_cell,
                    columns,
                    rows,
                    skin,
                    pair,
                    at,
                )
                if at < 0:
                    return False
            if not between:
                at = fill_up(at, part[c], n + 1 + m + c, pair)
        at = fill_up(at, 0, n + 1 + m, pair)
        row[n] = at
    return True


@kernel
def list_edges(w, x, k):
    """Make the list of all else that discs and rock may touch anew. Returns False where the room for it does not suffice."""
    n, m = disc_count(k), beam_count(k)
    body, edge_row = view(x, k, A.body), view(k, k, A.edge_row)
    owner, partner = view(k, k, A.edge_body), view(k, k, A.edge_partner)
    at = 0
    for i in range(n + 1):
        edge_row[i] = at
        end = boundary_partners(i, w, body, n, m, SKIN * w[V.disc_radius], partner, at)
        if end < 0:
            return False
        for p in range(at, end):
            owner[p] = i
        at = end
    edge_row[n + 1] = at
    return True


@kernel
def rebuild(w, x, k):
    """Make both lists anew. Returns False where the room for them does not suffice."""
    n, m = disc_count(k), beam_count(k)
    keep_for_inheritance(x, k)
    if not list_discs(w, x, k) or not list_edges(w, x, k):
        return False
    inherit_pairs(n, view(x, k, A.spring), view(x, k, A.spring_before), k)
    inherit_edges(n, view(x, k, A.edge_spring), view(x, k, A.edge_spring_before), k)
    if w[V.rolling_resistance] > 0.0:
        inherit_pairs(n, view(x, k, A.roll), view(x, k, A.roll_before), k)
        inherit_edges(n, view(x, k, A.edge_roll), view(x, k, A.edge_roll_before), k)
    if w[V.unloading_ratio] > 1.0:
        inherit_pairs(n, view(x, k, A.plastic), view(x, k, A.plastic_before), k)
        inherit_edges(n, view(x, k, A.edge_plastic), view(x, k, A.edge_plastic_before), k)
    body, reference = view(x, k, A.body), view(x, k, A.boundary_reference)
    for b in range(m + 1):
        reference[2 * b], reference[2 * b + 1] = body[ROW * (n + b)], body[ROW * (n + b) + 1]
    view(x, k, A.sums)[SUM.travelled] = 0.0
    return True
