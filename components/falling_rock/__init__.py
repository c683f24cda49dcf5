"""The falling rock: a rigid body in the plane."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from . import kernel
from .declarations import LAYOUT

COMPONENT = Component(
    name="FallingRock",
    title="Falling rock: rigid body in the plane",
    layout=LAYOUT,
    initialise=kernel.initialise,
    evaluate=kernel.evaluate,
    step=kernel.step,
    folder=Path(__file__).parent,
    faults={
        kernel.DIVERGED: "position or work is no longer a finite number; the force on the rock was ({force.x}, {force.y}) N: "
        "reduce the exchange step or the step of the component that computes it"
    },
    default_step=1e-5,
    bonds=(Bond("rock", "motion of the rock, force on it"),),
)
