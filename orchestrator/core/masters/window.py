"""The exchanges that are iterated together, and one iteration of them."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..loop.buses import Buses
from ..loop.exchange import Excerpt, ExchangeLoop, Fault
from ..loop.tables import IntegerTable
from ..system.iterated import weights
from ..system.plan import Plan
from ..system.schedule import Action


@dataclass(frozen=True)
class _Given:
    """Values that a component gets for a step: a weighted sum over the exchanges of the window.

    Attributes
    ----------
    slots : array of int
        IntegerTable on the bus of outputs from which its inputs take them.
    sources : array of int
        IntegerTable of the outputs that feed them.
    weights : array of float, shape (slots, period + 1)
        See :func:`~rockshed.core.system.iterated.weights`.
    rows : array of int or None
        The exchange of each, where only one counts.
    """

    slots: IntegerTable
    sources: IntegerTable
    weights: NDArray[np.float64]
    rows: IntegerTable | None

    def fill(self, values: NDArray[np.float64], outputs: NDArray[np.float64]) -> None:
        """Write the values onto the bus, from those at exchanges, a row for each."""
        if self.rows is not None:
            outputs[self.slots] = values[self.rows, self.sources]
        else:
            outputs[self.slots] = np.einsum("ij,ji->i", self.weights, values[:, self.sources])


@dataclass(frozen=True)
class _Stage:
    """Operations of one component that belong to one step, behind the last one its outputs too."""

    component: str
    exchange: int
    given: _Given
    part: Excerpt
    is_last: bool


class Window:
    """All steps of all components in a period of the schedule.

    Parameters
    ----------
    buses : Buses
        Of the run.
    loop : ExchangeLoop
        Between its slaves.

    Attributes
    ----------
    period : int
        Number of exchanges.
    values : array of float, shape (period + 1, outputs)
        Outputs at the beginning, and at the end of each exchange. Those of a component with a
        longer step are there at its ends only.
    nodes : array of bool, same shape
        Where outputs are shown, without the beginning.
    """

    def __init__(self, buses: Buses, loop: ExchangeLoop) -> None:
        plan = buses.plan
        self.period = plan.schedule.period
        self._outputs = buses.outputs
        self._shows = {name: np.array(sorted(buses.shows[name]), np.int64) for name in plan.order}
        self.values = np.zeros((self.period + 1, len(plan.outputs)))
        self.nodes = np.zeros(self.values.shape, np.bool_)
        for name in plan.order:
            every = _every(plan, name)
            self.nodes[every::every, self._shows[name]] = True
        self._stages = _stages(buses, loop)

    @property
    def taken(self) -> Iterator[tuple[str, IntegerTable]]:
        """Yield components, and the outputs of which they take more than the first values."""
        for stage in self._stages:
            given = stage.given
            yield stage.component, given.sources[given.weights[:, 1:].any(axis=1)]

    def begin(self) -> None:
        """Begin with the present outputs."""
        self.values[0] = self._outputs[: self.values.shape[1]]

    def iterate(self, exchange: int) -> Fault | None:
        """Let all components, one after the other, make all steps with the values that there are.

        What they show takes the place of these values at once.

        Parameters
        ----------
        exchange : int
            Number of exchanges before the window.

        Returns
        -------
        Fault or None
            The operation that failed.
        """
        for stage in self._stages:
            fault = self._carry_out(stage, exchange)
            if fault is not None:
                return fault._replace(exchange=exchange + stage.exchange)
            if stage.is_last:
                shown = self._shows[stage.component]
                self.values[stage.exchange + 1, shown] = self._outputs[shown]
        return None

    def repeat(self, exchange: int, number: int) -> Fault | None:
        """Let components make the steps of one exchange of a window whose values are found.

        Parameters
        ----------
        exchange, number : int
            Number of exchanges before the window, and within it.

        Returns
        -------
        Fault or None
            The operation that failed.
        """
        for stage in self._stages:
            if stage.exchange == number:
                fault = self._carry_out(stage, exchange)
                if fault is not None:
                    return fault._replace(exchange=exchange + number)
        return None

    def _carry_out(self, stage: _Stage, exchange: int) -> Fault | None:
        stage.given.fill(self.values, self._outputs)
        return stage.part.carry_out(exchange)


def _every(plan: Plan, name: str) -> int:
    """Return the number of exchanges after which a component shows new outputs."""
    return max(1, plan.timing.steps[name] // plan.timing.exchange)


def _stages(buses: Buses, loop: ExchangeLoop) -> list[_Stage]:
    """Return the steps of a window, component by component."""
    plan = buses.plan
    own = len(plan.outputs) + len(plan.held)
    is_fed = plan.source < len(plan.outputs)
    source = np.where(is_fed, own + np.arange(plan.source.size), plan.source).astype(np.uint64)
    found: list[_Stage] = []
    number = 0
    for exchange, operations in enumerate(plan.schedule.operations):
        for place, operation in enumerate(operations):
            if operation.action is Action.STEP:
                is_last = operations[place + 1].action is Action.GET
                at = number + place
                step = (operation.begin, operation.begin + operation.length)
                given = _given(plan, own, operation.component, step)
                part = loop.part(at - 1, at + 1 + is_last, source)
                found.append(_Stage(operation.component, exchange, given, part, is_last))
        number += len(operations)
    return sorted(found, key=lambda stage: plan.order.index(stage.component))


def _given(plan: Plan, own: int, name: str, step: tuple[int, int]) -> _Given:
    """Return what a component gets for a step (ticks since the window began)."""
    assert plan.iteration is not None
    exchange = plan.timing.exchange
    times = (step[0] / exchange, step[1] / exchange)
    fed = [
        place
        for place, end in enumerate(plan.inputs)
        if end.component == name and plan.source[place] < len(plan.outputs)
    ]
    sources = plan.source[fed]
    table = np.zeros((len(fed), plan.schedule.period + 1))
    for row, (place, source) in enumerate(zip(fed, sources)):
        every = _every(plan, plan.outputs[source].component)
        moment = plan.iteration.moments[place]
        order = plan.system.iteration.interpolation
        table[row] = weights(moment, times, every, plan.schedule.period, order)
    is_one = np.all(
        (table.max(axis=1, initial=0.0) == 1.0) & (np.count_nonzero(table, axis=1) == 1)
    )
    rows = table.argmax(axis=1) if is_one else None
    return _Given(own + np.array(fed, np.int64), sources, table, rows)
