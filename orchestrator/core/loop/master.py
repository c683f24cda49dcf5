"""The course of a run, and what ends it early: a slave that fails or ends, or Ctrl-C."""

import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from types import FrameType, TracebackType
from typing import Protocol

from ..ending import asked_to_end
from ..errors import RunFailed
from ..fmu.slave import DISCARD, FATAL, Slave, status_name
from ..system.schedule import Action
from .buses import Buses, unfit_text
from .driver import Driver
from .exchange import Fault
from .ledger import Advice
from .recording import Recorder, last_words
from .tables import ENDED, NOT_FINITE, NOT_FITTING, STUCK, IntegerTable

_MOST_AT_ONCE = 1000
"""Exchanges between two looks at Ctrl-C."""
_SECONDS_AT_ONCE = 0.1
"""Time (s) between two looks at Ctrl-C."""
_GROWTH = 10
"""So many times as many exchanges may follow as came before: what they take may grow."""

Progress = Callable[[float, float], None]
"""Called with the time reached and the stop time (s)."""


class Interruption:
    """Ctrl-C or a request to terminate as a flag that the master asks for. A context manager.

    An exception would be raised wherever Python happens to be, inside an FMU too, which takes it
    for its own failure. The second request is not caught any more.
    """

    def __init__(self) -> None:
        self.requested = False

    def __enter__(self) -> "Interruption":
        self._opened = ExitStack()
        self._put_back = self._opened.enter_context(asked_to_end(self._request))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._opened.close()

    def _request(self, _signal: int, _frame: FrameType | None) -> None:
        self.requested = True
        self._put_back()

    def look(self) -> None:
        """Raise the exception of Ctrl-C if the end was requested: nothing is there to be kept.

        Raises
        ------
        KeyboardInterrupt
            Between two calls of FMUs while they are made ready.
        """
        if self.requested:
            raise KeyboardInterrupt


class Keeper(Protocol):
    """Interface of what is done between two exchanges, at some numbers of them."""

    def next(self, exchange: int) -> int:
        """Return the number of exchanges, more than these, after which something is due."""

    def look(self, exchange: int) -> None:
        """Do what is due after this number of exchanges."""


