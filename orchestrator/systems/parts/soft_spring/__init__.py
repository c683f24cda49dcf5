"""A spring without mass: displacement from force. The other half of an algebraic loop."""

from pathlib import Path

from rockshed.components.common.component import Component

from .declarations import DIVERGED, LAYOUT

COMPONENT = Component(
    name="SoftSpring",
    title="Spring without mass: displacement from force",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults={DIVERGED: "the displacement is no longer a finite number: force = {force} N"},
    default_step=1e-3,
    default_stop_time=1.0,
)
