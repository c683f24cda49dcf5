"""Statuses of the hammer other than OK."""

from ..common.stepping import STEPPING_FAULTS

RIGID_NEEDS_WAVES, NO_IMPEDANCE, DIVERGED = range(1, 4)

FAULTS = {
    **STEPPING_FAULTS,
    RIGID_NEEDS_WAVES: "a rigid ram (cushion.stiffness = 0) finds its force from the wave of the "
    "rod, not from the motion of the head: set port = waves or give cushion.stiffness",
    NO_IMPEDANCE: "head.impedance = {head.impedance} N s/m: connect it with the impedance of the "
    "rod, which is positive",
    DIVERGED: "position or force is no longer a finite number: the force on the head was {force} "
    "N; reduce the exchange step below the step_limit of the rod",
}
"""Message of each status; a name in braces stands for the value of that variable."""
