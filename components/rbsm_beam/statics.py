"""The beam at rest under all weights, and the largest step its integration can bear."""

import math

from ..common.kernels import kernel, view
from .chain import END_HINGE, WALL_HINGE, A, V, box_share, deform, follow
from .yielding import close_cracks, unslip

POWER_ITERATIONS = 80
"""Number of power iterations.

Each halves the error of the highest mode's shape, and quarters that of its frequency."""


_MOST_ROUNDS = 5_000
"""Of the search for the rest of a section that yields under its weights."""
_AT_REST = 1e-13
"""Part of the largest elastic moment by which plastic ones change in the last round."""


@kernel
def rest(c, w, x, k):
    """Put the chain at rest in equilibrium with its weights, the supports where they stand.

    Parameters
    ----------
    c : Chain
        Constants.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    bool
        Whether there is such a rest: a section that yields may not bear the weights.
    """
    u, u_rate = view(x, k, A.u), view(x, k, A.u_rate)
    v_rate, height = view(x, k, A.v_rate), view(x, k, A.support_height)
    end_rate = view(x, k, A.end_rate)
    end_rate[0] = end_rate[1] = 0.0
    for i in range(c.n + 2):
        u[i] = u_rate[i] = v_rate[i] = 0.0
    load = view(x, k, A.rest_load)
    unslip(x, k)
    for _ in range(_MOST_ROUNDS):
        for i in range(c.n):
            load[i] = _weight(c, i, w, x, k)
        _bear(c, w, x, k)
        _sag(c, load, height[0], height[1] - height[0], 1.0, x, k)
        if not c.yielding or _plastic_change(c, w, x, k) <= _AT_REST:
            return True
    return False


@kernel
def _plastic_change(c, w, x, k):
    """Let the sliders slip from nothing to the present curvature; return how much that changed.

    As a part of the largest elastic moment.
    """
    offset, elastic = view(x, k, A.offset), view(x, k, A.elastic_moment)
    before = view(x, k, A.relief)
    slipped = view(x, k, A.slipped)
    for i in range(c.n + 2):
        before[i] = offset[i]
    for i in range(len(slipped)):
        slipped[i] = 0.0
    close_cracks(x, k)
    follow(c, w, x, k)
    change, largest = 0.0, 0.0
    for i in range(c.n + 2):
        change = max(change, abs(offset[i] - before[i]))
        largest = max(largest, abs(elastic[i]))
    return change / largest if change > 0.0 else 0.0


