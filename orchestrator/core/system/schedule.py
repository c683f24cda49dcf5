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
from typing import Literal

Scheme = Literal["sequential", "jacobi"]


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


@dataclass(frozen=True)
class Operation:
    """One action on one component.

    A step goes from ``begin`` by ``length``, in ticks since the period began.
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
    order: Sequence[str], steps: Mapping[str, int], exchange: int, scheme: Scheme
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

    Returns
    -------
    Schedule
    """
    period = lcm(*(max(1, steps[name] // exchange) for name in order))
    return Schedule(
        exchange,
        tuple(_exchange(number, order, steps, exchange, scheme) for number in range(period)),
    )


def _exchange(
    number: int, order: Sequence[str], steps: Mapping[str, int], exchange: int, scheme: Scheme
) -> tuple[Operation, ...]:
    turns = [_turn(number, name, steps[name], exchange) for name in order]
    if scheme == "sequential":
        return tuple(operation for turn in turns for operation in turn)
    return tuple(
        operation
        for action in Action
        for turn in turns
        for operation in turn
        if operation.action is action
    )


def _turn(number: int, name: str, step: int, exchange: int) -> list[Operation]:
    """Return the operations of a component in exchange ``number``."""
    multiple = max(1, step // exchange)
    operations = []
    if number % multiple == 0:
        operations.append(Operation(Action.SET, name))
    if (number + 1) % multiple == 0:
        end = (number + 1) * exchange
        begin = end - max(step, exchange)
        operations += [Operation(Action.STEP, name, at, step) for at in range(begin, end, step)]
        operations.append(Operation(Action.GET, name))
    return operations
