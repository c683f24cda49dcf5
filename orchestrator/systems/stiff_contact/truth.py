"""Two bodies and a linear contact: half of a sine."""

import math

import numpy as np

from ..system import NumberArray

STRIKER, STRUCK = 1.0, 0.5
"""Masses (kg)."""
SPEED = 1.0
"""Of the striker (m/s)."""
STIFFNESS = 1e6
"""Of the contact (N/m)."""
RATE = math.sqrt(STIFFNESS * (STRIKER + STRUCK) / (STRIKER * STRUCK))
"""Angular frequency of the pressed contact (rad/s)."""


def struck_velocity(times: NumberArray) -> NumberArray:
    """Return the velocity of the body that was at rest (m/s)."""
    common = STRIKER * SPEED / (STRIKER + STRUCK)
    phase = np.minimum(RATE * times, math.pi)
    return common * (1.0 - np.cos(phase))
