"""Two bodies on springs with a spring between them, by their modes."""

import numpy as np
from scipy.linalg import eigh

from ..system import NumberArray

MASSES = (2.0, 1.0)
"""Of the lower and the upper body (kg)."""
SPRINGS = (2e4, 1e4)
"""To the ground (N/m)."""
JOINING = 5e3
"""Between both (N/m)."""
SPEED = 1.0
"""Of the lower body at the start (m/s)."""


def upper_position(times: NumberArray) -> NumberArray:
    """Return the position of the body that was at rest (m)."""
    stiffness = np.diag(SPRINGS) + JOINING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    masses = np.array(MASSES)
    squared, shapes = eigh(stiffness, np.diag(masses))
    rate = np.sqrt(squared)
    amplitudes = shapes.T @ (masses * np.array([SPEED, 0.0])) / rate
    swing: NumberArray = shapes[1] @ (amplitudes[:, None] * np.sin(rate[:, None] * times))
    return swing
