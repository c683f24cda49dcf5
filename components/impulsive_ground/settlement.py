"""Settlement of a plate on sand under an impulse, in closed form, after Mogami and Tamura (1973).

SI units, settlement downwards. The equations carry the paper's numbers; README.md says where the
print is wrong. The two fits (11) and (12) and the model (7) contradict one another and are kept
apart: no function here feeds one into another.
"""

import math

from ..common.kernels import kernel
from ..common.units import cm2, kgf, mm

DERIVED, PRINTED = 1, 2
"""Forms of the soil mass: with 12 r2, the momentum of the frustum; with 3 r2, as it stands in the
paper."""

K_AMPLITUDE, K_FLOOR = 0.18194, 0.38947
"""Constants of (11), kgf s/mm."""
A1, B1, A2, B2 = 0.006705, 0.007425, 0.003053, 0.004185
"""Constants of (12): s, s, kgf s, kgf s."""
_UNIT_AREA = 100.0 * cm2
"""Unit of A in both fits (m2)."""


@kernel
def soil_mass(radius, depth, spread, density, form):
    """Return the virtual mass of the sand that moves with a plate.

    It is the bracket of (1) without G, which is the plate and the body that fell on it.

    The sand is a frustum that widens downwards from the plate; its velocity falls linearly from the
    plate's to 0 at the bottom:

        pi rho l/24 (12 r2 + 8 r l tan a + 2 (l tan a)2).

    Parameters
    ----------
    radius : float
        Of the plate, r (m).
    depth : float
        Height of the frustum, l (m).
    spread : float
        Angle by which it widens, a (rad).
    density : float
        Of the sand, rho (kg/m3).
    form : int
        DERIVED, or PRINTED, which has 3 r2 in the place of 12 r2.

    Returns
    -------
    float
        Mass (kg).
    """
    wider = depth * math.tan(spread)
    square = 12.0 if form == DERIVED else 3.0
    return (
        math.pi
        * density
        * depth
        / 24.0
        * (square * radius * radius + 8.0 * radius * wider + 2.0 * wider * wider)
    )


def initial_velocity(impulse: float, mass: float) -> float:
    """Return the velocity of plate and sand after an impulse, (5).

    Parameters
    ----------
    impulse : float
        I (N s).
    mass : float
        The bracket of (1), M (kg).

    Returns
    -------
    float
        I/M (m/s).
    """
    return impulse / mass


def stopping_time(impulse: float, r0: float, r1: float) -> float:
    """Return the time at which a resistance linear in time has used up the impulse, (6).

    Parameters
    ----------
    impulse : float
        I (N s).
    r0, r1 : float
        Resistance at the beginning and at the end (N).

    Returns
    -------
    float
        t_f = 2 I/(R0 + R1) (s).
    """
    return 2.0 * impulse / (r0 + r1)


def printed_settlement(impulse: float, mass: float, r0: float, r1: float) -> float:
    """Return the settlement for a velocity that falls linearly, (3): v0 t_f/2, (7).

    It equals the exact one for r0 = r1.

    Parameters
    ----------
    impulse : float
        I (N s).
    mass : float
        The bracket of (1), M (kg).
    r0, r1 : float
        Resistance at the beginning and at the end (N).

    Returns
    -------
    float
        I2/[(R0 + R1) M] (m).
    """
    return impulse * impulse / ((r0 + r1) * mass)


def exact_settlement(impulse: float, mass: float, r0: float, r1: float) -> float:
    """Return the settlement from (1) and (2) integrated exactly.

    Parameters
    ----------
    impulse : float
        I (N s).
    mass : float
        The bracket of (1), M (kg).
    r0, r1 : float
        Resistance at the beginning and at the end (N).

    Returns
    -------
    float
        2 I2 (R0 + 2 R1)/[3 M (R0 + R1)2] (m).
    """
    return 2.0 * impulse * impulse * (r0 + 2.0 * r1) / (3.0 * mass * (r0 + r1) ** 2)


def coefficient(impulse: float, mass: float, r0: float, r1: float) -> float:
    """Return the impulsive ground coefficient for the model (7), (8): K = dI/d(settlement).

    Parameters
    ----------
    impulse : float
        I (N s).
    mass : float
        The bracket of (1), M (kg).
    r0, r1 : float
        Resistance at the beginning and at the end (N).

    Returns
    -------
    float
        (R0 + R1) M/(2 I) (N s/m).
    """
    return (r0 + r1) * mass / (2.0 * impulse)


def mean_resistance(impulse: float, duration: float) -> float:
    """Return the mean resistance over the time of the motion, (9), (10).

    Parameters
    ----------
    impulse : float
        I (N s).
    duration : float
        Of the motion, t_f (s).

    Returns
    -------
    float
        R_m = (R0 + R1)/2 = I/t_f (N).
    """
    return impulse / duration


def fitted_coefficient(area: float) -> float:
    """Return the impulsive ground coefficient K of a plate, (11), a fit to the tests.

    Parameters
    ----------
    area : float
        Of the plate (m2).

    Returns
    -------
    float
        K (N s/m).
    """
    return (K_AMPLITUDE * math.exp(-area / _UNIT_AREA) + K_FLOOR) * kgf / mm


def fitted_impulse(mean: float, area: float) -> float:
    """Return the impulse that meets a mean resistance, (12), another fit to the tests.

    Parameters
    ----------
    mean : float
        Mean resistance R_m (N).
    area : float
        Of the plate (m2).

    Returns
    -------
    float
        I (N s).
    """
    slope, offset = _line(area)
    return slope * mean - offset


def fitted_mean_resistance(impulse: float, area: float) -> float:
    """Return the mean resistance that an impulse meets: (12) solved for R_m.

    Parameters
    ----------
    impulse : float
        I (N s).
    area : float
        Of the plate (m2).

    Returns
    -------
    float
        R_m (N).
    """
    slope, offset = _line(area)
    return (impulse + offset) / slope


def fitted_ends(impulse: float, area: float) -> tuple[float, float]:
    """Return R0 and R1 as the paper reads them from the lines of fig. 3, (12).

    Parameters
    ----------
    impulse : float
        I (N s).
    area : float
        Of the plate (m2).

    Returns
    -------
    tuple of float
        R0, which is R_m at I = 0, and R1 = 2 R_m - R0 (N).
    """
    r0 = fitted_mean_resistance(0.0, area)
    return r0, 2.0 * fitted_mean_resistance(impulse, area) - r0


def _line(area: float) -> tuple[float, float]:
    """Return slope (s) and offset (N s) of the line (12) for an area (m2)."""
    decay = math.exp(-area / _UNIT_AREA)
    return A1 * decay + B1, (A2 * decay + B2) * kgf


def drop_impulse(mass: float, height: float, gravity: float = kgf) -> float:
    """Return the impulse of a weight that falls and stays where it lands.

    Parameters
    ----------
    mass : float
        Of the weight (kg).
    height : float
        Of its fall (m).
    gravity : float
        Acceleration (m/s2); the default is standard gravity.

    Returns
    -------
    float
        M sqrt(2 g h) (N s).
    """
    return mass * math.sqrt(2.0 * gravity * height)
