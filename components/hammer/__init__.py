"""The hammer: a ram that falls on the head of a pile or rod."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from .declarations import LAYOUT
from .faults import FAULTS

COMPONENT = Component(
    name="Hammer",
    title="Hammer: rigid ram with a cushion on the head of a rod",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults=FAULTS,
    default_step=1e-5,
    bonds=(
        Bond(
            "head",
            "motion and wave of a rod's head, mean force on it",
            "head.",
            named={"force": "force"},
        ),
    ),
)
