"""A spring beside a load that changes over time: one half of an algebraic loop."""

from pathlib import Path

from rockshed.components.common.component import Component

from .declarations import DIVERGED, LAYOUT

COMPONENT = Component(
    name="LoadedSpring",
    title="Load less the force of a spring, from the displacement",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults={DIVERGED: "the force is no longer a finite number: displacement = {displacement} m"},
    default_step=1e-3,
    default_stop_time=1.0,
)
