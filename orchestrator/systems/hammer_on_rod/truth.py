"""St. Venant's impact in closed form."""

import math

import numpy as np

from rockshed.components.common.units import standard_gravity
from rockshed.components.pile_rod.st_venant import StVenant

from ..system import NumberArray

MASS, DROP = 63.5, 0.75
"""Of the hammer (kg, m)."""
SPEED = math.sqrt(2.0 * standard_gravity * DROP)
"""With which it strikes (m/s)."""
LENGTH, WAVE_SPEED = 10.24, 5120.0
"""Of the rod (m, m/s)."""
IMPEDANCE = 5.8e-4 * 7850.0 * WAVE_SPEED
"""Area, density and wave speed of the rod (N s/m)."""
REFLECTION = -0.5
"""Part of a wave that the toe reflects."""
PROBLEM = StVenant(MASS, SPEED, IMPEDANCE, LENGTH / WAVE_SPEED, REFLECTION)


def hammer_velocity(times: NumberArray) -> NumberArray:
    """Return the velocity of the hammer (m/s, downwards), which flies on once it has separated."""
    end, rebound = PROBLEM.separation(), PROBLEM.rebound()
    assert end is not None
    assert rebound is not None
    return np.where(times < end, PROBLEM.velocity(np.minimum(times, end)), rebound)
