"""Statuses of the hammer other than OK."""

from ..common.stepping import STEPPING_FAULTS

RIGID_NEEDS_WAVES, NO_IMPEDANCE, DIVERGED = range(1, 4)
TRAIN_NEEDS_WAVES, TRAIN_INCOMPLETE, GAS_ENDS_EARLY, NOT_SETTLED = range(4, 8)

FAULTS = {
    **STEPPING_FAULTS,
    RIGID_NEEDS_WAVES: "a rigid ram (cushion.stiffness = 0) finds its force from the wave of the "
    "rod, not from the motion of the head: set port = waves or give cushion.stiffness",
    NO_IMPEDANCE: "head.impedance = {head.impedance} N s/m: connect it with the impedance of the "
    "rod, which is positive",
    DIVERGED: "position or force is no longer a finite number: the force on the head was {force} "
    "N; reduce the exchange step below the step_limit of the rod",
    TRAIN_NEEDS_WAVES: "anvil, helmet, second cushion and gas need the wave of the rod: set port = "
    "waves",
    TRAIN_INCOMPLETE: "anvil, helmet and gas need a cushion below the ram (cushion.stiffness = "
    "{cushion.stiffness} N/m), and a second cushion (pile_cushion.stiffness) needs a helmet: give "
    "cushion.stiffness, and helmet.mass where there is a second cushion",
    GAS_ENDS_EARLY: "the gas ends (gas.end = {gas.end} s) before it has lost its force (gas.hold = "
    "{gas.hold} s): give a later gas.end",
    NOT_SETTLED: "the forces between ram, anvil, helmet and head did not settle: anvil or helmet "
    "(anvil.mass = {anvil.mass} kg, helmet.mass = {helmet.mass} kg) is too light for the step "
    "(internal_step = {internal_step} s): leave it out, or shorten the step",
}
"""Message of each status; a name in braces stands for the value of that variable."""
