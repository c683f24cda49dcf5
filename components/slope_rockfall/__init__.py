"""The rock on its slope: Ushiro's DRSP, from event to event."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond, NextEvent
from .declarations import LAYOUT, SIZES
from .faults import FAULTS

COMPONENT = Component(
    name="SlopeRockfall",
    title="Rock on a slope: flight, impact, rolling and sliding (DRSP), event by event",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    sizes=SIZES,
    faults=FAULTS,
    default_step=1e-2,
    default_stop_time=20.0,
    bonds=(Bond("rock", "motion of the rock, force on it in the receiver"),),
    next_event=NextEvent("next_event.time", while_zero=("force.x", "force.y", "torque")),
)
