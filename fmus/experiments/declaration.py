"""An experiment on an FMU, as data: parameters, stimuli, and results that are known beforehand."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

Given = float | str | Sequence[float]
"""Value of a parameter: number, word of an enumeration, or all elements of an array."""
Stimulus = float | Callable[[float], float] | Sequence[float | Callable[[float], float]]
"""Value of an input: constant, function of the time (s), or one of these for each element."""


class Purpose(StrEnum):
    """Purposes of experiments, in the words of FMI-LS-REF."""

    SMOKE = "smoke-test"
    VALIDATION = "validation"
    UNCERTAINTY = "uncertainty-analysis"


@dataclass(frozen=True)
class Expected:
    """Known values of an output.

    Parameters
    ----------
    values : array_like
        A value, one for each row of :attr:`Experiment.times`, or of an array output one row of
        elements for each; a single number holds at all times.
    tolerance : float
        Largest deviation that is right, in the unit of the output.
    """

    values: ArrayLike
    tolerance: float


@dataclass(frozen=True)
class SerializedState:
    """A complete state of the FMU, after the initialisation and before the first step.

    Parameters
    ----------
    name : str
        Names its file.
    content : bytes
        Serialized, as an FMU takes it.
    """

    name: str
    content: bytes = field(repr=False)


@dataclass(frozen=True)
class Experiment:
    """An experiment on an FMU alone.

    Inputs are set at each communication point and held over the step that begins there.

    Parameters
    ----------
    name : str
        Its name, which names its files too.
    purpose : Purpose
        Smoke test, validation or analysis of uncertainty.
    description : str
        What is done, where the expected values come from, and why their tolerance is what it is.
    step : float
        Communication step (s).
    steps : int
        Number of steps.
    expected : mapping of str to Expected
        By the name of the output.
    parameters : mapping of str to Given
        Those that differ from the start values.
    inputs : mapping of str to Stimulus
        Those that differ from the start values.
    first : int
        Number of steps before the first comparison.
    every : int
        Number of steps from one comparison to the next.
    state : SerializedState, optional
        Leads to the same results as ``parameters``, without the work of the initialisation.
    """

    name: str
    purpose: Purpose
    description: str
    step: float
    steps: int
    expected: Mapping[str, Expected]
    parameters: Mapping[str, Given] = field(default_factory=dict)
    inputs: Mapping[str, Stimulus] = field(default_factory=dict)
    first: int = 0
    every: int = 1
    state: SerializedState | None = None

    @property
    def stop_time(self) -> float:
        """End of the experiment (s)."""
        return self.steps * self.step

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the comparisons (s)."""
        return rows(self.step, self.steps, self.first, self.every)

    @cached_property
    def references(self) -> dict[str, NDArray[np.float64]]:
        """Expected values of each output at all times of comparison."""
        count = len(self.times)
        found = {}
        for name, expected in self.expected.items():
            values = np.asarray(expected.values, np.float64)
            found[name] = values if values.ndim else np.full(count, float(values))
            if len(found[name]) != count:
                raise ValueError(
                    f"{self.name}: {name} has {len(found[name])} expected values for {count} times"
                )
        return found

    @property
    def tolerance(self) -> float:
        """Largest of the tolerances relative to the largest value that is expected."""
        scales = {name: float(np.abs(v).max()) for name, v in self.references.items()}
        shares = [e.tolerance / scales[n] for n, e in self.expected.items() if scales[n] > 0.0]
        return max(shares, default=0.0)


def rows(step: float, steps: int, first: int = 0, every: int = 1) -> NDArray[np.float64]:
    """Return the times (s) of an experiment's comparisons.

    Parameters
    ----------
    step : float
        Communication step (s).
    steps : int
        Number of steps.
    first, every : int
        As in :class:`Experiment`.

    Returns
    -------
    ndarray
        Times (s).
    """
    return np.arange(first, steps + 1, every, dtype=np.float64) * step


def near(values: ArrayLike, share: float) -> Expected:
    """Return expected values with a tolerance that is a share of the largest of them.

    Parameters
    ----------
    values : array_like
        As in :class:`Expected`.
    share : float
        Tolerance over the largest absolute value.

    Returns
    -------
    Expected
        The values with their tolerance.
    """
    return Expected(values, share * float(np.abs(np.asarray(values, np.float64)).max()))
