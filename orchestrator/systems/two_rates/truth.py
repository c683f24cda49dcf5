"""Two masses on springs, by their own modes."""

import numpy as np
from scipy.linalg import eigh

from ..system import NumberArray

HEAVY, HEAVY_SPRING = 100.0, 1e5
"""Mass (kg) and its spring to the ground (N/m): 5.0 Hz alone."""
LIGHT_MASS, LIGHT_SPRING = 0.1, 1e6
"""Mass (kg) and its spring to the ground (N/m): 503 Hz alone."""
JOINING = 2e4
"""Stiffness of the spring between both (N/m)."""
START = 0.01
"""Position of the heavy mass at the start (m); the light one is at rest under it."""


def start_of_light() -> float:
    """Return where the light mass is in equilibrium under the heavy one at the start (m)."""
    return JOINING / (JOINING + LIGHT_SPRING) * START


def start_energy() -> float:
    """Return the energy of all springs at the start (J)."""
    light = start_of_light()
    springs = HEAVY_SPRING * START**2 + LIGHT_SPRING * light**2 + JOINING * (START - light) ** 2
    return 0.5 * springs


def slow_position(times: NumberArray) -> NumberArray:
    """Return the position of the heavy mass (m)."""
    stiffness = np.array([[HEAVY_SPRING + JOINING, -JOINING], [-JOINING, LIGHT_SPRING + JOINING]])
    masses = np.array([HEAVY, LIGHT_MASS])
    squared, shapes = eigh(stiffness, np.diag(masses))
    amplitudes = shapes.T @ (masses * np.array([START, start_of_light()]))
    swing: NumberArray = shapes[0] @ (
        amplitudes[:, None] * np.cos(np.sqrt(squared)[:, None] * times)
    )
    return swing
