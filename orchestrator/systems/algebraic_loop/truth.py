"""Two springs under one load: each takes its share at once."""

import numpy as np

from ..system import NumberArray

FIRST, SECOND = 1e6, 5e5
"""Stiffnesses (N/m)."""
AMPLITUDE, RATE = 1e3, 10.0
"""Of the load (N, rad/s)."""


def displacement(times: NumberArray) -> NumberArray:
    """Return the displacement of both (m)."""
    return AMPLITUDE * np.sin(RATE * times) / (FIRST + SECOND)
