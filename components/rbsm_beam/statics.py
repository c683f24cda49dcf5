"""The beam at rest under its weight, and the largest step its integration can bear."""

import math

from ..compilation import kernel
from ..ports import view
from .chain import END_HINGE, WALL_HINGE, A, deform

POWER_ITERATIONS = 80
"""Each halves the error of the highest mode's shape, and quarters that of its frequency."""


@kernel
def rest(c, x, k):
    """Put the chain at rest in equilibrium with its weight and with the supports where they stand."""
    u, u_rate, v_rate, height = view(x, k, A.u), view(x, k, A.u_rate), view(x, k, A.v_rate), view(x, k, A.support_height)
    for i in range(c.n + 2):
        u[i] = u_rate[i] = v_rate[i] = 0.0
    rise = height[1] - height[0]
    wall, tilt = _redundant_moments(c, rise)
    _deflect(c, wall, tilt, rise, height[0], view(x, k, A.v))


@kernel
def _deflect(c, wall, tilt, rise, height, v):
    """Deflections v from the moments: angles from bar to bar, then heights, from the left support on."""
    n = c.n
    slope = 0.5 * n * tilt / (WALL_HINGE * c.bending * c.spacing) if c.fixed else rise / (n * c.spacing)
    for i in range(n):
        slope -= 0.5 * (_weight_moment(c, i) + wall) * _flexibility(c, i)
    v[1] = height + 0.5 * c.spacing * slope
    for i in range(n - 1):
        slope += (_weight_moment(c, i) + wall + tilt * (0.5 * (n - 1) - i)) * _flexibility(c, i)
        v[i + 2] = v[i + 1] + c.spacing * slope


@kernel
def _weight_moment(c, i):
    """Moment at disc i (from 0) of a simply supported chain under its weight."""
    return 0.5 * c.mass * c.gravity * c.spacing * (c.n * (i + 0.5) - i * (i + 1.0))


@kernel
def _flexibility(c, i):
    """Rotation of the hinge at disc i (from 0) under a unit moment."""
    end = i in (0, c.n - 1)
    return 1.0 / (c.bending * c.spacing * (END_HINGE if c.fixed and end else 1.0))


@kernel
def _redundant_moments(c, rise):
    """What fixed supports add to the moments: a constant, so that both ends stay level under the weight, and the factor of
    n/2 - x/R that holds them level when one support stands higher."""
    if not c.fixed:
        return 0.0, 0.0
    n, stiffness = c.n, c.bending * c.spacing
    turn, lever = 0.0, 0.5 * n * n / WALL_HINGE / stiffness
    for i in range(n):
        arm = 0.5 * (n - 1) - i
        turn += _weight_moment(c, i) * _flexibility(c, i)
        lever += arm * arm * _flexibility(c, i)
    return -turn * stiffness / n, rise / (c.spacing * lever)


@kernel
def stable_step(c, w, x, k):
    """Largest step (s) for which no mode grows, damping included.

    Semi-implicit Euler with the damping force of the old velocity turns a mode of frequency omega and decay rate
    a = drag + viscosity omega2 by lambda2 - (2 - a dt - omega2 dt2) lambda + 1 - a dt = 0; both roots stay in the unit circle for
    dt <= 4 / (a + sqrt(a2 + 4 omega2)). The highest frequency decides.
    """
    omega2 = max(_axial_frequency2(c), _fixed_frequency2(c, w, x, k) if c.fixed else 16.0 * c.bending / (c.mass * c.spacing))
    decay = c.drag + c.viscosity * omega2
    return 4.0 / (decay + math.sqrt(decay * decay + 4.0 * omega2))


@kernel
def _axial_frequency2(c):
    """Square of the highest axial frequency: a chain held at both ends, or at the left one only."""
    factor = 1.0 if c.fixed else math.cos(0.25 * math.pi / c.n)
    return 4.0 * c.axial / c.mass * factor * factor


@kernel
def _fixed_frequency2(c, w, x, k):
    """Square of the highest bending frequency with fixed supports: symmetric and antisymmetric modes apart, as they lie close."""
    return max(_highest_frequency2(c, 1.0, w, x, k), _highest_frequency2(c, -1.0, w, x, k))


@kernel
def _highest_frequency2(c, parity, w, x, k):
    """Power iteration on the chain's own deflections, from the end discs deflected. Overwrites the state."""
    v, moment, height = view(x, k, A.v), view(x, k, A.hinge_moment), view(x, k, A.support_height)
    height[0] = height[1] = 0.0
    for i in range(c.n + 2):
        v[i] = 0.0
    v[1], v[c.n] = 1.0, parity
    quotient = 0.0
    for _ in range(POWER_ITERATIONS):
        deform(c, 1.0, 0.0, w, x, k)
        norm, product = 0.0, 0.0
        for i in range(1, c.n + 1):
            restoring = ((moment[i + 1] + moment[i - 1]) - 2.0 * moment[i]) / (c.spacing * c.mass)
            norm += v[i] * v[i]
            product += v[i] * restoring
            v[i] = restoring
        quotient = product / norm
        for i in range(1, c.n + 1):
            v[i] /= quotient
    return quotient
