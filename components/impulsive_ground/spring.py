"""Smith's soil at a toe: an elastic spring of stiffness k = R_u/Q that yields at R_u, pushes only, and is damped by (1 + J v).

A stretch of the toe's way d (m, downwards) from the spring force R (N) and the slack (m, way to where the spring begins to push):
first the slack, then the spring, then sliding at R_u. On the way back the spring unloads to zero and the toe leaves it. Nothing is
stepped in time: a stretch is exact, its work is what the spring has gained and what sliding has taken.
"""

import math

from ..common.kernels import kernel

_ENDLESS = 1e30


@kernel
def press(way, spring, slack, stiffness, ultimate):
    """A stretch ``way`` (m). Returns spring force (N), slack (m), way slid at the ultimate resistance (m), integral of the force
    over the way (J), which is the gain of the spring's energy and what sliding took."""
    if way < 0.0:
        back = spring / stiffness
        if -way >= back:
            return 0.0, slack - way - back, 0.0, -0.5 * spring * back
        end = spring + stiffness * way
        return end, slack, 0.0, 0.5 * (spring + end) * way
    if way <= slack:
        return spring, slack - way, 0.0, 0.0
    way -= slack
    elastic = (ultimate - spring) / stiffness
    if way <= elastic:
        end = spring + stiffness * way
        return end, 0.0, 0.0, 0.5 * (spring + end) * way
    slid = way - elastic
    return ultimate, 0.0, slid, 0.5 * (spring + ultimate) * elastic + ultimate * slid


@kernel
def mean_force(way, spring, slack, stiffness, ultimate):
    """Mean of the spring force (N) over a stretch (m). It never falls as the stretch grows."""
    if way == 0.0:
        return spring
    _, _, _, area = press(way, spring, slack, stiffness, ultimate)
    return area / way


@kernel
def relax(left, load, impedance, damping, spring, slack, stiffness, ultimate):
    """The next piece of at most ``left`` (s) of the toe's motion under the load c - Z v (c: N, Z: N s/m), massless:
    R + D v = c - Z v while the spring pushes. damping: D (N s/m).

    Returns time (s), way (m) and integral of v2 over the piece (m2/s).
    """
    if spring <= 0.0 and (slack > 0.0 or load <= 0.0):
        v = load / impedance
        time = slack / v if v > 0.0 else _ENDLESS
        return min(left, time), v * min(left, time), v * v * min(left, time)
    total = impedance + damping
    if spring >= ultimate and load >= ultimate:
        v = (load - ultimate) / total
        return left, v * left, v * v * left
    rate = stiffness / total
    time = left
    if load > ultimate:
        time = min(left, math.log((load - spring) / (load - ultimate)) / rate)
    elif load < 0.0:
        time = min(left, math.log((spring - load) / -load) / rate)
    v = (load - spring) / total
    return (
        time,
        -v * math.expm1(-rate * time) / rate,
        -0.5 * v * v * math.expm1(-2.0 * rate * time) / rate,
    )
