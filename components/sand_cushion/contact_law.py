"""The contact law, for single numbers and for vectors.

Sonoda et al. (1993), sec. 3: a normal spring and dashpot without tension; a tangential spring and
dashpot in series with a Coulomb slider. Beyond the paper, and off by default: rolling resistance,
contacts that do not spring back all the way, capillary bridges.

The normal n points from body 1 to body 2, the tangent is n turned counter-clockwise. Numbers are
floats in kernels and :class:`.vector.lanes.Lanes` in vectors, see :mod:`.arithmetic`.
"""

from collections import namedtuple

from .arithmetic import formula, larger, limited, multiply_add, smaller, where

ROLLING = 2.25
"""Rolling stiffness / (k_n (mu_r R)^2), after Ai et al. (2011), eq. (20); dimensionless."""

Approach = namedtuple("Approach", "overlap opening slip root")
"""How two bodies meet: elastic overlap (m), speed of opening along n (m/s), speed of slip along t
(m/s), root of the mass in the dashpots (kg^0.5)."""

Response = namedtuple("Response", "normal tangential elastic kept spring creep")
"""Forces of a contact: normal force (N, compression is positive), tangential force (N), normal
force of the spring alone (N), tangential spring force before the step that was kept (N; zero where
the contact is open) and after it (N), speed that spring and dashpot take of the slip (m/s)."""

Rolling = namedtuple("Rolling", "moment dissipated elastic")
"""Rolling resistance: moment (N m), energy dissipated in the step and stored after it (J)."""


@formula
def normal_force(touching, elastic, opening, dashpot):
    """Return the force of spring and dashpot side by side, never tension (eq. 1 and fig. 10).

    Parameters
    ----------
    touching : bool or Lanes
        Whether the bodies overlap; there is no force where they do not.
    elastic : float or Lanes
        Force of the spring, k_n times the overlap (N).
    opening : float or Lanes
        Speed of opening (m/s), or that times the root of the mass (kg^0.5 m/s).
    dashpot : float or Lanes
        c_n (N s/m), or c_n divided by the root of the mass.

    Returns
    -------
    float or Lanes
        max(0, k_n d - c_n v_n) (N).
    """
    return larger(where(touching, multiply_add(dashpot, -opening, elastic), 0.0), 0.0)


@formula
def slip_resistance(root, law, dt):
    """Return the force that spring and dashpot put up in a step, per speed of slip.

    Parameters
    ----------
    root : float or Lanes
        Root of the mass in the dashpot (kg^0.5).
    law : Law
        Constants of the kind of contact.
    dt : float or Lanes
        Time step (s).

    Returns
    -------
    float or Lanes
        k_s dt + c_s (N s/m).
    """
    return multiply_add(law.tangential_damping, root, law.tangential * dt)


@formula
def respond(approach, before, resistance, law, dt):
    """Compute the forces of a contact and what becomes of its tangential spring in a step.

    The tangential spring and dashpot stand side by side, in series with a slider that gives way at
    mu times the normal force: T = f + (k_s dt + c_s) v_t, limited to +-mu N, and the spring goes on
    by k_s dt v_e with v_e = (T - f) / (k_s dt + c_s). What exceeds v_e slides.

    Parameters
    ----------
    approach : Approach
        How the bodies meet.
    before : float or Lanes
        Force f of the tangential spring before the step (N).
    resistance : float or Lanes
        :func:`slip_resistance` (N s/m).
    law : Law
        Constants of the kind of contact.
    dt : float or Lanes
        Time step (s).

    Returns
    -------
    Response
        Forces, all zero where the overlap is not positive.
    """
    touching = approach.overlap > 0.0
    elastic = law.unloading * larger(approach.overlap, 0.0)
    normal = normal_force(touching, elastic, approach.root * approach.opening, law.damping)
    kept = where(touching, before, 0.0)
    trial = multiply_add(resistance, approach.slip, kept)
    tangential = limited(trial, law.friction * normal)
    creep = (tangential - kept) / resistance
    spring = multiply_add(law.tangential * dt, creep, kept)
    return Response(normal, tangential, elastic, kept, spring, creep)


@formula
def rolling_response(before, speed, radius, normal, law, dt):
    """Compute the moment of rolling resistance after a step.

    An elastic-plastic spring, type C of Ai et al. (2011) without its viscous part: an elastic
    moment with the stiffness k_r = 2.25 k_n (mu_r R)^2, limited to mu_r R N.

    Parameters
    ----------
    before : float
        Moment before the step (N m).
    speed : float
        Relative angular velocity of the bodies (rad/s).
    radius : float
        Reduced radius R (m).
    normal : float
        Normal force N (N).
    law : Law
        Constants of the kind of contact.
    dt : float
        Time step (s).

    Returns
    -------
    Rolling
        Moment and energies.
    """
    stiffness = ROLLING * law.normal * law.rolling * law.rolling * radius * radius
    trial = before + stiffness * speed * dt
    moment = limited(trial, law.rolling * radius * normal)
    dissipated = (trial - moment) / stiffness * moment
    return Rolling(moment, dissipated, 0.5 * moment * moment / stiffness)


@formula
def permanent_overlap(before, overlap, law):
    """Return the part of the overlap that stays when the contact is unloaded; it never recedes.

    Walton and Braun (1986), fig. 2: loading along k_n, unloading and reloading along the steeper
    K k_n. The force is K k_n (d - p) with p = max(p, d (1 - 1/K)): k_n d on first loading.

    Parameters
    ----------
    before : float or Lanes
        Permanent overlap p before (m).
    overlap : float or Lanes
        Overlap d of the bodies (m).
    law : Law
        Constants of the kind of contact.

    Returns
    -------
    float or Lanes
        Permanent overlap (m).
    """
    return larger(law.yielding * overlap, before)


@formula
def yield_loss(before, now, pull, law):
    """Return the energy lost while the permanent overlap grows, less what the pull does on the way.

    The force along it is k_n d = K k_n (1/K) / (1 - 1/K) p.

    Parameters
    ----------
    before, now : float or Lanes
        Permanent overlap p before and after (m).
    pull : float or Lanes
        Capillary force of the closed bridge (N).
    law : Law
        Constants of the kind of contact.

    Returns
    -------
    float or Lanes
        Energy (J); zero where the permanent overlap did not grow.
    """
    hardening = 0.5 * law.unloading * (1.0 - law.yielding) / law.yielding
    return where(now > before, (now - before) * (hardening * (now + before) - pull), 0.0)


@formula
def bridge_closure(overlap, longest):
    """Return how far a capillary bridge is closed: 1 at contact, 0 where it breaks.

    Parameters
    ----------
    overlap : float or Lanes
        Elastic overlap of the discs (m), negative for a gap.
    longest : float or Lanes
        Gap at which the bridge breaks (m).

    Returns
    -------
    float or Lanes
        Share of the full force, falling linearly while the gap opens.
    """
    return smaller(larger(1.0 + overlap / longest, 0.0), 1.0)


@formula
def capillary_energy(overlap, closure, longest, pull):
    """Return the potential energy of a capillary bridge, zero beyond its longest gap.

    Parameters
    ----------
    overlap : float or Lanes
        Elastic overlap of the discs (m), negative for a gap.
    closure : float or Lanes
        :func:`bridge_closure`.
    longest : float or Lanes
        Gap at which the bridge breaks (m).
    pull : float or Lanes
        Force of the closed bridge (N).

    Returns
    -------
    float or Lanes
        Energy (J), never positive.
    """
    return -pull * (0.5 * longest * closure * closure + larger(overlap, 0.0))
