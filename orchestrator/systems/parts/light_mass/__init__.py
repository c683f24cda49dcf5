"""A light mass on stiff springs that makes one explicit step in each communication step."""

from pathlib import Path

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Bond

from .declarations import DIVERGED, LAYOUT

COMPONENT = Component(
    name="LightMass",
    title="Light mass between two stiff springs: one explicit step a communication step",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults={
        DIVERGED: "the position is no longer a finite number: the communication step exceeds "
        "stable_step = {stable_step} s"
    },
    default_step=1e-5,
    bonds=(Bond("partner", "motion of the body above, force on it", "partner."),),
)
