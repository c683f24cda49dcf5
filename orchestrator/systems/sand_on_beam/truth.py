"""The laboratory impact by a program without interfaces."""

from functools import cache

import numpy as np

from ...bench.monolithic import from_system
from ...cases.sonoda1993 import lab_system, tests
from ..system import NumberArray

TEST = 4
"""Of Sonoda et al. (1993)."""
STOP = 8e-3
"""End of the run (s)."""
STEP = 1e-5
"""Of the program (s); the beam makes ten in each."""


@cache
def _velocities() -> NumberArray:
    """Return the velocity of the rock (m/s, upwards) at the start of each step of the program."""
    files = {name: "" for name in ("sand", "rock", "beam")}
    program = from_system(lab_system(files, tests()[TEST]), STOP, STEP)
    start = program.rock["velocity0.y"]
    program.run()
    pushed = program.column("rock_force_y") / program.rock["mass"] - program.rock["gravity"]
    velocities: NumberArray = np.concatenate([[start], start + STEP * np.cumsum(pushed)])
    return velocities


def rock_velocity(times: NumberArray) -> NumberArray:
    """Return the velocity of the rock (m/s, upwards) at multiples of the program's step."""
    return _velocities()[np.rint(times / STEP).astype(int)]
