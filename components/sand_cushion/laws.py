"""Constants of the contact law for each kind of contact, and the stable step that follows."""

import math

from ..common.kernels import inlined, kernel, view
from .contact_law import ROLLING
from .declarations import (
    BEAM_DISCS,
    FLOOR,
    FREE,
    INDEX,
    KIND,
    LAW,
    LAYOUT,
    RANDOM,
    ROUND,
    Law,
)
from .packing import disc_mass

V, A = LAYOUT.scalar, LAYOUT.array


@inlined
def law_of(kind, root, table):
    """Return the constants of a kind of contact, its dashpots times a root of mass (kg^0.5).

    Parameters
    ----------
    kind : int
        Kind of the contact, one of :data:`KIND`.
    root : float
        Root of mass (kg^0.5).
    table : ndarray of float64
        Laws of all kinds.

    Returns
    -------
    Law
        Constants of the contact.
    """
    at = kind * len(LAW) & INDEX
    return Law(
        table[at],
        table[at + LAW.damping] * root,
        table[at + LAW.tangential],
        table[at + LAW.tangential_damping] * root,
        table[at + LAW.friction],
        table[at + LAW.rolling],
        table[at + LAW.unloading],
        table[at + LAW.yielding],
        table[at + LAW.pull],
        table[at + LAW.bridge],
        table[at + LAW.compliance],
    )


@kernel
def set_law(kind, stiffness, friction, w, law):
    """Set the constants of a kind of contact, eq. (1): c = 2 h sqrt(m k), k_s = s k_n.

    Contacts of sand may yield, those of the rock with base and walls do not.

    Parameters
    ----------
    kind : int
        One of :data:`KIND`.
    stiffness : float
        k_n (N/m).
    friction : float
        Angle of friction (rad).
    w : ndarray of float64
        Parameters.
    law : ndarray of float64
        Table of constants, :data:`LAW` for each kind.
    """
    at = kind * len(LAW)
    of_sand = kind != KIND.rock_base and kind != KIND.rock_wall
    ratio = w[V.unloading_ratio] if of_sand else 1.0
    tangential = w[V.tangential_ratio] * stiffness
    law[at + LAW.normal] = stiffness
    law[at + LAW.damping] = 2.0 * w[V.damping] * math.sqrt(stiffness)
    law[at + LAW.tangential] = tangential
    law[at + LAW.tangential_damping] = 2.0 * w[V.damping] * math.sqrt(tangential)
    law[at + LAW.friction] = math.tan(friction)
    law[at + LAW.rolling] = w[V.rolling_resistance] if of_sand else 0.0
    law[at + LAW.unloading] = ratio * stiffness
    law[at + LAW.yielding] = 1.0 - 1.0 / ratio
    law[at + LAW.pull] = capillary_strength(w) if kind == KIND.sand else 0.0
    law[at + LAW.bridge] = w[V.cohesion_range]
    law[at + LAW.compliance] = 1.0 / tangential


@kernel
def capillary_strength(w):
    """Return the force of a capillary bridge / distance of the centres (N/m), from the cohesion c.

    Rumpf (1970): discs of diameter D that fill the part sf of the layer and pull each other with F
    at z contacts have the tensile strength sf z F / (pi D dL); with z = 4 and c = strength tan(phi)
    F = pi c D dL / (4 sf tan(phi)).

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        Strength (N/m).
    """
    if w[V.cohesion] == 0.0:
        return 0.0  # also without friction, where the cohesion has no strength to follow from
    strength = math.pi * w[V.cohesion] * w[V.thickness]
    return strength / (4.0 * w[V.solid_fraction] * math.tan(w[V.friction_angle]))


@kernel
def sand_stiffness(w):
    """Return k_n = E_bar dD dL / R_ij0 (N/m) between two sand discs, eq. (1).

    dD is R_ij0, the distance of centres: k_n = E_bar dL.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        k_n (N/m).
    """
    return w[V.stiffness_factor] * w[V.modulus] * w[V.thickness]


