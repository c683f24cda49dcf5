"""A component for the benchmark of the accounts: forces, motions, and hardly any computation."""

from pathlib import Path

from rockshed.components.common.component import Component, Size

from .declarations import LAYOUT

COMPONENT = Component(
    name="BondedRelay",
    title="Bonded relay: forces that follow motions, and motions that follow forces",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    sizes={"channels": Size(25, 1, 1000, "number of forces and motions each way")},
    default_step=1e-3,
    default_stop_time=1.0,
)
