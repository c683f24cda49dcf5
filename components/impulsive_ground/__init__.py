"""The ground under an impulsive load.

It is Mogami's plate with its sand, or Smith's soil at the toe of a rod.
"""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from ..common.shown import Curve, Panel, Picture
from .declarations import LAYOUT
from .faults import FAULTS

COMPONENT = Component(
    name="ImpulsiveGround",
    title="Ground under an impulsive load: settling plate (Mogami), soil at a toe (Smith)",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults=FAULTS,
    default_step=1e-5,
    bonds=(
        Bond(
            "toe",
            "motion and wave of a rod's toe, mean force on it",
            "toe.",
            named={"force": "toe.mean_force"},
        ),
        Bond("plate", "motion of the plate, force on it"),
    ),
    pictures=(
        Picture(
            "piles",
            (
                Panel(
                    "settlement of the toe",
                    "mm",
                    (Curve("settlement"), Curve("permanent_set", "set", dashed=True)),
                    downwards=True,
                    common=True,
                ),
            ),
        ),
    ),
)
