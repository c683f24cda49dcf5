"""A section that yields: sliders in parallel at each hinge, for a moment-curvature line of corners.

Slider j is a spring with the part ``share`` of EI. It slips where the elastic moment, EI times its
own curvature, exceeds its ``limit``; the rest of EI never slips. A first slider that cracks
unloads to the origin instead, on either side from the largest moment there. Curvatures are counted
as elastic moments, EI times them (N m). Hidden arrays, n discs, 0 and n + 1 for the hinges at the
walls:

* ``slider.share`` (1), ``slider.limit`` and ``slider.hogging_limit`` (N m, at growing and falling
  curvature), shape (SLIDERS);
* ``last_corner``: elastic moment of the last corner, sagging and hogging (N m);
* ``cracked.below``, ``cracked.above``, shape (n + 2): largest elastic moment so far, sagging and
  hogging (N m), from the limit of the first slider on, where that one cracks;
* ``slipped``, shape (SLIDERS, n + 2): EI * curvature by which each slider has slipped (N m);
* ``hinge.length``, shape (n + 2): length of beam that bends in each hinge, in units of R;
* ``elastic_moment``: EI * curvature (N m); ``moment_rate``: its rate (N m/s);
* ``offset``: what the slipped sliders take from the elastic moment (N m), EI * plastic curvature;
* ``above``, ``below``: part of EI that slips when the curvature grows, and when it falls;
* ``relief``: what is taken from the elastic moment in the present shape (N m).
"""

from ..common.kernels import kernel, view
from .declarations import LAYOUT, SLIDERS

V, A = LAYOUT.scalar, LAYOUT.array

_ROUNDING = 1e-9
"""Slopes that rise by less than this part of EI from one corner to the next are equal."""


@kernel
def set_sliders(w, x, k):
    """Set shares and limits of the sliders from the corners of the moment-curvature line.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    bool
        Whether moments and curvatures rise, and slopes fall, from corner to corner.
    """
    share, limit = view(x, k, A.slider_share), view(x, k, A.slider_limit)
    hogging = view(x, k, A.slider_hogging_limit)
    for j in range(SLIDERS):
        share[j] = limit[j] = hogging[j] = 0.0
    first = w[V.section_corner1_moment]
    second, third = w[V.section_corner2_moment], w[V.section_corner3_moment]
    curvature2, curvature3 = w[V.section_corner2_curvature], w[V.section_corner3_curvature]
    paired = (second > 0.0) == (curvature2 > 0.0) and (third > 0.0) == (curvature3 > 0.0)
    if first <= 0.0 or not paired or (third > 0.0 and second == 0.0):
        return False
    stiffness = w[V.elastic_modulus] * w[V.section_second_moment]
    limit[0], limit[1], limit[2] = first, stiffness * curvature2, stiffness * curvature3
    corners = 1 + int(second > 0.0) + int(third > 0.0)
    falls = _share_slopes(
        corners, second - first, third - second, w[V.section_hardening_ratio], x, k
    )
    return falls and _set_hogging(corners, stiffness, w, x, k)


@kernel
def _set_hogging(corners, stiffness, w, x, k):
    """Set the limits at falling curvature, and the last corners; tell whether moments rise."""
    limit, hogging = view(x, k, A.slider_limit), view(x, k, A.slider_hogging_limit)
    last, share = view(x, k, A.last_corner), view(x, k, A.slider_share)
    first = w[V.section_corner1_hogging_moment]
    second, third = w[V.section_corner2_hogging_moment], w[V.section_corner3_hogging_moment]
    if first == 0.0 and second == 0.0 and third == 0.0:
        for j in range(SLIDERS):
            hogging[j] = limit[j]
    else:
        paired = (second > 0.0) == (corners > 1) and (third > 0.0) == (corners > 2)
        if first <= 0.0 or not paired:
            return False
        hogging[0], slope = first, 1.0
        for j in range(1, corners):
            rise = second - first if j == 1 else third - second
            slope -= share[j - 1]
            flat = slope <= _ROUNDING
            if rise < 0.0 or (flat and rise > _ROUNDING * first):
                return False
            hogging[j] = hogging[j - 1] + (limit[j] - limit[j - 1] if flat else rise / slope)
    last[0], last[1] = limit[corners - 1], hogging[corners - 1]
    if w[V.section_corner_hogging_curvature] > 0.0:
        last[1] = stiffness * w[V.section_corner_hogging_curvature]
    return True


