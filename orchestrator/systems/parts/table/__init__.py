"""A table that shakes, whatever stands on it."""

from pathlib import Path

from rockshed.components.common.component import Component

from .declarations import LAYOUT

COMPONENT = Component(
    name="ShakingTable",
    title="Shaking table: a motion that nothing resists",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    default_step=1e-3,
    default_stop_time=1.0,
)
