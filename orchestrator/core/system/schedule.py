"""The order of exchanges and steps, in whole ticks. Pure functions.

Values move at exchanges. A component whose step divides the exchange step is stepped several times
in each; one whose step is m times the exchange step takes its inputs in the first and is stepped in
the last of m exchanges: it holds its inputs over its own step, and shows its outputs when the
others have reached the same time.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import lcm
from typing import Literal, NamedTuple

Scheme = Literal["sequential", "jacobi"]
NOTHING_EXTRAPOLATED: Mapping[str, bool] = {}
"""Components whose inputs are set for each step, where there are none."""


class Action(IntEnum):
    """An action of the master on a component."""

    SET = 1
    """Set its inputs to the newest values."""
    STEP = 2
    """Advance it."""
    GET = 3
    """Take the values of its outputs."""
    RECORD = 4
    """Read what is recorded besides, after the exchange. In no schedule."""
    EXTRAPOLATE = 5
    """Set its inputs to where their polynomials go in the next step."""


@dataclass(frozen=True)
class Operation:
    """One action on one component.

    A step goes from ``begin`` by ``length``, in ticks since the period began. Inputs are set for
    such a step.
    """

    action: Action
    component: str
    begin: int = 0
    length: int = 0


@dataclass(frozen=True)
class Schedule:
    """Operations of each exchange, which come again after ``period`` exchanges.

    Attributes
    ----------
    exchange : int
        Exchange step (ticks).
    operations : tuple of tuple of Operation
        For each exchange of a period.
    """

    exchange: int
    operations: tuple[tuple[Operation, ...], ...]

    @property
    def period(self) -> int:
        """Number of exchanges after which the pattern repeats."""
        return len(self.operations)


def fits(step: int, exchange: int) -> bool:
    """Tell whether a step (ticks) divides the exchange step or is a whole multiple of it."""
    return step > 0 and (exchange % step == 0 or step % exchange == 0)


def nearest_steps(step: int, exchange: int) -> list[int]:
    """Return the steps next below and next above a step that fit (ticks)."""
    if step > exchange:
        return [step // exchange * exchange, (step // exchange + 1) * exchange]
    divisors = [
        d for n in range(1, int(exchange**0.5) + 1) if exchange % n == 0 for d in (n, exchange // n)
    ]
    return [max(d for d in divisors if d <= step), min(d for d in divisors if d >= step)]


def make_schedule(
    order: Sequence[str],
    steps: Mapping[str, int],
    exchange: int,
    scheme: Scheme,
    extrapolated: Mapping[str, bool] = NOTHING_EXTRAPOLATED,
) -> Schedule:
    """Order the operations of each exchange.

    Parameters
    ----------
    order : sequence of str
        Components.
    steps : mapping of str to int
        Communication step of each component (ticks).
    exchange : int
        Exchange step (ticks).
    scheme : str
        ``sequential``: one component after the other, each with the newest values there are.
        ``jacobi``: all take the values of the beginning of the exchange, then all step, then all
        show their new outputs.
    extrapolated : mapping of str to bool
        Components whose inputs are set for each of their steps, and whether they show their outputs
        after each of them too.

    Returns
    -------
    Schedule
    """
    period = lcm(*(max(1, steps[name] // exchange) for name in order))
    turns = [
        _Turn(name, steps[name], name in extrapolated, extrapolated.get(name, False))
        for name in order
    ]
    return Schedule(
        exchange, tuple(_exchange(number, turns, exchange, scheme) for number in range(period))
    )


class _Turn(NamedTuple):
    """A component in its turn: its step (ticks), and what is done between two steps."""

    component: str
    step: int
    extrapolates: bool
    shows: bool

    def inputs(self, number: int, exchange: int) -> list[Operation]:
        """Return how its inputs are set in an exchange."""
        if number % max(1, self.step // exchange):
            return []
        begin, length = (number * exchange, self.step) if self.extrapolates else (0, 0)
        return [Operation(Action.SET, self.component, begin, length)]

    def steps(self, number: int, exchange: int) -> list[Operation]:
        """Return its steps in an exchange, and what is done between two of them."""
        if (number + 1) % max(1, self.step // exchange):
            return []
        end = (number + 1) * exchange
        operations: list[Operation] = []
        for at in range(end - max(self.step, exchange), end, self.step):
            if operations and self.shows:
                operations.append(Operation(Action.GET, self.component))
            if operations and self.extrapolates:
                operations.append(Operation(Action.EXTRAPOLATE, self.component, at, self.step))
            operations.append(Operation(Action.STEP, self.component, at, self.step))
        return operations

    def outputs(self, number: int, exchange: int) -> list[Operation]:
        """Return how its outputs are taken at the end of an exchange."""
        if (number + 1) % max(1, self.step // exchange):
            return []
        return [Operation(Action.GET, self.component)]


def _exchange(
    number: int, turns: Sequence[_Turn], exchange: int, scheme: Scheme
) -> tuple[Operation, ...]:
    stages = (_Turn.inputs, _Turn.steps, _Turn.outputs)
    if scheme == "sequential":
        every = [stage(turn, number, exchange) for turn in turns for stage in stages]
    else:
        every = [stage(turn, number, exchange) for stage in stages for turn in turns]
    return tuple(operation for operations in every for operation in operations)
