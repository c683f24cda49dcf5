"""A spring between two bodies."""

from pathlib import Path

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Bond

from .declarations import DIVERGED, LAYOUT

COMPONENT = Component(
    name="Spring",
    title="Spring between two bodies: a contact, or a spring that pulls too",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults={DIVERGED: "the force is no longer a finite number: compression = {compression} m"},
    default_step=1e-4,
    bonds=(
        Bond("lower", "motion of the lower body, force on it", "lower."),
        Bond("upper", "motion of the upper body, force on it", "upper."),
    ),
)
