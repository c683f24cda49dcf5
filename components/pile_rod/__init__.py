"""The pile rod: longitudinal waves in a struck rod or pile, by four schemes."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from ..common.shown import Curve, Panel, Picture
from .declarations import LAYOUT, SIZES
from .faults import FAULTS

COMPONENT = Component(
    name="PileRod",
    title="Pile rod: longitudinal waves in a struck rod, with soil at shaft and toe",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    sizes=SIZES,
    faults=FAULTS,
    default_step=1e-5,
    bonds=(
        Bond("head", "motion and wave of the head, force on it", "head."),
        Bond("toe", "motion and wave of the toe, force on it", "toe."),
    ),
    pictures=(
        Picture(
            "piles",
            (
                Panel(
                    "force",
                    "kN",
                    (
                        Curve("head.contact_force", "force at the head"),
                        Curve("head.zv", "Z v there", dashed=True),
                        Curve("toe.contact_force", "force at the toe"),
                    ),
                ),
            ),
        ),
    ),
)
