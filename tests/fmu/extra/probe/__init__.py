"""A component for tests of the export: it has one of everything that can be declared."""

from pathlib import Path

from rockshed.components.common.component import Component, Size

from .declarations import INFLOW_AT_START, LAYOUT, OVERFLOW

COMPONENT = Component(
    name="Probe",
    title="Probe: leaky tanks <in a row> & a counter",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    sizes={"tanks": Size(3, 1, 50, "number of tanks")},
    faults={
        OVERFLOW: "a tank overflows above the level {limit} m: raise limit or reduce inflow",
        INFLOW_AT_START: "inflow {inflow} m/s at the start exceeds the limit {limit} m: reduce inflow",
    },
    default_step=0.01,
    default_stop_time=1.0,
)
