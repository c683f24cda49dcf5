"""A component for the benchmark of the exchange: many ports, and hardly anything to compute.

It is imported as if it lay among the components, whose modules it uses: see
:mod:`rockshed.bench.exchange`.
"""

from pathlib import Path

from ..common.component import Component, Size
from . import kernel
from .declarations import LAYOUT

COMPONENT = Component(
    name="Relay",
    title="Relay: shows what it is given",
    layout=LAYOUT,
    initialise=kernel.initialise,
    evaluate=kernel.evaluate,
    step=kernel.step,
    folder=Path(__file__).parent,
    sizes={
        "inputs": Size(50, 1, 1000, "number of inputs"),
        "outputs": Size(150, 1, 1000, "number of outputs"),
    },
    default_step=1e-3,
    default_stop_time=1.0,
)
