"""A mass under a force, in closed form."""

from pathlib import Path

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Bond

from .declarations import DIVERGED, LAYOUT

COMPONENT = Component(
    name="Mass",
    title="Mass: a body on a line, with or without a spring to the ground",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults={DIVERGED: "the position is no longer a finite number: force.y = {force.y} N"},
    default_step=1e-4,
    bonds=(Bond("body", "motion of the mass, force on it"),),
)
