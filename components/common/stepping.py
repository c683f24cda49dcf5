"""Declarations of what every component that integrates in time has: its step and the stable one."""

from .ports import Variable, out, param
from .roles import Role

MOST_STEPS = 10_000_000
"""Internal steps that a component makes in one communication step, at most: it cannot be
interrupted there."""
TOO_MANY_STEPS = 1000
"""Status of a kernel whose communication step holds more internal steps."""
STEPPING_FAULTS = {
    TOO_MANY_STEPS: f"the communication step holds more than {MOST_STEPS:,} internal steps of "
    "internal_step = {internal_step} s: reduce the communication step, or raise internal_step"
}
"""Messages of the statuses that all components with an internal step share."""


def internal_step(start: float) -> Variable:
    """Declare the component's own time step.

    Parameters
    ----------
    start : float
        Start value (s).

    Returns
    -------
    Variable
        The parameter ``internal_step``.
    """
    return param(
        "internal_step",
        "largest time step inside the component; a communication step is divided into equal parts "
        "not longer than it",
        start,
        "s",
        minimum=1e-12,
        role=Role.INTERNAL_STEP,
    )


def stable_step() -> Variable:
    """Declare the output that tells the largest stable internal step.

    Returns
    -------
    Variable
        The output ``stable_step``.
    """
    return out(
        "stable_step",
        "largest internal step with which the integration is stable, computed from the parameters",
        "s",
        initial_dependencies=None,
    )
