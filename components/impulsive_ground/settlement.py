"""Mogami and Tamura (1973): settlement of a plate on sand under an impulse, in closed form. SI units, settlement downwards.

The equations carry the paper's numbers; README.md says where the print is wrong. The two fits (11) and (12) and the model (7)
contradict one another and are kept apart: no function here feeds one into another.
"""

import math

from ..common.kernels import kernel
from ..common.units import cm2, kgf, mm

DERIVED, PRINTED = 1, 2
"""Forms of the soil mass: with 12 r2, the momentum of the frustum; with 3 r2, as it stands in the paper."""

K_AMPLITUDE, K_FLOOR = 0.18194, 0.38947
"""Of (11), kgf s/mm."""
A1, B1, A2, B2 = 0.006705, 0.007425, 0.003053, 0.004185
"""Of (12): s, s, kgf s, kgf s."""
_UNIT_AREA = 100.0 * cm2
"""Unit of A in both fits."""


@kernel
def soil_mass(radius, depth, spread, density, form):
    """Virtual mass (kg) of the sand that moves with a plate, the bracket of (1) without the plate.

    The sand is a frustum of height ``depth`` (m) that widens by the angle ``spread`` (rad) from the plate's ``radius`` (m) on, of
    ``density`` (kg/m3); its velocity falls linearly from the plate's to 0 at the bottom. form: DERIVED, or PRINTED.
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
    """(5): velocity (m/s) of plate and sand after an impulse (N s). mass: the bracket of (1), kg."""
    return impulse / mass


def stopping_time(impulse: float, r0: float, r1: float) -> float:
    """(6): time t_f (s) at which a resistance that runs linearly from r0 to r1 (N) has used up the impulse (N s)."""
    return 2.0 * impulse / (r0 + r1)


def printed_settlement(impulse: float, mass: float, r0: float, r1: float) -> float:
    """(7): settlement (m), v0 t_f / 2: that of a velocity which falls linearly, (3); equal to the exact one for r0 = r1."""
    return impulse * impulse / ((r0 + r1) * mass)


def exact_settlement(impulse: float, mass: float, r0: float, r1: float) -> float:
    """Settlement (m) from (1) and (2) integrated exactly: 2 I2 (R0 + 2 R1) / [3 M (R0 + R1)2]."""
    return 2.0 * impulse * impulse * (r0 + 2.0 * r1) / (3.0 * mass * (r0 + r1) ** 2)


def coefficient(impulse: float, mass: float, r0: float, r1: float) -> float:
    """(8) for the model (7): impulsive ground coefficient K = dI/d(settlement) (N s/m)."""
    return (r0 + r1) * mass / (2.0 * impulse)


def mean_resistance(impulse: float, duration: float) -> float:
    """(9), (10): R_m = (R0 + R1)/2 = I/t_f (N), the mean over the time ``duration`` (s) of the motion."""
    return impulse / duration


def fitted_coefficient(area: float) -> float:
    """(11), a fit to the tests: K (N s/m) of a plate of ``area`` (m2)."""
    return (K_AMPLITUDE * math.exp(-area / _UNIT_AREA) + K_FLOOR) * kgf / mm


def fitted_impulse(mean: float, area: float) -> float:
    """(12), another fit to the tests: impulse (N s) that meets the mean resistance ``mean`` (N) under a plate of ``area`` (m2)."""
    slope, offset = _line(area)
    return slope * mean - offset


def fitted_mean_resistance(impulse: float, area: float) -> float:
    """(12) solved for R_m (N)."""
    slope, offset = _line(area)
    return (impulse + offset) / slope


def fitted_ends(impulse: float, area: float) -> tuple[float, float]:
    """R0 and R1 (N) as the paper reads them from the lines of fig. 3, (12): R0 is R_m at I = 0, R1 = 2 R_m - R0."""
    r0 = fitted_mean_resistance(0.0, area)
    return r0, 2.0 * fitted_mean_resistance(impulse, area) - r0


def _line(area: float) -> tuple[float, float]:
    """Slope (s) and offset (N s) of (12)."""
    decay = math.exp(-area / _UNIT_AREA)
    return A1 * decay + B1, (A2 * decay + B2) * kgf


def drop_impulse(mass: float, height: float, gravity: float = kgf) -> float:
    """Impulse (N s) of a weight that falls from ``height`` (m) and stays where it lands."""
    return mass * math.sqrt(2.0 * gravity * height)
