"""The falling rock: a rigid body in the plane."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from .declarations import LAYOUT
from .faults import FAULTS

COMPONENT = Component(
    name="FallingRock",
    title="Falling rock: rigid body in the plane",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults=FAULTS,
    default_step=1e-5,
    bonds=(Bond("rock", "motion of the rock, force on it"),),
)
