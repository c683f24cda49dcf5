"""Segments of equal travel time from sections, and what follows from them.

That is masses, springs and the limits of the step.
"""

import math

from ..common.kernels import kernel, view
from .declarations import (
    CHARACTERISTICS,
    DOWN,
    FIXED,
    LAYOUT,
    PORT,
    REFLECTION,
    REPAIRED,
    SEQUENTIAL,
    SMITH,
    SOIL,
    WAVES,
)

V, A = LAYOUT.scalar, LAYOUT.array

UNBOUNDED = 1e6
"""Step (s) that is published where nothing limits it."""
_EQUAL = 1e-9
"""Impedances that differ by less than this part are equal."""


@kernel
def divide(w, x, k):
    """Set travel time of the rod, impedance and area of each segment.

    The rod is divided in equal travel times, not lengths. The impedance of a segment is the mean
    over its travel time: its mass is then that of the rod there.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    float
        Travel time of one segment (s).
    """
    length, modulus = view(w, k, A.section_length), view(w, k, A.section_modulus)
    density = view(w, k, A.section_density)
    n = k[A.impedance + 1]
    sections = len(length)
    total = 0.0
    for s in range(sections):
        total += length[s] * math.sqrt(density[s] / modulus[s])
    w[V.travel_time] = total
    dt = total / n
    impedance, area = view(x, k, A.impedance), view(x, k, A.cell_area)
    for i in range(n):
        impedance[i], area[i] = _mean(i * dt, (i + 1) * dt, w, k)
    return dt


@kernel
def _mean(begin, end, w, k):
    """Return mean impedance (N s/m) and area (m2) between two travel times (s) from the head."""
    length, area = view(w, k, A.section_length), view(w, k, A.section_area)
    modulus, density = view(w, k, A.section_modulus), view(w, k, A.section_density)
    top, shared, impedances, areas, last = 0.0, 0.0, 0.0, 0.0, len(length) - 1
    for s in range(len(length)):
        bottom = top + length[s] * math.sqrt(density[s] / modulus[s])
        part = min(bottom, end) - max(top, begin)
        if part > 0.0:
            shared += part
            impedances += part * area[s] * math.sqrt(modulus[s] * density[s])
            areas += part * area[s]
        top = bottom
    if shared <= 0.0:
        return area[last] * math.sqrt(modulus[last] * density[last]), area[last]
    return impedances / shared, areas / shared


@kernel
def rod_length(w, k):
    """Return the length of the rod (m)."""
    length = view(w, k, A.section_length)
    total = 0.0
    for s in range(len(length)):
        total += length[s]
    return total


@kernel
def gauge_segment(w, k):
    """Return the segment (from 0) in which the gauge is.

    The length of the rod above the gauge is counted through the sections.
    """
    length, modulus = view(w, k, A.section_length), view(w, k, A.section_modulus)
    density = view(w, k, A.section_density)
    left, time = w[V.gauge_depth], 0.0
    for s in range(len(length)):
        part = min(left, length[s])
        time += part * math.sqrt(density[s] / modulus[s])
        left -= part
    n = k[A.impedance + 1]
    return min(n - 1, max(0, int(time / w[V.travel_time] * n + _EQUAL)))


@kernel
def below_toe(w, x, k):
    """Return the impedance (N s/m) of the rod that stands for the ground; 0 if there is none.

    It is (1 - alpha)/(1 + alpha) times that of the toe, with alpha the reflection at the toe.
    """
    if w[V.toe_condition] != REFLECTION or toe_is_fixed(w):
        return 0.0
    impedance = view(x, k, A.impedance)
    alpha = w[V.toe_reflection]
    return (1.0 - alpha) / (1.0 + alpha) * impedance[len(impedance) - 1]


