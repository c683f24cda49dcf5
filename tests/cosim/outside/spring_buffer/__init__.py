"""A spring buffer under the support of a beam: a component in a folder of its own."""

from pathlib import Path

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Bond
from rockshed.components.common.shown import Curve, Panel, Picture

from .declarations import DIVERGED, LAYOUT

COMPONENT = Component(
    name="SpringBuffer",
    title="Spring buffer: plate on a spring and a dashpot",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults={DIVERGED: "the plate's position is no longer a finite number: force.y = {force.y} N"},
    default_step=1e-5,
    bonds=(Bond("support", "motion of the plate, force on it"),),
    pictures=(
        Picture(
            "buffers",
            (
                Panel("compression", "mm", (Curve("compression"),), downwards=True, common=True),
                Panel(
                    "force on the ground",
                    "kN",
                    (Curve("ground.force.y"),),
                    second_unit="kgf",
                    common=True,
                ),
            ),
        ),
    ),
)
