"""Candidates for contact: a Verlet list made on a grid of cells; contacts survive a rebuild.

There are two lists. ``pair`` names the pairs of discs, see :func:`pair_of`, the lower number first
and in ascending order. The discs are divided into parts, part c from ``part[c]`` on, so that
threads can share the work: the list begins with the pairs within the parts, part by part, those of
disc i from ``row[i]`` on; the pairs between two parts follow, those of disc i from ``across[i]``
on. Each part fills whole blocks. ``edge_body`` and ``edge_partner`` name the boundaries near discs
and rock; those of disc i begin at ``edge_row[i]``. A pair is listed while its gap is below the
skin; the lists are made anew before two bodies can have closed a gap of one skin.
"""

import math
from collections import namedtuple

from ..common.kernels import inlined, kernel, view
from .beam_surface import foot_of
from .bodies import bodies_of, disc_count
from .declarations import BEAM_DISCS, BEAM_SURFACE, BLOCK, LAYOUT, PART, PLANES, ROW, SUM

V, A = LAYOUT.scalar, LAYOUT.array

SKIN = 0.6
"""Largest gap of a listed pair, in radii of a sand disc; capillary bridges come on top."""

Grid = namedtuple("Grid", "left bottom size columns rows cell_start cell_disc disc_cell")
"""Cells over the box: corner (m), side of a cell (m), numbers of columns and rows; begin of each
cell in the list of discs, that list, and the cell of each disc."""


@inlined
def pair_of(i, j):
    """Return a pair as one number.

    The begin of the second disc's row in ``body`` above that of the first, 32 bits each.

    Parameters
    ----------
    i : int
        Disc with the lower number.
    j : int
        Disc with the higher number.

    Returns
    -------
    int
    """
    return ROW * i | ROW * j << 32


@inlined
def first_of(pair):
    """Return the disc of a pair that has the lower number.

    Parameters
    ----------
    pair : int
        The pair.

    Returns
    -------
    int
    """
    return (pair & 0xFFFFFFFF) // ROW


@inlined
def second_of(pair):
    """Return the disc of a pair that has the higher number.

    Parameters
    ----------
    pair : int
        The pair.

    Returns
    -------
    int
    """
    return (pair >> 32) // ROW


@kernel
def part_count(k):
    """Return the number of parts in use; behind them the room is empty.

    Parameters
    ----------
    k : ndarray of int64
        Integers of the instance.

    Returns
    -------
    int
    """
    part = view(k, k, A.part)
    parts = 1
    while parts < part.size - 1 and part[parts] < disc_count(k):
        parts += 1
    return parts


