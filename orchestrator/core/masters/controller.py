"""A controller of step sizes that only doubles and halves.

With an error e of the last step and e' of the one before, as parts of the tolerance, the next step
is that times s e^(-0.7 / k) e'^(0.4 / k), where an error grows with the power k of the step: a
proportional and integral controller. K. Gustafsson, Control theoretic techniques for stepsize
selection in explicit Runge-Kutta methods, ACM Trans. Math. Softw. 17 (1991) 533-554; constants as
in E. Hairer and G. Wanner, Solving ordinary differential equations II, sec. IV.2.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_SAFETY = 0.9
_LEAST, _MOST = 0.2, 2.0
"""Bounds of the factor from one step to the next."""
_TINY = 1e-10
"""Smallest error that counts, as a part of the tolerance."""


class StepController:
    """Finds the next step, in exchange steps of the system.

    Parameters
    ----------
    longest : int
        Longest step; a power of two.
    power : int
        Power of the step with which an error of one exchange grows.
    """

    def __init__(self, longest: int, power: int) -> None:
        self._longest = longest
        self._power = power
        self._wanted = 1.0
        self._before = 1.0

    def step(self, room: int) -> int:
        """Return the next step: a power of two that fits into the room (exchange steps)."""
        most = min(self._wanted, room, self._longest)
        return 1 << (max(1, int(most)).bit_length() - 1)

    def restart(self) -> None:
        """Begin with the smallest step, as at the start."""
        self._wanted = 1.0
        self._before = 1.0

    def accept(self, step: int, error: float) -> None:
        """Choose a next step after one that is kept.

        Parameters
        ----------
        step : int
            That was made; shorter than wanted where there was no room.
        error : float
            As a part of the tolerance.
        """
        error = max(error, _TINY)
        factor = _SAFETY * error ** (-0.7 / self._power) * self._before ** (0.4 / self._power)
        wanted = step * min(_MOST, max(_LEAST, factor))
        was_shortened = 2 * step <= self._wanted and error <= 1.0
        self._wanted = max(wanted, self._wanted) if was_shortened else wanted
        self._wanted = min(max(self._wanted, 1.0), float(self._longest))
        self._before = error

    def reject(self, step: int, error: float) -> None:
        """Choose a shorter step after one that was taken back."""
        factor = _SAFETY * max(error, 1.0) ** (-1.0 / self._power)
        self._wanted = max(1.0, step * min(0.5, max(_LEAST, factor)))

    @property
    def memory(self) -> NDArray[np.float64]:
        """Return what has to be known to go on."""
        return np.array([self._wanted, self._before])

    def recall(self, memory: NDArray[Any]) -> None:
        """Go on from what :attr:`memory` gave."""
        self._wanted, self._before = map(float, memory)