@kernel
def set_midspan_influence(c, w, x, k):
    """Set the rotation-weighted moments of the elastic beam under a unit load at midspan.

    They are times the length of each hinge over EI (m/(N m)): their sum with EI * plastic
    curvatures is the deflection that those leave at midspan.

    Parameters
    ----------
    c : Chain
        Constants.
    w, x : ndarray of float64
        Variables and state; the displacements are overwritten.
    k : ndarray of int64
        Integer state.
    """
    height, load = view(x, k, A.support_height), view(x, k, A.rest_load)
    for s in range(c.supports):
        height[s] = 0.0
    for i in range(c.n):
        load[i] = 0.0
    load[(c.n - 1) // 2] += 0.5
    load[c.n // 2] += 0.5
    unslip(x, k)
    _bear(c, w, x, k)
    _sag(c, load, 0.0, 0.0, 0.0, x, k)
    follow(c, w, x, k)
    influence, length = view(x, k, A.midspan_influence), view(x, k, A.hinge_length)
    elastic = view(x, k, A.elastic_moment)
    for i in range(c.n + 2):
        influence[i] = elastic[i] * length[i] / (c.bending * c.spacing)
    unslip(x, k)


@kernel
def _sag(c, load, height, rise, plastic, x, k):
    """Set moments and deflections of the chain under loads at rest, its supports where they are.

    Parameters
    ----------
    c : Chain
        Constants.
    load : ndarray of float64, shape (n,)
        On the discs (N, downwards).
    height, rise : float
        Height of the left support, and of the right one above it (m).
    plastic : float
        1 where plastic curvatures count, 0 for the elastic beam.
    x : ndarray of float64
        State.
    k : ndarray of int64
        Integer state.
    """
    moment = view(x, k, A.hinge_moment)
    if c.spring > 0.0:
        left, right = _end_loads(c, load)
        height -= left / c.spring
        rise -= (right - left) / c.spring
        end = view(x, k, A.end_height)
        end[0], end[1] = height, height + rise
    _load_moments(c, load, moment)
    _add_redundant_moments(c, rise, plastic, moment, view(x, k, A.offset))
    _deflect(c, rise, height, plastic, x, k)


@kernel
def _end_loads(c, load):
    """Return what the left and the right support bear of loads at rest (N, downwards)."""
    left, total = 0.0, 0.0
    for i in range(c.n):
        left += load[i] * (c.n - i - 0.5) / c.n
        total += load[i]
    return left, total - left


@kernel
def _bear(c, w, x, k):
    """Take what the inner supports bear from the loads at rest.

    Each bears what its stiffness makes of the way by which the beam without inner supports sinks
    below it and their forces lift the beam again: one equation for each, with the influence of each
    force on each place.
    """
    if c.supports == 2:
        return
    load, v, height = view(x, k, A.rest_load), view(x, k, A.v), view(x, k, A.support_height)
    element, borne = view(w, k, A.support_element), view(x, k, A.reaction)
    influence, unit = view(x, k, A.influence), view(x, k, A.unit_load)
    count = c.supports
    _sag(c, load, height[0], height[1] - height[0], 1.0, x, k)
    for s in range(2, count):
        borne[s] = height[s] - v[int(element[s])]
    for i in range(c.n):
        unit[i] = 0.0
    for s in range(2, count):
        unit[int(element[s]) - 1] = -1.0
        _sag(c, unit, 0.0, 0.0, 0.0, x, k)
        unit[int(element[s]) - 1] = 0.0
        for other in range(2, count):
            influence[other * count + s] = v[int(element[other])]
        influence[s * count + s] += 1.0 / c.bearing
    _solve(count, influence, borne)
    for s in range(2, count):
        load[int(element[s]) - 1] -= borne[s]


@kernel
def _solve(count, matrix, right):
    """Solve the equations of the inner supports, by elimination; the solution is left in right.

    The matrix is symmetric and positive definite, so no rows need to be exchanged.
    """
    for i in range(2, count):
        for row in range(i + 1, count):
            factor = matrix[row * count + i] / matrix[i * count + i]
            for column in range(i, count):
                matrix[row * count + column] -= factor * matrix[i * count + column]
            right[row] -= factor * right[i]
    for back in range(2, count):
        i = count + 1 - back
        for column in range(i + 1, count):
            right[i] -= matrix[i * count + column] * right[column]
        right[i] /= matrix[i * count + i]


@kernel
def _weight(c, i, w, x, k):
    """Return the weight (N) on disc i (from 0) at rest: of its mass and of the cushion."""
    return view(x, k, A.mass)[i] * c.gravity + w[V.cushion_weight] * box_share(c, i, w)


@kernel
def _load_moments(c, load, moment):
    """Set the moments at the discs of a simply supported chain under loads (N, downwards).

    They come from the left reaction, then disc by disc.
    """
    n = c.n
    shear = 0.0
    for i in range(n):
        shear += load[i] * (n - i - 0.5) / n
    moment[1] = 0.5 * c.spacing * shear
    for i in range(n - 1):
        shear -= load[i]
        moment[i + 2] = moment[i + 1] + c.spacing * shear


@kernel
def _deflect(c, rise, height, plastic, x, k):
    """Set the deflections v from the moments: angles from bar to bar, then heights, from the left.

    The first bar's angle is the one with which the last ends at the right support.
    """
    moment, offset, v = view(x, k, A.hinge_moment), view(x, k, A.offset), view(x, k, A.v)
    n = c.n
    slope = rise / (n * c.spacing)
    for i in range(n):
        bent = moment[i + 1] + plastic * offset[i + 1]
        slope -= bent * _flexibility(c, i) * (n - i - 0.5) / n
    v[1] = height + 0.5 * c.spacing * slope
    for i in range(n - 1):
        slope += (moment[i + 1] + plastic * offset[i + 1]) * _flexibility(c, i)
        v[i + 2] = v[i + 1] + c.spacing * slope


@kernel
def _flexibility(c, i):
    """Return the rotation of the hinge at disc i (from 0) under a unit moment (rad/(N m))."""
    end = i in (0, c.n - 1)
    return 1.0 / (c.bending * c.spacing * (END_HINGE if c.fixed and end else 1.0))


@kernel
def _add_redundant_moments(c, rise, plastic, moment, offset):
    """Add the moments of fixed supports: constant + tilt * (n/2 - x/R).

    With them both ends stay level and the right one stands higher by ``rise`` (m). Both are
    orthogonal, as the flexibilities are symmetric. Plastic curvatures turn and lift the ends as
    those of moments do.
    """
    if not c.fixed:
        return
    n, stiffness = c.n, c.bending * c.spacing
    wall = plastic / (WALL_HINGE * stiffness)
    turn = wall * (offset[0] + offset[n + 1])
    lift = wall * (offset[0] - offset[n + 1]) * 0.5 * n
    lever = 0.5 * n * n / WALL_HINGE / stiffness
    for i in range(n):
        arm = 0.5 * (n - 1) - i
        bent = moment[i + 1] + plastic * offset[i + 1]
        turn += bent * _flexibility(c, i)
        lift += bent * _flexibility(c, i) * arm
        lever += arm * arm * _flexibility(c, i)
    tilt = (rise / c.spacing - lift) / lever
    for i in range(n):
        moment[i + 1] += tilt * (0.5 * (n - 1) - i) - turn * stiffness / n


@kernel
def stable_step(c, w, x, k):
    """Return the largest step for which no mode grows, damping included.

    Semi-implicit Euler with the damping force of the old velocity turns a mode of frequency omega
    and decay rate a = drag + viscosity omega2 by

        lambda2 - (2 - a dt - omega2 dt2) lambda + 1 - a dt = 0;

    both roots stay in the unit circle for dt <= 4 / (a + sqrt(a2 + 4 omega2)). The highest
    frequency decides: that of a chain of discs as light as the lightest one, which more mass can
    only lower. It is exact without a box or with one that leaves no disc free. An inner support
    raises its square by no more than its stiffness over that mass. With an end on a spring, the
    row of that end bounds it: the sum of its stiffnesses over its mass, above that of all others.

    Parameters
    ----------
    c : Chain
        Constants.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    float
        Step (s).
    """
    mass = _lightest(c, x, k)
    bending = (
        _fixed_frequency2(c, mass, w, x, k) if c.fixed else 16.0 * c.bending / (mass * c.spacing)
    )
    if c.spring > 0.0:
        bending = (12.0 * c.bending / c.spacing + c.spring) / c.plate
    if c.supports > 2:
        bending += c.bearing / mass
    omega2 = max(_axial_frequency2(c, mass), bending)
    decay = c.drag + c.viscosity * omega2
    return 4.0 / (decay + math.sqrt(decay * decay + 4.0 * omega2))


@kernel
def _lightest(c, x, k):
    """Return the least mass (kg) of a disc."""
    mass = view(x, k, A.mass)
    least = mass[0]
    for i in range(1, c.n):
        least = min(least, mass[i])
    return least


@kernel
def _axial_frequency2(c, mass):
    """Return the square of the highest axial frequency (1/s2).

    The chain is held at both ends, or at the left one only.
    """
    factor = 1.0 if c.fixed else math.cos(0.25 * math.pi / c.n)
    return 4.0 * c.axial / mass * factor * factor


@kernel
def _fixed_frequency2(c, mass, w, x, k):
    """Return the square of the highest bending frequency with fixed supports (1/s2).

    Symmetric and antisymmetric modes are computed apart, as their frequencies lie close.
    """
    return max(
        _highest_frequency2(c, mass, 1.0, w, x, k), _highest_frequency2(c, mass, -1.0, w, x, k)
    )


@kernel
def _highest_frequency2(c, mass, parity, w, x, k):
    """Return the square of the highest bending frequency of the modes of one parity (1/s2).

    Power iteration on the chain's own deflections, which begin with the end discs deflected.
    Overwrites the state.
    """
    v, moment, height = view(x, k, A.v), view(x, k, A.hinge_moment), view(x, k, A.support_height)
    for s in range(c.supports):
        height[s] = 0.0
    for i in range(c.n + 2):
        v[i] = 0.0
    v[1], v[c.n] = 1.0, parity
    quotient = 0.0
    for _ in range(POWER_ITERATIONS):
        deform(c, 1.0, 0.0, w, x, k)
        norm, product = 0.0, 0.0
        for i in range(1, c.n + 1):
            restoring = ((moment[i + 1] + moment[i - 1]) - 2.0 * moment[i]) / (c.spacing * mass)
            norm += v[i] * v[i]
            product += v[i] * restoring
            v[i] = restoring
        quotient = product / norm
        for i in range(1, c.n + 1):
            v[i] /= quotient
    return quotient