@kernel
def lump(dt, w, x, k):
    """Set masses and springs of the chain: springs Z/dt, masses Z dt.

    Both are critical at the travel time dt of a segment. Smith counts the mass of a segment at its
    lower end, below its spring; the repaired scheme gives an interface the mean of the masses on
    its two sides. Node 0 is the ram, or without one half a segment.

    Parameters
    ----------
    dt : float
        Travel time of a segment (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    impedance, mass, spring = view(x, k, A.impedance), view(x, k, A.mass), view(x, k, A.spring)
    n = len(impedance)
    ground = k[A.mass + 1] - k[A.impedance + 1] - 1
    below = below_toe(w, x, k)
    repaired = w[V.scheme] == REPAIRED
    rod = below > 0.0 and w[V.scheme] != SMITH
    mass[0] = w[V.ram_mass] if w[V.ram_mass] > 0.0 else 0.5 * impedance[0] * dt
    for i in range(1, n + 1):
        spring[i - 1], mass[i] = impedance[i - 1] / dt, impedance[i - 1] * dt
        if repaired:
            mass[i] = 0.5 * dt * (impedance[i - 1] + (impedance[i] if i < n else below))
    spring[n] = below / dt
    for i in range(n + 1, n + ground + 1):
        spring[i], mass[i] = below / dt, below * dt
    last = n
    if rod:
        last = n + ground
        spring[last], mass[last] = 0.0, 0.5 * below * dt
    elif toe_is_fixed(w):
        last = n - 1
    view(k, k, A.free)[2] = last


@kernel
def stable_limit(dt, w, x, k):
    """Return the largest stable internal step of masses and springs, by Gershgorin's circles.

    In a uniform chain the bound is exact: 2/omega = dx/c. The same holds at the toe: a spring kappa
    times as stiff below it leaves the critical step up to kappa = 2, a rod kappa times as heavy up
    to kappa = 1, or any with the repaired mass.

    Parameters
    ----------
    dt : float
        Travel time of a segment (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    float
        Step (s); UNBOUNDED if the critical one is stable.
    """
    if w[V.scheme] == CHARACTERISTICS:
        return UNBOUNDED
    mass, spring = view(x, k, A.mass), view(x, k, A.spring)
    last = view(k, k, A.free)[2]
    shaft, quake = view(w, k, A.shaft_resistance), view(w, k, A.shaft_quake)
    n = k[A.impedance + 1]
    highest = 0.0
    for i in range(last + 1):
        above = spring[i - 1] if i > 0 else 0.0
        below = spring[i]
        row = 2.0 * (above + below) / mass[i] if i < last else (2.0 * above + below) / mass[i]
        if 0 < i <= n:
            row += shaft[i - 1] / quake[i - 1] / mass[i]
        if i == n and w[V.toe_condition] == SOIL:
            row += w[V.toe_resistance] / w[V.toe_quake] / mass[i]
        highest = max(highest, row)
    limit = 2.0 / math.sqrt(highest)
    return UNBOUNDED if limit >= dt * (1.0 - _EQUAL) else limit


@kernel
def find_free_stretches(w, x, k):
    """Count the segments from head and toe through which waves travel without reflection."""
    impedance, shaft = view(x, k, A.impedance), view(w, k, A.shaft_resistance)
    free = view(k, k, A.free)
    n = len(impedance)
    free[0], free[1] = 1, 1
    while (
        free[0] < n
        and shaft[free[0] - 1] == 0.0
        and _equal(impedance[free[0] - 1], impedance[free[0]])
    ):
        free[0] += 1
    while (
        free[1] < n
        and shaft[n - free[1] - 1] == 0.0
        and _equal(impedance[n - free[1]], impedance[n - free[1] - 1])
    ):
        free[1] += 1
    if shaft[n - 1] > 0.0:
        free[1] = 0


@kernel
def _equal(one, other):
    return abs(one - other) <= _EQUAL * one


@kernel
def publish_limits(dt, w, x, k):
    """Write the impedances at the ends and the longest communication steps.

    Parameters
    ----------
    dt : float
        Travel time of a segment (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    impedance, free = view(x, k, A.impedance), view(k, k, A.free)
    w[V.head_impedance], w[V.toe_impedance] = impedance[0], impedance[len(impedance) - 1]
    share = 1.0 if w[V.exchange] == SEQUENTIAL else 0.5
    if w[V.head_port] == WAVES:
        w[V.head_step_limit] = share * free[0] * dt
    else:
        w[V.head_step_limit] = plain_limit(
            w[V.head_impedance], w[V.head_partner_stiffness], w[V.head_partner_mass]
        )
    w[V.toe_step_limit] = UNBOUNDED
    if w[V.toe_condition] == PORT:
        w[V.toe_step_limit] = (
            share * free[1] * dt
            if w[V.toe_port] == WAVES
            else plain_limit(w[V.toe_impedance], w[V.toe_partner_stiffness], 0.0)
        )
    w[V.step_limit] = min(w[V.head_step_limit], w[V.toe_step_limit])


@kernel
def plain_limit(impedance, stiffness, mass):
    """Return the longest step of a port that takes force and gives kinematics.

    Parameters
    ----------
    impedance : float
        Z of the rod at the port (N s/m).
    stiffness, mass : float
        Spring k (N/m) or rigid mass M (kg) that acts there; 0 if there is none.

    Returns
    -------
    float
        Z/k for a spring, M/Z for a mass (s); UNBOUNDED for neither.
    """
    limit = UNBOUNDED
    if stiffness > 0.0:
        limit = min(limit, impedance / stiffness)
    if mass > 0.0:
        limit = min(limit, mass / impedance)
    return limit


@kernel
def head_sign(w):
    """Return 1 where the head's port counts downwards, -1 where upwards."""
    return 1.0 if w[V.head_direction] == DOWN else -1.0


@kernel
def toe_is_fixed(w):
    """Return whether the toe does not move."""
    return w[V.toe_condition] == FIXED or (
        w[V.toe_condition] == REFLECTION and w[V.toe_reflection] == -1.0
    )
