"""The rock on its slope: Ushiro's DRSP, from event to event."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond, NextEvent
from . import kernel, refusals
from .declarations import LAYOUT, SIZES

COMPONENT = Component(
    name="SlopeRockfall",
    title="Rock on a slope: flight, impact, rolling and sliding (DRSP), event by event",
    layout=LAYOUT,
    initialise=kernel.initialise,
    evaluate=kernel.evaluate,
    step=kernel.step,
    folder=Path(__file__).parent,
    sizes=SIZES,
    check=refusals.problems,
    faults={
        **refusals.FAULTS,
        kernel.FORCE_OUTSIDE: "a force ({force.x}, {force.y}) N, {torque} N m acts on the rock at ({position.x}, {position.y}) m, "
        "which is not handed over: enlarge the receiver until it contains all that can touch the rock",
        kernel.LEFT_BELOW: "the rock has left the receiver at ({position.x}, {position.y}) m and is below the slope's surface "
        "(height {height} m): let the receiver end where what is in it meets the slope",
        kernel.DIVERGED: "the position is no longer a finite number; the force on the rock was ({force.x}, {force.y}) N: "
        "reduce the exchange step or the step of the component that computes it",
        kernel.NEVER_RECEIVED: "trial {trial} of seed {seed} never enters the receiver, and lead_time counts from there: choose "
        "another trial or receiver, or leave lead_time out",
        kernel.RESTLESS: "a million events in one step, at ({position.x}, {position.y}) m: give cell {cell} some roughness, or "
        "hardening below 1",
    },
    default_step=1e-2,
    default_stop_time=20.0,
    bonds=(Bond("rock", "motion of the rock, force on it in the receiver"),),
    next_event=NextEvent("next_event.time", while_zero=("force.x", "force.y", "torque")),
)
