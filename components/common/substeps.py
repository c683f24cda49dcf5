"""Equal parts of a communication step that are not longer than the internal step."""

import math

from .kernels import kernel
from .stepping import MOST_STEPS

_ROUNDING = 1e-9
"""A quotient of two steps that exceeds a whole number by less than this is that number."""


@kernel
def substep_count(step, longest):
    """Return the number of equal parts of a step that are not longer than ``longest``.

    Parameters
    ----------
    step, longest : float
        Communication step and internal step (s).

    Returns
    -------
    int
        At least 1.
    """
    return max(1, math.ceil(step / longest - _ROUNDING))


@kernel
def are_too_many(step, longest):
    """Tell whether a step holds more internal steps than a component makes at once.

    Parameters
    ----------
    step, longest : float
        Communication step and internal step (s).

    Returns
    -------
    bool
        True also where a length is no positive number.
    """
    return not 0.0 < step <= MOST_STEPS * longest


@kernel
def substep_length(step, count, longest):
    """Return the length of each of the equal parts of a step.

    Some tools compute a step as the difference of two times. What is in its last digits then does
    not reach the results.

    Parameters
    ----------
    step : float
        Communication step (s).
    count : int
        Number of parts, of :func:`substep_count`.
    longest : float
        Internal step (s).

    Returns
    -------
    float
        Length (s); ``longest`` itself if nothing but rounding is between them.
    """
    return longest if abs(step / longest - count) <= _ROUNDING else step / count
