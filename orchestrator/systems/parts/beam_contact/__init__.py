"""A contact spring between a ball and one disc of a beam."""

from pathlib import Path

from rockshed.components.common.component import Component, Size

from .declarations import DIVERGED, LAYOUT

COMPONENT = Component(
    name="BeamContact",
    title="Contact spring between a ball and the middle disc of a beam",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    sizes={"elements": Size(49, 1, 1001, "number of discs of the beam")},
    faults={
        DIVERGED: "the force is no longer a finite number: ball.position.y = {ball.position.y}"
    },
    default_step=1e-5,
)
