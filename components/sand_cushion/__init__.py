"""The sand cushion: discs that touch, after the distinct element method of Sonoda et al. (1993)."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from .declarations import LAYOUT, SIZES
from .faults import DEFERRED, FAULTS

COMPONENT = Component(
    name="SandCushion",
    title="Sand cushion: 2-D distinct elements",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    sizes=SIZES,
    faults=FAULTS,
    deferred=DEFERRED,
    default_step=1e-5,
    bonds=(
        Bond(
            "rock",
            "motion of the rock, force on it",
            "rock.",
            idle="the sand takes the rock as one that never moves",
        ),
        Bond(
            "beam",
            "motion of the beam's discs, force on them",
            "beam.",
            idle="the sand lies on a beam that never moves",
            unless=("base", "floor"),
        ),
    ),
    contents="granular.discs",
)
