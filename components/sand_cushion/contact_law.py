"""The contact law of Sonoda et al. (1993), sec. 3: normal spring and dashpot without tension, tangential spring and dashpot in
series with a Coulomb slider. Beyond the paper, and off by default: rolling resistance, contacts that do not spring back all the
way, capillary bridges.

All functions work on one contact. The normal points from body 1 to body 2; the tangent is the normal turned counter-clockwise.
"""

from ..common.kernels import inlined


@inlined
def normal_force(overlap, opening_speed, stiffness, dashpot):
    """Compressive force (N): k_n * overlap - c_n * opening speed, never tension (eq. 1 and fig. 10)."""
    return max(0.0, stiffness * overlap - dashpot * opening_speed)


@inlined
def tangential_force(spring, slip_speed, stiffness, dashpot, limit, dt):
    """Tangential force and what becomes of its spring over a step dt (s).

    Spring (force ``spring`` before the step, N) and dashpot stand side by side, in series with a slider that gives way at
    ``limit`` = mu * normal force (N). Returns the force (N), the new spring force (N) and the part of the relative speed
    that spring and dashpot take (m/s); the rest of it slides.
    """
    rate = stiffness * dt + dashpot
    force = min(limit, max(-limit, spring + rate * slip_speed))
    taken = (force - spring) / rate
    return force, spring + stiffness * dt * taken, taken


@inlined
def rolling_moment(moment, rolling_speed, stiffness, limit, dt):
    """Rolling resistance after a step dt (s): an elastic moment (N m) that gives way at ``limit`` (N m).

    Elastic-plastic spring, type C of Ai et al. (2011) without its viscous part. Returns the moment and the energy lost (J).
    """
    trial = moment + stiffness * rolling_speed * dt
    clipped = min(limit, max(-limit, trial))
    return clipped, (trial - clipped) / stiffness * clipped


@inlined
def permanent_overlap(before, overlap, share):
    """Part of the overlap (m) that stays when the contact is unloaded; it never recedes.

    Walton and Braun (1986), fig. 2: loading along k_n, unloading and reloading along the steeper ``unloading`` = k_n / (1 - share):
    the force is unloading * (overlap - permanent), which on first loading is k_n * overlap.
    """
    return max(before, share * overlap)


@inlined
def capillary_pull(pressed, pull, bridge):
    """Attraction (N) by a capillary bridge: ``pull`` while the discs are pressed together (``pressed`` > 0, m), falling to nothing
    while the gap -pressed opens to ``bridge`` (m)."""
    return pull * min(1.0, max(0.0, 1.0 + pressed / bridge))


@inlined
def capillary_energy(pressed, pull, bridge):
    """Potential energy (J) of :func:`capillary_pull`, zero beyond the longest bridge."""
    closed = min(1.0, max(0.0, 1.0 + pressed / bridge))
    return -pull * (0.5 * bridge * closed * closed + max(0.0, pressed))


@inlined
def yield_loss(before, now, unloading, share, pull):
    """Energy (J) lost while the permanent overlap grows from ``before`` to ``now`` (m), less what the pull does on this way.

    The force along it is k_n overlap = unloading (1 - share) / share * permanent.
    """
    return (now - before) * (0.5 * unloading * (1.0 - share) / share * (now + before) - pull)