class Master:
    """Drives initialised slaves through a run.

    Parameters
    ----------
    slaves : mapping of str to Slave
        By component.
    buses : Buses
        With the values after the initialisation.
    recorder : Recorder
        Takes what is to be kept.
    driver : Driver
        Carries out the exchanges.
    keepers : sequence of Keeper
        Called between exchanges in this order, when rows and states have been recorded.
    advice : Advice
        Says what may be done about values that are no finite numbers.

    Attributes
    ----------
    exchanges : int
        Number of exchanges carried out.
    wall_time, cpu_time : float
        Time (s) that they took, snapshots included; that of the processor.
    recording_time : float
        Time (s) from snapshots to files, and for states and checkpoints.
    reached : float
        Simulated time reached (s).
    ended_by : str
        Component that has ended the run before its stop time; empty if none has.
    """

    def __init__(
        self,
        slaves: Mapping[str, Slave],
        buses: Buses,
        recorder: Recorder,
        driver: Driver,
        keepers: Sequence[Keeper] = (),
        advice: Advice = lambda at, otherwise: otherwise,
    ) -> None:
        self._plan = buses.plan
        self._slaves = slaves
        self._buses = buses
        self._recorder = recorder
        self._keepers = keepers
        self._advice = advice
        self.driver = driver
        self._loop = driver.loop
        self._has_begun = False
        self._began: float | None = None
        self._ended: float | None = None
        self._recorded_before = 0.0
        self._at_once = 1
        self.exchanges = 0
        self.wall_time = 0.0
        self.cpu_time = 0.0
        self.ended_by = ""
        self._ended_at = 0.0

    @property
    def reached(self) -> float:
        """Return the simulated time reached (s)."""
        return self._ended_at if self.ended_by else self._plan.timing.seconds(self.exchanges)

    @property
    def warned(self) -> Counter[str]:
        """Return how often calls of each component had the status Warning."""
        return self._loop.warned

    @property
    def warned_table(self) -> IntegerTable:
        """Return the counts of the loop, one for each operation."""
        return self._loop.warned_table

    @property
    def returned_table(self) -> IntegerTable:
        """Return the early returns that the loop has counted, one for each operation."""
        return self._loop.returned_table

    @property
    def recording_time(self) -> float:
        """Return the time (s) from snapshots to files, and for states and checkpoints."""
        if self._began is None:
            return self._recorded_before
        until = time.perf_counter() if self._ended is None else self._ended
        return until - self._began - self.wall_time

    @property
    def times(self) -> dict[str, float]:
        """Return the times (s) that exchanges and records have taken."""
        return {
            "exchanges": self.wall_time,
            "cpu": self.cpu_time,
            "recording": self.recording_time,
        }

    def go_to(self, exchange: int, times: Mapping[str, float]) -> None:
        """Begin after exchanges that an earlier process has carried out.

        Parameters
        ----------
        exchange : int
            Number of exchanges, whose rows have been recorded.
        times : mapping of str to float
            :attr:`times` of that process (s).
        """
        self.exchanges = exchange
        self._has_begun = True
        self.wall_time = float(times["exchanges"])
        self.cpu_time = float(times["cpu"])
        self._recorded_before = float(times["recording"])

    @property
    def returned(self) -> Counter[str]:
        """Return how often a step of each component has ended early, at an event."""
        return self._loop.returned

    def run(self, interruption: Interruption, progress: Progress | None = None) -> bool:
        """Carry out all exchanges. Rows up to the end are recorded in any case.

        Parameters
        ----------
        interruption : Interruption
            Ends the run when it is requested.
        progress : callable, optional
            Called now and then with the time reached and the stop time (s).

        Returns
        -------
        bool
            False if the run was interrupted.

        Raises
        ------
        RunFailed
            A slave failed, or gave a value that is no finite number.
        """
        self._began = time.perf_counter() - self.wall_time - self._recorded_before
        try:
            is_complete = self._run(interruption, progress)
        except BaseException:
            with suppress(RunFailed):  # what has failed first is told
                self._recorder.flush()
            raise
        else:
            self._recorder.flush()
            return is_complete
        finally:
            self._ended = time.perf_counter()

    def _run(self, interruption: Interruption, progress: Progress | None) -> bool:
        timing = self._plan.timing
        stop = timing.seconds(timing.exchanges)
        snapshots = self._buses.snapshots
        self.driver.begin()
        if not self._has_begun:
            self._buses.open_accounts()
            self._record()
            self._look(0)
        while self.exchanges < timing.exchanges and not interruption.requested:
            nexts = (keeper.next(self.exchanges) for keeper in self._keepers)
            due = min(self._recorder.next_frames(self.exchanges), timing.exchanges, *nexts)
            count = min(due - self.exchanges, snapshots.room)
            self._advance(self.driver.portion(self.exchanges, count, self._at_once))
            if self.ended_by:
                self._record_end()
                return True
            if self.exchanges == due or self.driver.halted_after is not None:
                self._look(self.exchanges)
            if progress is not None:
                progress(timing.seconds(self.exchanges), stop)
        if self.exchanges % snapshots.every:
            self._record()
        return self.exchanges == timing.exchanges

    def _look(self, exchange: int) -> None:
        """Record states, and do what else is due after this number of exchanges."""
        self._recorder.frames(exchange)
        for keeper in self._keepers:
            keeper.look(exchange)

    def _record(self) -> None:
        """Take a row of the present values."""
        fault = self.driver.record(self.exchanges)
        if fault is not None:
            raise self._failure(fault) from fault.cause
        self._buses.snapshots.waiting.append(self.exchanges)
        self._recorder.look()

    def _record_end(self) -> None:
        """Take a row at the time at which a component has ended the run, if it is a new one."""
        timing = self._plan.timing
        last = self.exchanges - self.exchanges % self._buses.snapshots.every
        if self._ended_at <= timing.seconds(last):
            return
        self._recorder.flush()
        self._buses.take(self._slaves[self.ended_by])
        self._recorder.ended_at = self._ended_at
        self._record()

    def _advance(self, count: int) -> None:
        began = time.perf_counter()
        began_of_thread = time.thread_time()
        fault = self.driver.advance(self.exchanges, count)
        took = time.perf_counter() - began
        self.wall_time += took
        self.cpu_time += time.thread_time() - began_of_thread
        self._arrive(self.driver.halted_after or count, fault)
        if fault is not None and not self._is_end(fault):
            raise self._failure(fault) from fault.cause
        self._recorder.look()
        in_time = int(count * _SECONDS_AT_ONCE / max(took, 1e-9))
        self._at_once = max(1, min(_MOST_AT_ONCE, _GROWTH * self._at_once, in_time))

    def _is_end(self, fault: Fault) -> bool:
        """Tell whether a slave wants to end the run in a step."""
        at = self._wants_end_at(fault)
        if at is None:
            return False
        self.ended_by = fault.operation.component
        self._ended_at = min(max(at, self._time(fault)), self._time(fault, 1.0))
        return True

    def _wants_end_at(self, fault: Fault) -> float | None:
        """Return the time (s) that a step has reached in which a slave wants to end the run.

        One of FMI 3.0 says so in the step, one of FMI 2.0 is asked when it has discarded a step.
        """
        if fault.status == ENDED:
            return self._loop.reached
        if fault.status != DISCARD or fault.operation.action is not Action.STEP:
            return None
        ask = getattr(self._slaves[fault.operation.component], "terminated_at", None)
        return ask() if ask else None

    def _arrive(self, count: int, fault: Fault | None) -> None:
        """Count exchanges and the rows that were taken in them, up to a fault."""
        first = self.exchanges
        self.exchanges = first + count
        rows_until = self.exchanges
        if fault is not None:
            recording = fault.operation.action is Action.RECORD
            self.exchanges = fault.exchange + recording
            rows_until = fault.exchange
        snapshots = self._buses.snapshots
        snapshots.waiting.extend(snapshots.due(first, rows_until))

    def _failure(self, fault: Fault) -> RunFailed:
        """Say what went wrong, in the slave's own words."""
        name = fault.operation.component
        said = last_words(self._slaves[name])
        if fault.what:
            return RunFailed(name, self._time(fault), fault.what)
        messages = self._slaves[name].messages
        if fault.status == FATAL and all(status != FATAL for status, _ in messages):
            messages.append((FATAL, "cannot be used any more"))
        if fault.status == NOT_FINITE:
            return RunFailed(name, self._plan.timing.seconds(fault.exchange + 1), self._lost(fault))
        if fault.status == NOT_FITTING:
            return RunFailed(name, self._time(fault), self._unfit(fault))
        if fault.status == STUCK:
            at = self._loop.reached
            return RunFailed(name, at, "the step returned early there again and again")
        what = f"{self._what(fault)} ({status_name(fault.status)}): {said}"
        return RunFailed(name, self._time(fault), what)

    def _what(self, fault: Fault) -> str:
        length = self._plan.timing.lasts(fault.operation.length)
        return {
            Action.SET: "the inputs are refused",
            Action.EXTRAPOLATE: "the extrapolated inputs are refused",
            Action.GET: "the outputs are refused",
            Action.STEP: f"the step by {length:.6g} s failed",
            Action.RECORD: "does not give its values",
        }[fault.operation.action]

    def _time(self, fault: Fault, part: float = 0.0) -> float:
        """Return the time (s) at which an operation failed, or after a part of a step."""
        schedule = self._plan.schedule
        timing = self._plan.timing
        if fault.operation.action in (Action.GET, Action.RECORD):
            return timing.seconds(fault.exchange + 1)
        if fault.operation.action is not Action.STEP:
            return timing.seconds(fault.exchange)
        period = fault.exchange // schedule.period * schedule.period
        ticks = fault.operation.begin + round(part * fault.operation.length)
        return timing.lasts(timing.start + period * schedule.exchange + ticks)

    def _unfit(self, fault: Fault) -> str:
        """Name the value that a type cannot hold."""
        component, action = fault.operation.component, fault.operation.action
        if action is Action.RECORD:
            snapshots = self._buses.snapshots
            row = snapshots.rows[len(snapshots.waiting)]
            place = snapshots.unfit(row, component)
            end = snapshots.ends[place]
            return f"{unfit_text(end, row[place])}: leave it out of the record"
        found = self._buses.unfit(component, action)
        assert found is not None
        return unfit_text(*found)

    def _lost(self, fault: Fault) -> str:
        """Name the value that is no finite number, and say what may be done about it."""
        name = fault.operation.component
        at = self._plan.timing.seconds(fault.exchange + 1)
        if fault.operation.action is not Action.RECORD:
            end = self._buses.not_finite(name)
            assert end is not None
            steps = "reduce the exchange step or the steps of the components connected with it"
            return (
                f"{end.name} is no finite number: the computation diverges; "
                f"{self._advice(at, steps)}"
            )
        snapshots = self._buses.snapshots
        row = snapshots.rows[len(snapshots.waiting)]
        place = snapshots.lost(row, name)
        return (
            f"{snapshots.ends[place].name} = {row[place]} is no finite number; "
            f"{self._advice(at, 'reduce the steps')}, or leave the variable out of the record if "
            "it may be so"
        )
