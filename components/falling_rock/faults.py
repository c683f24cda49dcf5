"""Statuses of the falling rock other than OK."""

from ..common.stepping import STEPPING_FAULTS

DIVERGED = 1

FAULTS = {
    **STEPPING_FAULTS,
    DIVERGED: "position or work is no longer a finite number; the force on the rock was "
    "({force.x}, {force.y}) N: reduce the exchange step or the step of the component that computes "
    "it",
}
"""Message of each status; a name in braces stands for the value of that variable."""
