"""The hammer: a ram that falls on the head of a pile or rod."""

from pathlib import Path

from ..common.component import Component
from . import kernel
from .declarations import LAYOUT

COMPONENT = Component(
    name="Hammer",
    title="Hammer: rigid ram with a cushion on the head of a rod",
    layout=LAYOUT,
    initialise=kernel.initialise,
    evaluate=kernel.evaluate,
    step=kernel.step,
    folder=Path(__file__).parent,
    faults={
        kernel.RIGID_NEEDS_WAVES: "a rigid ram (cushion.stiffness = 0) finds its force from the wave of the rod, not from "
        "the motion of the head: set port = waves or give cushion.stiffness",
        kernel.NO_IMPEDANCE: "head.impedance = {head.impedance} N s/m: connect it with the impedance of the rod, which is positive",
        kernel.DIVERGED: "position or force is no longer a finite number: the force on the head was {force} N; reduce the exchange "
        "step below the step_limit of the rod",
    },
    default_step=1e-5,
)
