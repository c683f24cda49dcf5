"""A mass with a contact spring on a simply supported beam, by the modes of both together."""

import numpy as np
from scipy.linalg import eigh

from rockshed.components.common.units import cm2, cm4, kgf

from ..system import NumberArray

MASS, SPEED = 4.0, 1.0
"""Of the ball (kg, m/s downwards)."""
STIFFNESS = 2e6
"""Of the contact (N/m)."""
SPAN, AREA, SECOND_MOMENT = 1.2, 11.85 * cm2, 187.0 * cm4
"""Of the beam (m, m2, m4)."""
MODULUS, DENSITY = 2.1e6 * kgf / cm2, 7850.0
"""Of its steel (Pa, kg/m3)."""
MODES = 60
"""Odd modes of the beam that are taken; the midspan does not move in the even ones."""


def deflection(times: NumberArray) -> NumberArray:
    """Return the deflection of the midspan (m, downwards) while the ball presses on it."""
    return _motion(times)[0]


def force(times: NumberArray) -> NumberArray:
    """Return the force of the contact (N, compression positive) as long as it is positive."""
    return _motion(times)[1]


def _motion(times: NumberArray) -> tuple[NumberArray, NumberArray]:
    """Return deflection (m) and force (N)."""
    number = np.arange(1, 2 * MODES, 2)
    line_mass = DENSITY * AREA
    masses = np.append(np.full(MODES, 0.5 * line_mass * SPAN), MASS)
    own = (number * np.pi / SPAN) ** 4 * MODULUS * SECOND_MOMENT / line_mass * masses[:-1]
    press = np.append(np.where(number % 4 == 1, 1.0, -1.0), -1.0)
    squared, shapes = eigh(
        np.diag(np.append(own, 0.0)) + STIFFNESS * np.outer(press, press), np.diag(masses)
    )
    rate = np.sqrt(squared)
    start = np.append(np.zeros(MODES), SPEED)
    swing = shapes @ ((shapes.T @ (masses * start) / rate)[:, None] * np.sin(rate[:, None] * times))
    return press[:-1] @ swing[:-1], -STIFFNESS * (press @ swing)
