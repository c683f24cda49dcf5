"""Exchanges whose length follows the error of the coupling.

The exchange step of the system is the unit: an exchange has 1, 2, 4, ... of them, and ends at the
next row at the latest, so that rows, states and checkpoints stand where they always do.

``doubling``: an exchange of 2 h is held against two of h, after which all FMUs go back; the two
are kept. ``ledger``: the residual of energy of the last exchange decides on the next one, and
nothing is taken back. S. Sadjina, L. T. Kyllingstad, S. Skjong and E. Pedersen, Energy conservation
and power bonds in co-simulations: non-iterative adaptive step size control and error estimation,
Engineering with Computers 33 (2017) 607-620, control with the residual of power in the same way.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import RunFailed
from ..fmu.slave import DISCARD, Slave
from ..loop.buses import Buses
from ..loop.driver import Driver
from ..loop.exchange import ExchangeLoop, Fault
from ..loop.tables import NOT_FINITE
from ..results.metric import Metric
from ..results.run_folder import Column
from .controller import StepController
from .energies import Energies
from .errors import ValueErrors
from .marked import MarkedValues
from .rollback import Rollback, prove_rollback

STEP = "coupling.step"
"""Column of the exchange steps of an adaptive run."""


class AdaptiveDriver(Driver):
    """Chooses the length of each exchange; kinds of it know its error.

    Parameters
    ----------
    loop : ExchangeLoop
        Between the slaves of the run.
    buses : Buses
        With the values after the initialisation.
    goes_back : bool
        Whether FMUs go back to earlier states.
    """

    def __init__(self, loop: ExchangeLoop, buses: Buses, goes_back: bool) -> None:
        super().__init__(loop)
        self._plan = buses.plan
        self._buses = buses
        longest = self._plan.timing.longest
        levels = range(longest.bit_length())
        kept = longest // 2 if goes_back else longest  # the other half is that of the comparison
        self._exchanges = [loop.longer(level, not goes_back) for level in levels]
        self._controller = StepController(kept, 2 + _lowest_order(buses))
        self._linear = self._ways()
        self._counts = _Counts()
        self._steps: list[float] = []

    # ------------------------------------------------------------------ exchanges

    def portion(self, first: int, count: int, at_once: int) -> int:
        """Return how many exchange steps there are until the next row, or before."""
        every = self._plan.timing.output_every
        return min(count, every - first % every)

    def advance(self, first: int, count: int) -> Fault | None:
        """Carry out exchanges over so many exchange steps, up to the next row at most."""
        ways = self._ways()
        if not np.array_equal(ways, self._linear):  # a scenario has changed something
            self._controller.restart()
            self._linear = ways
        self._enter()
        fault = None
        done = 0
        while done < count and fault is None:
            step, fault = self._exchange(first + done, count - done)
            done += step
        if fault is None and (first + done) % self._plan.timing.output_every == 0:
            fault = self.loop.record(first + done)
        return fault

    def _enter(self) -> None:
        """Look at the present values, from which the next exchanges go on."""

    def _exchange(self, begin: int, room: int) -> tuple[int, Fault | None]:
        """Carry out one exchange, or a pair; return its exchange steps."""
        raise NotImplementedError

    def _carry_out(self, begin: int, step: int) -> Fault | None:
        self._counts.made += 1
        return self._exchanges[step.bit_length() - 1].carry_out(begin)

    def _ways(self) -> NDArray[np.float64]:
        """Return factor and offset of the inputs that a scenario may change."""
        return np.stack((self._buses.linear["factor"], self._buses.linear["offset"]))

    def _kept(self, step: int, number: int = 1) -> None:
        """Count exchanges that are kept."""
        self._counts.keep(step, number)

    # ------------------------------------------------------------------ what it has to tell

    @property
    def columns(self) -> list[Column]:
        """Return the column of the steps."""
        return [Column(STEP, "s", "mean length of the exchanges since the row before")]

    def values(self, exchanges: Sequence[int]) -> NDArray[np.float64]:
        """Return the mean length (s) of the exchanges before each row."""
        return np.array([[self._mean_before(exchange)] for exchange in exchanges])

    def _mean_before(self, exchange: int) -> float:
        passed, kept = self._counts.pop(exchange)
        return self._plan.timing.lasts(self._plan.timing.exchange * passed) / max(kept, 1)

    def made(self, exchanges: int) -> int:
        """Return the number of exchanges that were carried out, taken back ones included."""
        return self._counts.made

    def metrics(self) -> list[Metric]:
        """Return number and lengths of the exchanges."""
        counts = self._counts
        unit = self._plan.timing.lasts(self._plan.timing.exchange)
        return [
            Metric("exchanges kept", counts.kept),
            Metric("exchanges taken back", counts.made - counts.kept),
            Metric("steps rejected", counts.rejected),
            Metric("smallest exchange step", unit * counts.smallest, "s"),
            Metric("largest exchange step", unit * counts.largest, "s"),
        ]

    # ------------------------------------------------------------------ checkpoints

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return the state of the controller, counts, and the scenario's last word."""
        return {
            "adaptive_controller": self._controller.memory,
            "adaptive_counts": self._counts.memory,
            "adaptive_ways": self._linear.copy(),
        }

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what :meth:`memory` gave."""
        self._controller.recall(memory["adaptive_controller"])
        self._counts.recall(memory["adaptive_counts"])
        self._linear = memory["adaptive_ways"].copy()


class _Counts:
    """Numbers of exchanges, and those between rows."""

    def __init__(self) -> None:
        self.made = self.kept = self.rejected = self.smallest = self.largest = 0
        self._reached = 0
        self._at_rows: dict[int, int] = {}
        self._last = (0, 0)

    def keep(self, step: int, number: int) -> None:
        """Count exchanges of so many exchange steps each."""
        self.kept += number
        self._reached += number * step
        self.largest = max(self.largest, step)
        self.smallest = min(self.smallest or step, step)
        self._at_rows[self._reached] = self.kept

    def pop(self, exchange: int) -> tuple[int, int]:
        """Return the exchange steps and the exchanges since the row before."""
        kept = self._at_rows.get(exchange, self._last[1])
        steps, exchanges = exchange - self._last[0], kept - self._last[1]
        self._last = (exchange, kept)
        self._at_rows = {at: n for at, n in self._at_rows.items() if at > exchange}
        return steps, exchanges

    @property
    def memory(self) -> NDArray[np.int64]:
        """Return all numbers; all rows have been passed on."""
        numbers = (self.made, self.kept, self.rejected, self.smallest, self.largest)
        return np.array([*numbers, self._reached, *self._last], np.int64)

    def recall(self, memory: NDArray[Any]) -> None:
        """Go on from what :attr:`memory` gave."""
        numbers = list(map(int, memory))
        self.made, self.kept, self.rejected, self.smallest, self.largest = numbers[:5]
        self._reached = numbers[5]
        self._last = (numbers[6], numbers[7])


class DoublingDriver(AdaptiveDriver):
    """Holds an exchange of 2 h against two of h, and keeps the two.

    Parameters
    ----------
    loop : ExchangeLoop
        Between the slaves of the run.
    buses : Buses
        With the values after the initialisation.
    slaves : mapping of str to Slave
        By component.

    Raises
    ------
    InputRefused
        With the FMUs that do not come back to an earlier state.
    """

    def __init__(self, loop: ExchangeLoop, buses: Buses, slaves: Mapping[str, Slave]) -> None:
        super().__init__(loop, buses, goes_back=True)
        prove_rollback(buses, slaves, loop, "an adaptive exchange step by doubling")
        self._rollback = Rollback(slaves)
        self._marked = MarkedValues(buses, loop)
        self._errors = ValueErrors(buses.plan)

    def _exchange(self, begin: int, room: int) -> tuple[int, Fault | None]:
        if room < 2:
            fault = self._carry_out(begin, 1)
            if fault is None:
                self._kept(1)
            return 1, fault
        self._rollback.mark()
        self._marked.mark()
        jumps = self._buses.jumps.copy()
        while True:
            step = self._controller.step(room // 2)
            error, fault = self._pair(begin, step)
            has_jumped = not np.array_equal(jumps, self._buses.jumps)
            failed = fault is not None and fault.status in (DISCARD, NOT_FINITE)
            if step == 1 or not (failed or error > 1.0 or has_jumped):
                break
            self._go_back(begin)
            self._controller.reject(step, error)
            self._counts.rejected += 1
        if fault is not None:
            return 0, fault
        self._errors.learn(self._buses.outputs)
        self._controller.accept(step, error)
        if has_jumped:
            self._controller.restart()
        self._kept(step, 2)
        return 2 * step, None

    def _pair(self, begin: int, step: int) -> tuple[float, Fault | None]:
        """Carry out two exchanges; return the error of one over both as a part of the tolerance."""
        failed = self._carry_out(begin, 2 * step) is not None
        whole = self._buses.outputs.copy()
        self._go_back(begin)
        fault = self._carry_out(begin, step) or self._carry_out(begin + step, step)
        if failed:  # what is too long for that may still do for the two
            return 1.0, fault
        assert self._plan.system.adaptive is not None
        tolerance = self._plan.system.adaptive.tolerance
        return self._errors.of(self._buses.outputs, whole) / tolerance, fault

    def _go_back(self, exchange: int) -> None:
        try:
            self._rollback.roll_back()
        except RuntimeError as error:
            name, _, what = str(error).partition(": ")
            raise RunFailed(name, self._plan.timing.seconds(exchange), what) from error
        self._marked.roll_back()

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return what the controller and the errors know."""
        return {**super().memory(), "adaptive_sizes": self._errors.sizes.copy()}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what :meth:`memory` gave."""
        super().recall(memory)
        self._errors.sizes[:] = memory["adaptive_sizes"]


class LedgerDriver(AdaptiveDriver):
    """Looks at the energy that the couplings have made in the last exchange.

    Parameters
    ----------
    loop : ExchangeLoop
        Between the slaves of the run.
    buses : Buses
        With the values after the initialisation.
    slaves : mapping of str to Slave
        By component.
    """

    def __init__(self, loop: ExchangeLoop, buses: Buses, slaves: Mapping[str, Slave]) -> None:
        super().__init__(loop, buses, goes_back=False)
        self._energies = Energies(buses, slaves)

    def _enter(self) -> None:
        self._energies.enter()

    def _exchange(self, begin: int, room: int) -> tuple[int, Fault | None]:
        step = self._controller.step(room)
        jumps = self._buses.jumps.copy()
        fault = self._carry_out(begin, step)
        if fault is not None:
            return 0, fault
        assert self._plan.system.adaptive is not None
        tolerance = self._plan.system.adaptive.tolerance
        self._controller.accept(step, self._energies.made() / tolerance)
        if not np.array_equal(jumps, self._buses.jumps):
            self._controller.restart()
        self._kept(step)
        return step, None

    def memory(self) -> dict[str, NDArray[Any]]:
        """Return what the controller and the energies know."""
        return {**super().memory(), "adaptive_work": self._energies.largest_work.copy()}

    def recall(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Go on from what :meth:`memory` gave."""
        super().recall(memory)
        self._energies.largest_work[:] = memory["adaptive_work"]


def _lowest_order(buses: Buses) -> int:
    """Return the lowest order of the polynomials that real inputs follow."""
    plan = buses.plan
    orders = {entry.place: entry.order for entry in plan.extrapolated}
    return min(
        (orders.get(place, 0) for place, end, _ in plan.fed if not end.port.is_held), default=0
    )