@kernel
def divide(k):
    """Divide the discs into parts of equal size; small cushions have one, and room stays empty.

    Parameters
    ----------
    k : ndarray of int64
        Integers of the instance.
    """
    n, part = disc_count(k), view(k, k, A.part)
    parts = max(1, n // PART)
    for c in range(part.size):
        part[c] = min(n, n * c // parts)


@kernel
def listed_gap(w):
    """Return the largest gap (m) of a listed pair of discs.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        Gap (m).
    """
    skin = SKIN * w[V.disc_radius]
    if w[V.cohesion] > 0.0:
        skin += w[V.cohesion_range] * 2.0 * w[V.disc_radius] * (1.0 + w[V.disc_spread])
    return skin


@inlined
def landmark(b, turning, bodies):
    """Return the point (m) that tells how far the rock or a beam disc has gone.

    Parameters
    ----------
    b : int
        Number of the boundary.
    turning : float
        1 for the top of a disc under a surface, which goes along when the disc turns; 0 for the
        centre of a round body.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    tuple of float
        To the right, and upwards but for a constant.
    """
    return bodies.x[b] - turning * bodies.radius[b] * bodies.angle[b], bodies.y[b]


@inlined
def turning_of(w):
    """Return whether turning beam discs move what the sand lies on: 1 or 0.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
    """
    return 1.0 if w[V.base] == BEAM_SURFACE else 0.0


@inlined
def leverage(w, bodies):
    """Return how much farther than a landmark a beam can go: a surface beyond its last tops.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.

    Returns
    -------
    float
        1 or more.
    """
    first, last = bodies.rock + 1, bodies.end - 1
    if w[V.base] != BEAM_SURFACE or first == last:
        return 1.0
    left, right = bodies.x[first + 1] - bodies.x[first], bodies.x[last] - bodies.x[last - 1]
    return 1.0 + 2.0 * bodies.radius[first] / min(left, right)


@inlined
def travel_of(b, turning, bodies, reference):
    """Return the square of the way (m2) that a landmark has gone since the list was made.

    Parameters
    ----------
    b : int
        Number of the boundary.
    turning : float
        See :func:`landmark`.
    bodies : Bodies
        Columns of all bodies.
    reference : ndarray of float64
        Landmarks when the list was made.

    Returns
    -------
    float
        Square of the way (m2).
    """
    at = 2 * (b - bodies.rock)
    mark_x, mark_y = landmark(b, turning, bodies)
    dx, dy = mark_x - reference[at], mark_y - reference[at + 1]
    return dx * dx + dy * dy


@kernel
def boundary_travel(w, x, k):
    """Return the longest way (m) that the rock or the beam has gone since the list was made.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    float
        Way (m).
    """
    bodies, reference = bodies_of(x, k), view(x, k, A.boundary_reference)
    turning = turning_of(w)
    longest = 0.0
    for b in range(bodies.rock + 1, bodies.end):
        longest = max(longest, travel_of(b, turning, bodies, reference))
    of_rock = travel_of(bodies.rock, 0.0, bodies, reference)
    return max(math.sqrt(of_rock), math.sqrt(longest) * leverage(w, bodies))


@kernel
def is_stale(w, x, k):
    """Return whether two bodies may have closed a gap of one skin since the list was made.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    bool
    """
    travel = view(x, k, A.sums)[SUM.travelled]
    return 2.0 * max(travel, boundary_travel(w, x, k)) > SKIN * w[V.disc_radius]


@kernel
def base_top(w, x, k):
    """Return the highest point (m) of what the sand lies on.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    float
        Height (m).
    """
    if w[V.base] != BEAM_SURFACE and w[V.base] != BEAM_DISCS:
        return w[V.base_y]
    bodies = bodies_of(x, k)
    top = -math.inf
    for b in range(bodies.rock + 1, bodies.end):
        top = max(top, bodies.y[b] + bodies.radius[b])
    return top


@kernel
def grid_over(w, x, k):
    """Return the empty :class:`Grid` over the box, with cells as wide as listed pairs reach.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    Grid
    """
    cell_start, bodies = view(k, k, A.cell_start), bodies_of(x, k)
    size = 2.0 * w[V.disc_radius] * (1.0 + w[V.disc_spread]) + listed_gap(w)
    bottom = bodies.y[bodies.rock + 1]
    if w[V.base] != BEAM_DISCS:
        bottom = base_top(w, x, k)
    cells = cell_start.size - 1
    columns = min(cells, max(1, int(w[V.box_width] / size)))
    return Grid(
        w[V.box_left],
        bottom,
        max(size, w[V.box_width] / columns),
        columns,
        max(1, cells // columns),
        cell_start,
        view(k, k, A.cell_disc),
        view(k, k, A.disc_cell),
    )


@kernel
def sort_into_cells(bodies, grid):
    """Sort the discs into cells by counting; discs outside the grid count to its rim.

    Parameters
    ----------
    bodies : Bodies
        Columns of all bodies.
    grid : Grid
        Cells with the discs in them.
    """
    start, cells = grid.cell_start, grid.columns * grid.rows
    for c in range(cells + 1):
        start[c] = 0
    for i in range(bodies.rock):
        column = min(grid.columns - 1, max(0, int((bodies.x[i] - grid.left) / grid.size)))
        line = min(grid.rows - 1, max(0, int((bodies.y[i] - grid.bottom) / grid.size)))
        cell = line * grid.columns + column
        grid.disc_cell[i] = cell
        start[cell + 1] += 1
    for c in range(cells):
        start[c + 1] += start[c]
    for i in range(bodies.rock - 1, -1, -1):  # backwards: a cell lists its discs in ascending order
        cell = grid.disc_cell[i]
        start[cell + 1] -= 1
        grid.cell_disc[start[cell + 1]] = i


@kernel
def disc_partners(i, within, skin, bodies, grid, pair, at):
    """List the discs near a disc.

    Parameters
    ----------
    i : int
        Number of the disc.
    within : tuple of int
        Lowest number of its partners, and the one behind the highest.
    skin : float
        Largest gap (m) of a listed pair.
    bodies : Bodies
        Columns of all bodies.
    grid : Grid
        The discs sorted into cells.
    pair : ndarray of int64
        The list.
    at : int
        Where the list goes on.

    Returns
    -------
    int
        The end of the list, or -1 where there is no room.
    """
    lowest, end = within
    xi, yi, ri = bodies.x[i], bodies.y[i], bodies.radius[i]
    columns, start = grid.columns, grid.cell_start
    line, column = grid.disc_cell[i] // columns, grid.disc_cell[i] % columns
    left, right = max(0, column - 1), min(columns, column + 2)
    for near in range(max(0, line - 1), min(grid.rows, line + 2)):
        for c in range(near * columns + left, near * columns + right):
            # after the backwards sort, entry c + 1 of cell_start is the begin of cell c
            stop = grid.disc_cell.size
            if c + 2 <= columns * grid.rows:
                stop = start[c + 2]
            for q in range(start[c + 1], stop):
                j = grid.cell_disc[q]
                if lowest <= j < end:
                    dx, dy, reach = bodies.x[j] - xi, bodies.y[j] - yi, ri + bodies.radius[j] + skin
                    if dx * dx + dy * dy < reach * reach:
                        if at + BLOCK >= pair.size:
                            return -1
                        pair[at] = pair_of(i, j)
                        at += 1
    return at


@kernel
def fill_up(at, first, far, pair):
    """Fill up the last block with pairs that cannot touch; returns the end of the list.

    Parameters
    ----------
    at : int
        End of the list.
    first : int
        Any disc.
    far : int
        Body far away.
    pair : ndarray of int64
        List of pairs.

    Returns
    -------
    int
    """
    while at % BLOCK:
        pair[at] = pair_of(first, far)
        at += 1
    return at


@kernel
def list_within(skin, bodies, grid, k):
    """List the pairs within the parts; returns the end of the list, or -1 where room is lacking.

    Parameters
    ----------
    skin : float
        Largest gap of a listed pair (m).
    bodies : Bodies
        Columns of all bodies.
    grid : Grid
        Cells with the discs in them.
    k : ndarray of int64
        Integers of the instance.

    Returns
    -------
    int
    """
    pair, part, row = view(k, k, A.pair), view(k, k, A.part), view(k, k, A.row)
    at = 0
    for c in range(part.size - 1):
        for i in range(part[c], part[c + 1]):
            row[i] = at
            at = disc_partners(i, (i + 1, part[c + 1]), skin, bodies, grid, pair, at)
            if at < 0:
                return -1
        at = fill_up(at, part[c], bodies.end + c, pair)
    at = fill_up(at, 0, bodies.end, pair)
    row[bodies.rock] = at
    return at


@kernel
def list_across(begin, skin, bodies, grid, k):
    """List the pairs between two parts from ``begin`` on; returns the end of the list, or -1.

    Parameters
    ----------
    begin : int
        Where the list begins.
    skin : float
        Largest gap of a listed pair (m).
    bodies : Bodies
        Columns of all bodies.
    grid : Grid
        Cells with the discs in them.
    k : ndarray of int64
        Integers of the instance.

    Returns
    -------
    int
    """
    pair, part, across = view(k, k, A.pair), view(k, k, A.part), view(k, k, A.across)
    n, at = bodies.rock, begin
    for c in range(part.size - 1):
        for i in range(part[c], part[c + 1]):
            across[i] = at
            if part[c + 1] < n:  # the last part has no other behind it
                at = disc_partners(i, (part[c + 1], n), skin, bodies, grid, pair, at)
                if at < 0:
                    return -1
    at = fill_up(at, 0, bodies.end, pair)
    across[n] = at
    return at


@kernel
def list_discs(w, x, k):
    """Make the list of pairs of discs anew; returns False where the room does not suffice.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    bool
    """
    bodies, grid, skin = bodies_of(x, k), grid_over(w, x, k), listed_gap(w)
    sort_into_cells(bodies, grid)
    at = list_within(skin, bodies, grid, k)
    return at >= 0 and list_across(at, skin, bodies, grid, k) >= 0


@kernel
def boundary_partners(i, w, bodies, partner, at):
    """List the boundaries near disc i, or near the rock; returns the end of the list.

    Parameters
    ----------
    i : int
        Number of the disc, or of the rock.
    w : ndarray of float64
        Variables of the instance.
    bodies : Bodies
        Columns of all bodies.
    partner : ndarray of int64
        List of boundaries.
    at : int
        End of the list.

    Returns
    -------
    int
    """
    xi, yi, reach = bodies.x[i], bodies.y[i], bodies.radius[i] + SKIN * w[V.disc_radius]
    last = bodies.end if w[V.base] == BEAM_DISCS else bodies.rock + 1
    first = bodies.rock + 1 if i == bodies.rock else bodies.rock
    for b in range(first, last):
        dx, dy, distance = bodies.x[b] - xi, bodies.y[b] - yi, reach + bodies.radius[b]
        if dx * dx + dy * dy < distance * distance:
            partner[at] = b
            at += 1
    if xi - w[V.box_left] < reach:
        partner[at] = bodies.end
        at += 1
    if w[V.box_left] + w[V.box_width] - xi < reach:
        partner[at] = bodies.end + 1
        at += 1
    height = yi - w[V.base_y]
    if w[V.base] == BEAM_SURFACE:
        height = foot_of(xi, yi, bodies).height
    if w[V.base] != BEAM_DISCS and height < reach:
        partner[at] = bodies.end + 2
        at += 1
    return at


@kernel
def list_edges(w, x, k):
    """Make the list of boundaries anew; returns False where the room does not suffice.

    Parameters
    ----------
    w, x, k : ndarray
        Variables, state and integers of the instance.

    Returns
    -------
    bool
    """
    bodies, row = bodies_of(x, k), view(k, k, A.edge_row)
    owner, partner = view(k, k, A.edge_body), view(k, k, A.edge_partner)
    most = bodies.end - bodies.rock + PLANES
    at = 0
    for i in range(bodies.rock + 1):
        row[i] = at
        if at + most > partner.size:
            return False
        end = boundary_partners(i, w, bodies, partner, at)
        for p in range(at, end):
            owner[p] = i
        at = end
    row[bodies.rock + 1] = at
    return True


@kernel
def inherit(row, partner, spring, row_before, partner_before, spring_before):
    """Give the pairs of a list the springs that they had in the list before.

    Parameters
    ----------
    row : ndarray of int64
        Where the partners of each body begin.
    partner : ndarray of int64
        List of partners.
    spring : ndarray of float64
        Springs, which are set.
    row_before : ndarray of int64
        The same of the list before.
    partner_before : ndarray of int64
        The same of the list before.
    spring_before : ndarray of float64
        The same of the list before.
    """
    for i in range(row.size - 1):
        for p in range(row[i], row[i + 1]):
            spring[p] = 0.0
            for q in range(row_before[i], row_before[i + 1]):
                if partner_before[q] == partner[p]:
                    spring[p] = spring_before[q]
                    break


@kernel
def inherit_pairs(spring, before, k):
    """Do :func:`inherit` for the pairs of discs.

    Parameters
    ----------
    spring : ndarray of float64
        Springs, which are set.
    before : ndarray of float64
        Springs of the list before.
    k : ndarray of int64
        Integers of the instance.
    """
    pair, pair_before = view(k, k, A.pair), view(k, k, A.pair_before)
    row, row_before = view(k, k, A.row), view(k, k, A.row_before)
    across, across_before = view(k, k, A.across), view(k, k, A.across_before)
    inherit(row, pair, spring, row_before, pair_before, before)
    inherit(across, pair, spring, across_before, pair_before, before)


@kernel
def inherit_edges(spring, before, k):
    """Do :func:`inherit` for the contacts with boundaries.

    Parameters
    ----------
    spring : ndarray of float64
        Springs, which are set.
    before : ndarray of float64
        Springs of the list before.
    k : ndarray of int64
        Integers of the instance.
    """
    row, row_before = view(k, k, A.edge_row), view(k, k, A.edge_row_before)
    partner, partner_before = view(k, k, A.edge_partner), view(k, k, A.edge_partner_before)
    inherit(row, partner, spring, row_before, partner_before, before)


@kernel
def forget(x, k):
    """Empty the lists, and with them all contact springs.

    Parameters
    ----------
    x, k : ndarray
        State and integers of the instance.
    """
    row, across, edge_row = view(k, k, A.row), view(k, k, A.across), view(k, k, A.edge_row)
    for i in range(row.size):
        row[i] = 0
        across[i] = 0
    for i in range(edge_row.size):
        edge_row[i] = 0


@kernel
def clear_partners(k):
    """Let every place in the lists of boundaries name one, also those that are not in use."""
    partner, before = view(k, k, A.edge_partner), view(k, k, A.edge_partner_before)
    for p in range(partner.size):
        partner[p] = disc_count(k)
        before[p] = disc_count(k)


@kernel
def set_aside(count, source, target):
    """Copy the first ``count`` numbers.

    Parameters
    ----------
    count : int
        How many.
    source : ndarray
        Read from.
    target : ndarray
        Written to.
    """
    for q in range(count):
        target[q] = source[q]


@kernel
def keep_for_inheritance(x, k):
    """Set the present lists aside.

    Parameters
    ----------
    x, k : ndarray
        State and integers of the instance.
    """
    n = disc_count(k)
    pairs, edges = view(k, k, A.across)[n], view(k, k, A.edge_row)[n + 1]
    for now, before in ((A.row, A.row_before), (A.across, A.across_before)):
        set_aside(n + 1, view(k, k, now), view(k, k, before))
    set_aside(n + 2, view(k, k, A.edge_row), view(k, k, A.edge_row_before))
    set_aside(pairs, view(k, k, A.pair), view(k, k, A.pair_before))
    set_aside(edges, view(k, k, A.edge_partner), view(k, k, A.edge_partner_before))
    for now, before in (
        (A.spring, A.spring_before),
        (A.plastic, A.plastic_before),
        (A.roll, A.roll_before),
    ):
        set_aside(pairs, view(x, k, now), view(x, k, before))
    for now, before in (
        (A.edge_spring, A.edge_spring_before),
        (A.edge_plastic, A.edge_plastic_before),
        (A.edge_roll, A.edge_roll_before),
    ):
        set_aside(edges, view(x, k, now), view(x, k, before))


@kernel
def rebuild(w, x, k):
    """Make both lists anew.

    Parameters
    ----------
    w, x : ndarray of float64
        Parameters and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    bool
        False where the room for them does not suffice.
    """
    keep_for_inheritance(x, k)
    if not list_discs(w, x, k) or not list_edges(w, x, k):
        return False
    inherit_pairs(view(x, k, A.spring), view(x, k, A.spring_before), k)
    inherit_edges(view(x, k, A.edge_spring), view(x, k, A.edge_spring_before), k)
    if w[V.rolling_resistance] > 0.0:
        inherit_pairs(view(x, k, A.roll), view(x, k, A.roll_before), k)
        inherit_edges(view(x, k, A.edge_roll), view(x, k, A.edge_roll_before), k)
    if w[V.unloading_ratio] > 1.0:
        inherit_pairs(view(x, k, A.plastic), view(x, k, A.plastic_before), k)
        inherit_edges(view(x, k, A.edge_plastic), view(x, k, A.edge_plastic_before), k)
    bodies, reference = bodies_of(x, k), view(x, k, A.boundary_reference)
    for b in range(bodies.rock, bodies.end):
        at = 2 * (b - bodies.rock)
        turning = 0.0
        if b > bodies.rock:
            turning = turning_of(w)
        reference[at], reference[at + 1] = landmark(b, turning, bodies)
    view(x, k, A.sums)[SUM.travelled] = 0.0
    return True
