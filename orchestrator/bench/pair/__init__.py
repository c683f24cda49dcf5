"""A component for the benchmark of the exchange: many variables, and hardly anything to compute."""

from pathlib import Path

from rockshed.components.common.component import Component, Size

from .declarations import LAYOUT

COMPONENT = Component(
    name="Relay",
    title="Relay: shows what it is given",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    sizes={
        "inputs": Size(50, 1, 1000, "number of inputs"),
        "outputs": Size(150, 1, 1000, "number of outputs"),
    },
    default_step=1e-3,
    default_stop_time=1.0,
)