@kernel
def stiffness_against(radius, w):
    """Return k_n (N/m) between a sand disc and a body of another radius (m), eq. (1).

    dD is the sand disc's diameter, R_ij0 the sum of radii.

    Parameters
    ----------
    radius : float
        Radius of the body (m).
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        k_n (N/m).
    """
    return sand_stiffness(w) * 2.0 * w[V.disc_radius] / (w[V.disc_radius] + radius)


@kernel
def boundary_stiffness(kind, w):
    """Return k_n (N/m) of a kind of contact with rock, base or wall.

    A plane counts as the disc's mirror image.

    Parameters
    ----------
    kind : int
        Kind of the contact, one of :data:`KIND`.
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    float
        k_n (N/m).
    """
    if kind == KIND.rock:
        return w[V.rock_stiffness_ratio] * stiffness_against(w[V.rock_radius], w)
    if kind == KIND.base:
        is_round = w[V.base] == BEAM_DISCS and w[V.base_shape] == ROUND
        radius = w[V.beam_radius] if is_round else w[V.disc_radius]
        return w[V.base_stiffness_ratio] * stiffness_against(radius, w)
    if kind == KIND.wall:
        return w[V.wall_stiffness_ratio] * sand_stiffness(w)
    return w[V.rock_base_stiffness_ratio] * sand_stiffness(w)


@kernel
def set_laws(w, x, k):
    """Set the constants of all kinds of contact.

    Parameters
    ----------
    w, x : ndarray of float64
        Parameters, and the state that gets the table.
    k : ndarray of int64
        Integer state.
    """
    law = view(x, k, A.law)
    friction, wall_friction = w[V.friction_angle], w[V.wall_friction_angle]
    set_law(KIND.sand, sand_stiffness(w), friction, w, law)
    for kind in (KIND.rock, KIND.base, KIND.rock_base):
        set_law(kind, boundary_stiffness(kind, w), friction, w, law)
    for kind in (KIND.wall, KIND.rock_wall):
        set_law(kind, boundary_stiffness(kind, w), wall_friction, w, law)


@kernel
def stable_step_of(w):
    """Return the step (s) below which the lightest disc among six neighbours is stable.

    For a contact, (n.(u_j - u_i))^2 <= 2 (n.u_i)^2 + 2 (n.u_j)^2, and six neighbours have
    sum n n^T = 3 I: translation has omega^2 <= 6 (unloading stiffness + k_s) / m. Discs that all
    turn the same way shear their contacts most: omega^2 <= 24 k_s / m, and rolling resistance adds
    12 of its stiffness / I among discs, up to 16 in a corner of planes. Dashpots likewise, with the
    velocity of half a step before: dt <= 2 / omega (sqrt(1 + z^2) - z) with 2 z omega their bound.

    Parameters
    ----------
    w : ndarray of float64
        Parameters.

    Returns
    -------
    float
        Largest stable step (s).
    """
    least = w[V.disc_radius] * (1.0 - (w[V.disc_spread] if w[V.packing] >= RANDOM else 0.0))
    mass = disc_mass(least, w)
    stiffness = sand_stiffness(w)
    for kind in (KIND.rock, KIND.base, KIND.wall):
        stiffness = max(stiffness, boundary_stiffness(kind, w))
    contact = math.sqrt(stiffness / mass)
    ratio = w[V.tangential_ratio]
    springs = 6.0 * (w[V.unloading_ratio] + ratio)
    dashpots = 6.0 * (1.0 + math.sqrt(ratio))
    if w[V.rotation] == FREE:
        springs = max(springs, 24.0 * ratio + 8.0 * ROLLING * w[V.rolling_resistance] ** 2)
        dashpots = max(dashpots, 24.0 * math.sqrt(ratio))
    if w[V.base] != FLOOR:  # between two beam discs
        dashpots += 2.0 * (1.0 + math.sqrt(ratio)) * math.sqrt(w[V.beam_disc_mass] / mass)
    omega = contact * math.sqrt(springs)
    z = w[V.damping] * dashpots * contact / omega
    return 2.0 / omega * (math.sqrt(1.0 + z * z) - z)