@kernel
def _share_slopes(corners, second_rise, third_rise, hardening, x, k):
    """Give each slider the fall of the slope (part of EI) at its corner; tell whether all fall.

    ``second_rise`` and ``third_rise`` are those of the moment between two corners (N m).
    """
    share, limit = view(x, k, A.slider_share), view(x, k, A.slider_limit)
    slope = 1.0
    for j in range(corners):
        after = hardening
        if j < corners - 1:
            rise = second_rise if j == 0 else third_rise
            if rise < 0.0 or limit[j + 1] <= limit[j]:
                return False
            after = rise / (limit[j + 1] - limit[j])
        share[j] = slope - after
        if share[j] < -_ROUNDING:
            return False
        share[j] = max(0.0, share[j])
        slope = after
    return True


@kernel
def set_lengths(c, wall, end, x, k):
    """Set the lengths of beam that bend in the hinges, in units of R.

    Parameters
    ----------
    c : Chain
        Constants.
    wall, end : float
        Stiffness of the hinges at a fixed support and at the disc next to it, in units of EI/R.
    x : ndarray of float64
        State.
    k : ndarray of int64
        Integer state.
    """
    length = view(x, k, A.hinge_length)
    for i in range(c.n + 2):
        length[i] = 1.0
    length[0] = length[c.n + 1] = 1.0 / wall
    if c.fixed:
        length[1] = length[c.n] = 1.0 / end


@kernel
def unslip(x, k):
    """Put all sliders back to where they were before anything yielded."""
    for name in (A.slipped, A.offset, A.above, A.below, A.relief):
        values = view(x, k, name)
        for i in range(len(values)):
            values[i] = 0.0
    close_cracks(x, k)


@kernel
def close_cracks(x, k):
    """Put the first slider of all hinges back to where it was before anything cracked."""
    below, above = view(x, k, A.cracked_below), view(x, k, A.cracked_above)
    limit, hogging = view(x, k, A.slider_limit)[0], view(x, k, A.slider_hogging_limit)[0]
    for i in range(len(below)):
        below[i], above[i] = limit, hogging


@kernel
def slip(c, w, x, k):
    """Let the sliders follow the curvature in ``elastic_moment``; count what they dissipate.

    A slider that has followed stays where it is when it is asked again, to the bit, so this may be
    called at any time.

    Parameters
    ----------
    c : Chain
        Constants.
    w, x : ndarray of float64
        Variables and state; ``energy.plastic`` is brought up to date.
    k : ndarray of int64
        Integer state.
    """
    offset, above, below = view(x, k, A.offset), view(x, k, A.above), view(x, k, A.below)
    for i in range(c.n + 2):
        offset[i] = above[i] = below[i] = 0.0
    share, limit = view(x, k, A.slider_share), view(x, k, A.slider_limit)
    hogging = view(x, k, A.slider_hogging_limit)
    total = 0.0
    for j in range(SLIDERS):
        if share[j] > 0.0:
            if c.cracking and j == 0:
                total += share[j] * _crack(c, share[j], limit[j], hogging[j], x, k)
            else:
                way = _slip_one(c, j, share[j], limit[j], hogging[j], x, k)
                total += share[j] * limit[j] * way
    w[V.energy_plastic] += total / (c.bending * c.spacing)


@kernel
def _slip_one(c, j, share, limit, hogging, x, k):
    """Let slider j of every hinge follow; return the sum of the ways, each times its length.

    A way at the hogging limit counts by that limit over the other.
    """
    elastic, length = view(x, k, A.elastic_moment), view(x, k, A.hinge_length)
    offset, above, below = view(x, k, A.offset), view(x, k, A.above), view(x, k, A.below)
    n = c.n + 2
    slipped = view(x, k, A.slipped)[j * n : (j + 1) * n]
    total = 0.0
    for i in range(n):
        least, most = elastic[i] - limit, elastic[i] + hogging
        now = min(max(slipped[i], least), most)
        weight = 1.0 if now > slipped[i] else hogging / limit
        total += weight * abs(now - slipped[i]) * length[i]
        slipped[i] = now
        offset[i] += share * now
        above[i] += share if now <= least else 0.0
        below[i] += share if now >= most else 0.0
    return total


