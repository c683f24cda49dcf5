"""The contact law of Sonoda et al. (1993), sec. 3: normal spring and dashpot without tension, tangential spring and dashpot in
series with a Coulomb slider, rolling resistance.

All functions work on one contact. The normal points from body 1 to body 2; the tangent is the normal turned counter-clockwise.
"""

from ..compilation import inlined


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
