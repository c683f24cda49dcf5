"""A mass with a contact spring on a simply supported beam, by the modes of both together."""

import numpy as np
from scipy.linalg.lapack import dgejsv

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
    alone = (number * np.pi / SPAN) ** 2 * np.sqrt(MODULUS * SECOND_MOMENT / line_mass)
    press = np.append(np.where(number % 4 == 1, 1.0, -1.0), -1.0)
    rate, shapes = _modes(np.append(alone, 0.0), np.sqrt(STIFFNESS / masses) * press)
    shapes /= np.sqrt(masses)[:, None]
    start = np.append(np.zeros(MODES), SPEED)
    swing = shapes @ ((shapes.T @ (masses * start) / rate)[:, None] * np.sin(rate[:, None] * times))
    return press[:-1] @ swing[:-1], -STIFFNESS * (press @ swing)


def _modes(rates: NumberArray, press: NumberArray) -> tuple[NumberArray, NumberArray]:
    """Return rates and shapes of diag(rates^2) + press press', to all digits of the slow ones too.

    They are singular values and vectors of the root of this matrix, by Jacobi's method (LAPACK's
    dgejsv). The eigenvalues of the matrix itself span eight powers of ten, and the slow modes
    lost as many digits: other ones on each processor.
    """
    root = np.vstack([np.diag(rates), press])
    values, _, shapes, scale, _, info = dgejsv(root, joba=0, jobu=3, jobv=0)
    if info != 0:
        raise ArithmeticError(f"LAPACK's dgejsv found no modes of ball and beam (info = {info})")
    return values * scale[0] / scale[1], shapes
