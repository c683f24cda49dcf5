"""The implicit master: each exchange is repeated until the values of all components fit together.

An iteration sets components back to the beginning of the exchange, and lets one after the other
make its steps, with the newest values of those before it and a guess of those behind it. When what
comes back is the guess, up to a tolerance, nobody has acted on a value of the past.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fmu.slave import Slave, status_name
from ..loop.buses import Buses
from ..loop.driver import Driver
from ..loop.exchange import ExchangeLoop, Fault
from ..loop.recording import last_words
from ..loop.tables import UNCONVERGED
from ..results.metric import Metric
from ..results.run_folder import Column
from ..system.schedule import Action, Operation
from .acceleration import acceleration_of
from .guesses import FirstGuess, Unknowns
from .residuals import History, Residuals
from .rollback import Rollback, prove_rollback
from .window import Window

COLUMN = "coupling.iterations"
"""Name of the column with the number of iterations."""
_FMI_STATUSES = range(6)


class Implicit(Driver):
    """Repeats exchanges until their values fit together.

    Parameters
    ----------
    buses : Buses
        With the values after the initialisation.
    slaves : mapping of str to Slave
        Initialised.

    Raises
    ------
    InputRefused
        Components that do not come back to earlier states, by name.
    """

    def __init__(self, buses: Buses, slaves: Mapping[str, Slave]) -> None:
        super().__init__(ExchangeLoop(buses, slaves))
        prove_rollback(buses, slaves, self.loop, "the implicit master")
        plan = buses.plan
        self._buses = buses
        self._slaves = slaves
        self._rules = plan.system.iteration
        self._rollback = Rollback(slaves)
        self._window = Window(buses, self.loop)
        self._unknowns = Unknowns(plan, self._window)
        self._predictor = FirstGuess(len(plan.outputs))
        self._acceleration = acceleration_of(self._rules.method, self._unknowns.columns.size)
        self._residuals = Residuals(plan, self._window, self._unknowns)
        self._history = History(len(self._residuals.interfaces.names), self._rules.most)
        self._at_end = self.loop.accounts()
        self._apart = _not_of_the_end(buses)
        self._left_open = np.zeros(1, np.int64)
        self._done: list[tuple[int, int]] = []

    # ------------------------------------------------------------------ exchanges

    def advance(self, first: int, count: int) -> Fault | None:
        """Carry out exchanges until the first one that fails."""
        every = self._buses.snapshots.every
        for exchange in range(first, first + count):
            fault = self._exchange(exchange)
            if fault is None:
                self._show_ways()
                fault = self._at_end.carry_out(exchange, exchange // every - first // every)
            if fault is not None:
                return fault
        return None

    def _exchange(self, exchange: int) -> Fault | None:
        """Carry out an exchange without its accounts."""
        number = exchange % self._window.period
        try:
            if number == 0:
                fault = self._solve(exchange)
                if fault is not None or self._window.period == 1:
                    return fault
                self._go_back()
            return self._window.repeat(exchange - number, number)
        except RuntimeError as error:
            return Fault(
                exchange, self._step_of(next(iter(self._slaves))), UNCONVERGED, None, str(error)
            )

    def _show_ways(self) -> None:
        """Let the ledger see the ways of an exchange where inputs are not those of its end.

        A giver that is shown the middle of a step has the force of the middle: its work is that
        force times the whole way, as for a spring.
        """
        channels = self._buses.channels
        shown = self._apart
        outputs = self._buses.outputs
        self._buses.inputs[channels["seen"][shown]] = outputs[channels["position"][shown]]
        channels["last_force"][shown] = outputs[channels["force"][shown]]

    def _solve(self, exchange: int) -> Fault | None:
        """Iterate a window; its components and outputs are then at its end."""
        self._window.begin()
        self._predictor.predict(self._window)
        self._acceleration.begin()
        self._residuals.begin()
        self._history.of_window.clear()
        returned = self.loop.returned_table.copy()
        self._rollback.mark()
        for iteration in range(self._rules.most):
            if iteration:
                self._rollback.roll_back()
                self.loop.returned_table[:] = returned
            given = self._window.values.copy()
            fault = self._window.iterate(exchange)
            if fault is not None:
                return self._refused(fault, iteration)
            if self._fit(given):
                self._accept(exchange)
                return None
            if iteration + 1 < self._rules.most:
                self._guess(given)
        return self._not_found(exchange)

    def _fit(self, given: NDArray[np.float64]) -> bool:
        """Tell whether the values of the window fit together."""
        residuals = self._residuals.find(given)
        self._history.of_window.append(residuals)
        return bool(np.all(residuals <= 1.0))

    def _guess(self, given: NDArray[np.float64]) -> None:
        """Replace what is guessed among the values of the window."""
        values = self._window.values
        if self._unknowns.columns.size:
            guess = self._unknowns.of_values(given)
            result = self._unknowns.of_values(values)
            scale = self._residuals.scale()
            self._unknowns.enter(values, self._acceleration.next(guess, result, scale))

    def _accept(self, exchange: int) -> None:
        """Keep what a window has taught."""
        self._residuals.learn()
        self._predictor.learn(self._window)
        number = self._history.end(exchange)
        self._done += [(exchange + i + 1, number) for i in range(self._window.period)]

    def _go_back(self) -> None:
        """Go back to the beginning of a window whose values have been found."""
        self._rollback.roll_back()
        self._buses.outputs[: len(self._buses.plan.outputs)] = self._window.values[0]

    # ------------------------------------------------------------------ failures

    def _not_found(self, exchange: int) -> Fault | None:
        """Say what does not fit together, or go on where that was asked for."""
        if self._rules.unconverged == "continue":
            self._left_open += 1
            self._accept(exchange)
            return None
        self._history.end(exchange)
        residuals = self._history.of_window[-1]
        source, targets = self._residuals.interfaces.names[int(np.argmax(residuals))]
        first = float(np.max(self._history.of_window[0]))
        what = (
            f"the iteration does not converge: after {self._rules.most} iterations {source} -> "
            f"{targets} still changes by {np.max(residuals):.3g} times its tolerance (by "
            f"{first:.3g} times after the first); reduce the exchange step, raise iteration.most, "
            "choose another iteration.method, or a larger tolerance"
        )
        component = self._owner(source)
        return Fault(exchange, self._step_of(component), UNCONVERGED, None, what)

    def _owner(self, source: str) -> str:
        names = [name for name in self._slaves if source.startswith(f"{name}.")]
        return max(names, key=len)

    def _step_of(self, component: str) -> Operation:
        return next(
            operation
            for operation in self._buses.operations
            if operation.component == component and operation.action is Action.STEP
        )

    def _refused(self, fault: Fault, iteration: int) -> Fault:
        """Say that values were refused that are a guess."""
        if iteration == 0 or fault.status not in _FMI_STATUSES:
            return fault
        slave = self._slaves[fault.operation.component]
        ends = getattr(slave, "terminated_at", None)
        if ends and ends() is not None:
            return fault
        action = "the inputs are" if fault.operation.action is Action.SET else "the step is"
        what = (
            f"{action} refused in iteration {iteration + 1}, with values that are a guess "
            f"({status_name(fault.status)}): {last_words(slave)}; reduce the exchange step, or "
            "choose another iteration.method"
        )
        return fault._replace(what=what)

    # ------------------------------------------------------------------ what it has to tell

    @property
    def columns(self) -> list[Column]:
        """Return the column with the number of iterations."""
        return [Column(COLUMN, "1", "most iterations of an exchange since the row before")]

    def values(self, exchanges: Sequence[int]) -> NDArray[np.float64]:
        """Return the largest number of iterations since the row before, for each row."""
        rows = np.zeros((len(exchanges), 1))
        for row, exchange in enumerate(exchanges):
            rows[row] = max((n for at, n in self._done if at <= exchange), default=0)
            self._done = [(at, n) for at, n in self._done if at > exchange]
        return rows

    @property
    def warnings(self) -> list[str]:
        """How many exchanges were left with values that do not fit together."""
        count = int(self._left_open[0])
        if not count:
            return []
        times = "once" if count == 1 else f"{count} times"
        return [
            f"the iteration has not converged {times} within {self._rules.most} iterations, and "
            "went on: the values of these exchanges do not fit together"
        ]

    def metrics(self) -> list[Metric]:
        """Return mean, most and distribution of the iterations."""
        counts = self._history.counts
        windows = max(1, int(counts.sum()))
        numbers = np.arange(counts.size)
        what = "an exchange" if self._window.period == 1 else "a window"
        which = "exchanges" if self._window.period == 1 else "windows"
        return [
            Metric(f"iterations of {what}, mean", float(counts @ numbers) / windows),
            Metric(f"iterations of {what}, most", int(max(np.flatnonzero(counts), default=0))),
            *(
                Metric(f"{which} with {number} iteration{'s' if number > 1 else ''}", int(count))
                for number, count in enumerate(counts)
                if count
            ),
        ]

    def facts(self) -> dict[str, Any]:
        """Return residuals for the provenance."""
        names = self._residuals.interfaces.names
        plan = self._buses.plan
        counts = self._history.counts
        return {
            "iteration": {
                "window": self._window.period,
                "connections": [{"source": s, "targets": t.split(", ")} for s, t in names],
                "iterations": {str(n): int(c) for n, c in enumerate(counts) if c},
                "windows": self._history.told(plan.timing.seconds),
            }
        }

    # ------------------------------------------------------------------ checkpoints

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return what has been learned, and what is on its way."""
        waiting = max((number for _, number in self._done), default=0)
        known = {
            "values": self._window.values.ravel().copy(),
            "left_open": self._left_open,
            "waiting": np.array([waiting], np.int64),
        }
        for part in (self._predictor, self._acceleration, self._residuals, self._history):
            known |= part.memory()
        return {f"iteration_{name}": array.copy() for name, array in known.items()}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what :meth:`memory` gave."""
        prefix = "iteration_"
        known = {k.removeprefix(prefix): v for k, v in memory.items() if k.startswith(prefix)}
        self._window.values[:] = known["values"].reshape(self._window.values.shape)
        self._left_open = known["left_open"].copy()
        self._done = [(0, int(known["waiting"][0]))]
        for part in (self._predictor, self._acceleration, self._residuals, self._history):
            part.recall(known)


def _not_of_the_end(buses: Buses) -> NDArray[np.int64]:
    """Return the channels of the ledger whose giver is shown another moment than the end."""
    assert buses.plan.iteration is not None
    moments = buses.plan.iteration.moments
    seen = enumerate(buses.channels["seen"].tolist())
    return np.array([i for i, at in seen if at >= 0 and moments[at] != "end"], np.int64)
