"""The loop of a run, and what ends it early: a slave that fails, or Ctrl-C."""

import signal
import threading
import time
from collections.abc import Callable, Mapping
from types import FrameType, TracebackType
from typing import Any

from ..errors import RunFailed
from ..fmu.slave import FATAL, STATUS_NAMES, Slave
from ..system.clock import to_seconds
from ..system.plan import Plan
from ..system.schedule import Action, Operation
from .exchange import Driver, Fault, State
from .recording import Recorder, last_words
from .tables import NOT_FINITE

_MOST_AT_ONCE = 1000
_SECONDS_AT_ONCE = 0.1
"""Exchanges between two looks at Ctrl-C, and the time (s) that they should take."""
_GROWTH = 10
"""So many times as many exchanges may follow as came before: what they take may grow."""

Progress = Callable[[float, float], None]
"""Called with the time reached and the stop time (s)."""


class Interruption:
    """Ctrl-C as a flag that the loop asks for. A context manager.

    An exception would be raised wherever Python happens to be, inside an FMU too, which takes it for its own failure. The second
    Ctrl-C is not caught any more.
    """

    def __init__(self) -> None:
        self.requested = False

    def __enter__(self) -> "Interruption":
        self._in_main = threading.current_thread() is threading.main_thread()
        if self._in_main:
            self._before: Any = signal.signal(signal.SIGINT, self._request)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._in_main:
            signal.signal(signal.SIGINT, self._before)

    def _request(self, _signal: int, _frame: FrameType | None) -> None:
        self.requested = True
        signal.signal(signal.SIGINT, self._before)


class Master:
    """Drives slaves that are initialised through a run.

    exchanges: number of exchanges carried out. wall_time: time (s) that they took, snapshots included. cpu_time: that of the
    processor (s). recording_time: time (s) from snapshots to files, and for states.
    """

    def __init__(
        self,
        plan: Plan,
        slaves: Mapping[str, Slave],
        state: State,
        driver: Driver,
        recorder: Recorder,
    ) -> None:
        self._plan, self._slaves, self._state, self._driver, self._recorder = (
            plan,
            slaves,
            state,
            driver,
            recorder,
        )
        self._snapshots = state.snapshots
        self.exchanges, self._at_once = 0, 1
        self.wall_time, self.cpu_time, self.recording_time = 0.0, 0.0, 0.0

    def run(self, interruption: Interruption, progress: Progress | None = None) -> bool:
        """Carry out all exchanges. False if Ctrl-C has ended the run before; rows up to the end are recorded in any case.

        Raises:
            RunFailed: a slave failed, or gave a value that is no finite number.
        """
        began = time.perf_counter()
        try:
            return self._run(interruption, progress)
        finally:
            self._recorder.flush()
            self.recording_time = time.perf_counter() - began - self.wall_time

    def _run(self, interruption: Interruption, progress: Progress | None) -> bool:
        timing, stop = self._plan.timing, self._plan.timing.seconds(self._plan.timing.exchanges)
        self._state.open_accounts()
        self._record()
        self._recorder.frames(0)
        while self.exchanges < timing.exchanges and not interruption.requested:
            due = min(self._recorder.next_frames(self.exchanges), timing.exchanges)
            self._advance(min(due - self.exchanges, self._at_once, self._snapshots.room))
            if self.exchanges == due:
                self._recorder.frames(due)
            if progress is not None:
                progress(timing.seconds(self.exchanges), stop)
        if self.exchanges % self._snapshots.every:
            self._record()
        return self.exchanges == timing.exchanges

    def _record(self) -> None:
        """Write a row now."""
        self._state.journal[:] = self.exchanges - 1, -1
        lost = self._state.record(self._slaves, len(self._snapshots.waiting))
        if lost is not None:
            raise self._failure(
                Fault(self.exchanges - 1, Operation(Action.RECORD, lost[0]), lost[1])
            )
        self._snapshots.waiting.append(self.exchanges)
        self._recorder.look()

    def _advance(self, count: int) -> None:
        began, began_of_thread = time.perf_counter(), time.thread_time()
        fault = self._driver.advance(self.exchanges, count)
        took = time.perf_counter() - began
        self.wall_time += took
        self.cpu_time += time.thread_time() - began_of_thread
        first, self.exchanges = self.exchanges, self.exchanges + count
        if fault is not None:
            recording = fault.operation.action is Action.RECORD
            self.exchanges = fault.exchange + recording
            self._snapshots.waiting.extend(self._snapshots.due(first, self.exchanges - recording))
            raise self._failure(fault)
        self._snapshots.waiting.extend(self._snapshots.due(first, self.exchanges))
        self._recorder.look()
        self._at_once = max(
            1,
            min(
                _MOST_AT_ONCE,
                _GROWTH * self._at_once,
                int(count * _SECONDS_AT_ONCE / max(took, 1e-9)),
            ),
        )

    def _failure(self, fault: Fault) -> RunFailed:
        """What went wrong, with the slave's own words."""
        schedule, operation, timing = self._plan.schedule, fault.operation, self._plan.timing
        name, said = operation.component, last_words(self._slaves[operation.component])
        if fault.status == FATAL:
            self._slaves[name].messages.append((FATAL, "cannot be used any more"))
        if operation.action is Action.RECORD:
            return RunFailed(
                name,
                timing.seconds(fault.exchange + 1),
                self._not_recorded(name)
                if fault.status == NOT_FINITE
                else f"does not give its values ({STATUS_NAMES[fault.status]}): {said}",
            )
        period = (
            timing.start + fault.exchange // schedule.period * schedule.period * schedule.exchange
        )
        if fault.status == NOT_FINITE:
            end = self._state.not_finite(name)
            assert end is not None
            return RunFailed(
                name,
                timing.seconds(fault.exchange + 1),
                f"{end.name} is no finite number: the computation diverges; "
                "reduce the exchange step or the steps of the components connected with it",
            )
        what = {
            Action.SET: "the inputs are refused",
            Action.GET: "the outputs are refused",
            Action.STEP: f"the step by {to_seconds(operation.length):.6g} s failed",
        }[operation.action]
        at = (
            to_seconds(period + operation.begin)
            if operation.action is Action.STEP
            else timing.seconds(fault.exchange)
        )
        return RunFailed(name, at, f"{what} ({STATUS_NAMES[fault.status]}): {said}")

    def _not_recorded(self, name: str) -> str:
        snapshots = self._snapshots
        row = snapshots.rows[len(snapshots.waiting)]
        place = snapshots.lost(row, name)
        return (
            f"{snapshots.ends[place].name} = {row[place]} is no finite number; reduce the steps, or leave the "
            "variable out of the record if it may be so"
        )
