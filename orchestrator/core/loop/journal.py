"""What a run is doing, in a file that outlives the process: which component has the word when the code of an FMU crashes.

A crash (SIGSEGV, ...) ends a process without a word. The loop therefore notes each call before it makes it, in memory that is a
file; and where :func:`reported` says so, the process then becomes another one, which reads the file.
"""

import ctypes
import json
import os
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ..system.clock import to_seconds
from ..system.schedule import Action, Operation
from .machine_code import crash_handler
from .tables import Integers

FILE, LEGEND = "journal.bin", "journal.json"
EXCHANGE, OPERATION = range(2)
"""Places in a journal."""
_NOTHING = -1
_REPORTS = os.name == "posix"
_CRASHES = ("SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE", "SIGABRT")


class Journal:
    """The journal of a run in the folder in which it writes.

    entries: numbers by place. An operation of -1 is none of an FMU; -2, -3, ... are preparations of the first, second, ...
    component.
    """

    def __init__(self, folder: Path, components: Sequence[str]) -> None:
        self._folder, self._components = folder, list(components)
        self.entries: Integers = (
            np.memmap(folder / FILE, np.int64, "w+", shape=(2,))
            if _REPORTS
            else np.zeros(2, np.int64)
        )
        self.entries[:] = _NOTHING
        self.legend([], 0, 0, 1)

    def legend(
        self, operations: Sequence[Operation], start: int, exchange: int, period: int
    ) -> None:
        """Write down what the numbers of operations mean. start, exchange: ticks. period: number of exchanges."""
        (self._folder / LEGEND).write_text(
            json.dumps(
                {
                    "components": self._components,
                    "start": start,
                    "exchange": exchange,
                    "period": period,
                    "operations": [
                        [o.component, int(o.action), o.begin, o.length] for o in operations
                    ],
                }
            ),
            encoding="utf-8",
        )

    def prepares(self, component: str) -> None:
        """Note that a component is being made or initialised."""
        self.entries[OPERATION] = _NOTHING - 1 - self._components.index(component)

    def close(self) -> None:
        """Remove the files: the run has not crashed."""
        self.entries[:] = _NOTHING
        for name in (FILE, LEGEND):
            (self._folder / name).unlink(missing_ok=True)


def last_entry(folder: Path, number_of_signal: int) -> str:
    """What a run that a signal has ended was doing: component, time, call and signal; no component if it was none."""
    how = f"crashed ({signal.Signals(number_of_signal).name})"
    try:
        entries = np.fromfile(folder / FILE, np.int64)
        legend = json.loads((folder / LEGEND).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return f"the run has {how}"
    number, exchange = int(entries[OPERATION]), int(entries[EXCHANGE])
    if number < _NOTHING:
        return (
            f"{legend['components'][_NOTHING - 1 - number]}: its code {how} while it was made ready"
        )
    if number == _NOTHING:
        return f"the run has {how}"
    component, action, begin, length = legend["operations"][number]
    period = exchange // legend["period"] * legend["period"]
    at = {
        Action.STEP: legend["start"] + period * legend["exchange"] + begin,
        Action.RECORD: legend["start"] + (exchange + 1) * legend["exchange"],
    }.get(Action(action), legend["start"] + exchange * legend["exchange"])
    what = {
        Action.SET: "when its inputs were set",
        Action.STEP: f"in the step by {to_seconds(length):.6g} s",
        Action.GET: "when its outputs were read",
        Action.RECORD: "when its outputs were read",
    }[Action(action)]
    return f"{component} at t = {to_seconds(at):.9g} s: its code {how} {what}"


@contextmanager
def reported(command: Sequence[str]) -> Iterator[None]:
    """While this lasts, the process becomes this command when native code crashes, with the number of the signal as one argument
    more. Nothing is done where there is no such thing."""
    if not _REPORTS:
        yield
        return
    handler, libc = crash_handler(command), ctypes.CDLL(None)
    libc.signal.restype, libc.signal.argtypes = ctypes.c_void_p, [ctypes.c_int, ctypes.c_void_p]
    before = [
        (number, libc.signal(number, handler))
        for number in (getattr(signal, name) for name in _CRASHES)
    ]
    try:
        yield
    finally:
        for number, earlier in before:
            libc.signal(number, earlier)
