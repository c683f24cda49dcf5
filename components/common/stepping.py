"""What every component that integrates in time has in common: its internal step and the declaration of it."""

import math

from .kernels import kernel
from .ports import Variable, out, param
from .roles import Role

_ROUNDING = 1e-9
"""A quotient of two steps that exceeds a whole number by less than this is that number."""


def internal_step(start: float) -> Variable:
    """Declare the component's own time step."""
    return param(
        "internal_step",
        "largest time step inside the component; a communication step is divided into equal parts not "
        "longer than it",
        start,
        "s",
        minimum=1e-12,
        role=Role.INTERNAL_STEP,
    )


def stable_step() -> Variable:
    """Declare the output that tells the largest stable internal step."""
    return out(
        "stable_step",
        "largest internal step with which the integration is stable, computed from the parameters",
        "s",
        initial_dependencies=None,
    )


@kernel
def substep_count(step, longest):
    """Number of equal parts of ``step`` (s) that are not longer than ``longest`` (s); at least 1."""
    return max(1, math.ceil(step / longest - _ROUNDING))


@kernel
def substep_length(step, count, longest):
    """Length (s) of each of ``count`` equal parts of ``step`` (s): ``longest`` (s) itself if nothing but rounding is between them.

    Some tools compute a step as the difference of two times. What is in its last digits then does not reach the results.
    """
    return longest if abs(step / longest - count) <= _ROUNDING else step / count