@kernel
def _crack(c, share, limit, hogging, x, k):
    """Let the first slider of every hinge crack; return what that dissipates.

    It is half of the limit times the growth of the largest moment, times the length: what a spring
    loses that follows a horizontal line and comes back to the origin.
    """
    elastic, length = view(x, k, A.elastic_moment), view(x, k, A.hinge_length)
    offset, above, below = view(x, k, A.offset), view(x, k, A.above), view(x, k, A.below)
    sagging, risen = view(x, k, A.cracked_below), view(x, k, A.cracked_above)
    slipped = view(x, k, A.slipped)
    total = 0.0
    for i in range(c.n + 2):
        sags = elastic[i] >= 0.0
        largest = sagging if sags else risen
        bound = limit if sags else hogging
        size = abs(elastic[i])
        grown = max(size - largest[i], 0.0)
        largest[i] = max(largest[i], size)
        total += 0.5 * bound * grown * length[i]
        lost = 1.0 - bound / largest[i]
        slipped[i] = elastic[i] * lost
        offset[i] += share * slipped[i]
        opens = size >= largest[i]
        above[i] += share if opens and sags else share * lost
        below[i] += share if opens and not sags else share * lost
    return total


@kernel
def relieve(c, displacement_factor, rate_factor, x, k):
    """Set what sliders take from the elastic moments of a shape, as :func:`.chain.deform` has it.

    Of the part of a moment that comes from rates, those take theirs away that slip now: a dashpot
    stands beside the spring of each slider, and what slips does not damp.

    Parameters
    ----------
    c : Chain
        Constants.
    displacement_factor, rate_factor : float
        Of the shape; ``moment_rate`` is only looked at where the second is not 0.
    x : ndarray of float64
        State.
    k : ndarray of int64
        Integer state.
    """
    offset, relief = view(x, k, A.offset), view(x, k, A.relief)
    for i in range(c.n + 2):
        relief[i] = displacement_factor * offset[i]
    if rate_factor == 0.0:
        return
    rate, above, below = view(x, k, A.moment_rate), view(x, k, A.above), view(x, k, A.below)
    for i in range(c.n + 2):
        slips = above[i] if rate[i] > 0.0 else below[i]
        relief[i] += rate_factor * slips * rate[i]


@kernel
def rate_energy(c, x, k):
    """Return half the power (W) that a viscosity of 1 s takes in the hinges, at ``moment_rate``."""
    rate, length = view(x, k, A.moment_rate), view(x, k, A.hinge_length)
    above, below = view(x, k, A.above), view(x, k, A.below)
    total = 0.0
    for i in range(c.n + 2):
        slips = above[i] if rate[i] > 0.0 else below[i]
        total += (1.0 - slips) * rate[i] * rate[i] * length[i]
    return 0.5 * total / (c.bending * c.spacing)


@kernel
def locked_and_elastic_energy(c, x, k):
    """Return the energy in the springs of the hinges (J): of all sliders and of what never slips.

    What hardening locks in, and unloading does not give back, is in it. A cracked slider is a
    spring from the origin.
    """
    elastic, length = view(x, k, A.elastic_moment), view(x, k, A.hinge_length)
    share = view(x, k, A.slider_share)
    n = c.n + 2
    rest, total = 1.0, 0.0
    for j in range(SLIDERS):
        rest -= share[j]
        slipped = view(x, k, A.slipped)[j * n : (j + 1) * n]
        for i in range(n):
            stretch = elastic[i] - slipped[i]
            way = elastic[i] if c.cracking and j == 0 else stretch
            total += share[j] * length[i] * stretch * way
    for i in range(n):
        total += rest * length[i] * elastic[i] * elastic[i]
    return 0.5 * total / (c.bending * c.spacing)


@kernel
def residual_deflection(c, x, k):
    """Return the deflection of the midspan (m, downwards) that the slipped sliders leave.

    By virtual work: rotations that stay through the moments under a unit load at midspan.
    """
    influence = view(x, k, A.midspan_influence)
    total = 0.0
    for i in range(c.n + 2):
        total += influence[i] * permanent(c, i, x, k)
    return total


@kernel
def permanent(c, i, x, k):
    """Return EI times the curvature that hinge i keeps without a moment (N m)."""
    offset = view(x, k, A.offset)[i]
    if not c.cracking:
        return offset
    share, limit = view(x, k, A.slider_share)[0], view(x, k, A.slider_limit)[0]
    kept = offset - share * view(x, k, A.slipped)[i]
    largest = view(x, k, A.cracked_below)[i]
    if kept < 0.0:
        limit, largest = view(x, k, A.slider_hogging_limit)[0], view(x, k, A.cracked_above)[i]
    return kept / (1.0 - share * (1.0 - limit / largest))


@kernel
def curvature_ratio(c, x, k):
    """Return the largest present curvature over that of the last corner on its side."""
    elastic, last = view(x, k, A.elastic_moment), view(x, k, A.last_corner)
    sagging, hogging = 0.0, 0.0
    for i in range(c.n + 2):
        sagging, hogging = max(sagging, elastic[i]), max(hogging, -elastic[i])
    return max(sagging / last[0], hogging / last[1])
