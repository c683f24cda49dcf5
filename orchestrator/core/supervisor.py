"""A process that watches over another one: native code of an FMU may end the process it runs in.

Where a process can be forked, everything is done in the child while its parent waits; a crash of
the child costs nothing but the run, and the parent says how it ended and keeps what was computed.
The fork comes before anything else, as long as there is one thread and little memory.

The child tells its parent where it writes, that it has heard a request to end, and that it has come
to its own end: code of an FMU may call ``exit``, which looks like an end and is none.
"""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, NoReturn

from ..processes import end_with_parent

_NOTE = "ROCKSHED_SUPERVISOR_NOTE"
"""Environment variable with the path to which the child writes what its parent has to know."""
_notes: list[int] = []
"""File descriptor into which a supervised process writes its notes, if it is one."""
_MOST_BYTES = 1 << 20
"""Most bytes that the parent reads at once."""
_CRASHES = ("SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE", "SIGABRT", "SIGKILL", "SIGSYS", "SIGTRAP")
"""Signals after which the parent reports. SIGKILL is that of a system without memory."""
_PASSED_ON = ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU")
"""Signals that are meant for the child, whichever process they are sent to."""
_FIRST_EXCEPTION = 0xC0000000
"""Smallest exit code with which Windows ends a process that has crashed."""
_AFTER_FIRST = 20.0
"""Time (s) that a child has to hear the first Ctrl-C. A kernel that prepares a large layer of sand
hears nothing for minutes, and has nothing to lose yet."""
_AFTER_SECOND = 1.0
"""Time (s) that a child has after the second Ctrl-C, if it has not heard the first one."""
_AFTER_TERMINATION = 5.0
"""Time (s) that a child has to hear a request that comes from no terminal."""
_HEARD, _DONE = "heard", "done"
INTERRUPTED = "did not return when the run was interrupted"
"""Reason of an end by the parent itself."""


@dataclass(frozen=True)
class Ending:
    """The end of a child that did not come to its own end.

    Attributes
    ----------
    reason : str
        Name of the signal, exit code, or :data:`INTERRUPTED`.
    facts : mapping
        Told by the child with :func:`announce`.
    """

    reason: str
    facts: Mapping[str, Any] = field(default_factory=dict)

    @property
    def interrupted(self) -> bool:
        """Tell whether the parent has ended the child on request."""
        return self.reason == INTERRUPTED


Report = Callable[[Ending], int]
"""Called in the parent with the end of the child. Returns the exit code of the command."""


def supervised(work: Callable[[], None], command: Sequence[str], report: Report) -> None:
    """Do something in a process of its own, and report how that ended if it crashed.

    The child goes on behind this call as an unsupervised process would; the parent ends with the
    exit code of the child. Ctrl-C and requests to terminate reach the child. One that does not
    hear them, in code that does not return, is ended: some seconds after a request to terminate,
    later after the first Ctrl-C, and soon after the second one.

    Parameters
    ----------
    work : callable
        Done in the child. Without supervision, where other threads run already, done here.
    command : sequence of str
        Command that does the same, for systems where processes are not forked.
    report : Report
        Called in the parent after a crash.
    """
    note = os.environ.pop(_NOTE, None)
    if note is not None:
        _notes.append(os.open(note, os.O_WRONLY | os.O_APPEND))
        _to_the_end(work)
    elif threading.active_count() > 1:
        work()
    elif hasattr(signal, "sigtimedwait"):
        _forked(work, report)
    else:
        _spawned(command, report)


def announce(**facts: Any) -> None:
    """Tell the supervisor, if there is one, what it needs to report a crash.

    Parameters
    ----------
    **facts
        Plain data; later facts replace earlier ones of the same name.
    """
    tell(json.dumps(facts))


def tell(word: str) -> None:
    """Write a line for the supervisor, if there is one."""
    for note in _notes:
        with suppress(OSError):
            os.write(note, f"{word}\n".encode())


def _to_the_end(work: Callable[[], None]) -> None:
    """Do something, and tell the supervisor that it ended by itself."""
    try:
        work()
    finally:
        tell(_DONE)


def leave(code: int) -> NoReturn:
    """End this process at once. A supervisor learns that this is its own end.

    Parameters
    ----------
    code : int
        Exit code.
    """
    tell(_DONE)
    os._exit(code)


class _Told:
    """Notes of a child, read when there are some."""

    def __init__(self, read: Callable[[], bytes]) -> None:
        self._read = read
        self._content = b""

    @property
    def _lines(self) -> list[str]:
        with suppress(BlockingIOError):  # nothing new, and the child is still there
            self._content += self._read()
        return self._content.decode(errors="replace").splitlines()

    @property
    def heard(self) -> bool:
        """Whether the child has taken notice of the last request to end."""
        return _HEARD in self._lines

    @property
    def done(self) -> bool:
        """Whether the child has come to its end."""
        return _DONE in self._lines

    @property
    def facts(self) -> dict[str, Any]:
        """Facts that the child has told, the later ones over the earlier."""
        told: dict[str, Any] = {}
        for line in self._lines:
            if line.startswith("{"):
                with suppress(ValueError):  # the child died while it wrote
                    told |= json.loads(line)
        return told


@dataclass
class _Requests:
    """Requests to end that have come, and what follows from them."""

    told: _Told
    count: int = 0
    deadline: float = float("inf")

    def enter(self, number: int) -> None:
        """Count a request; the deadline is that of a child that hears none."""
        self.count += 1
        patience = {1: _AFTER_FIRST, 2: _AFTER_SECOND}.get(self.count, 0.0)
        if number != signal.SIGINT:
            patience = _AFTER_TERMINATION
        self.deadline = min(self.deadline, time.monotonic() + patience)

    @property
    def left(self) -> float:
        """Time (s) until the next look at the child."""
        return min(max(self.deadline - time.monotonic(), 0.0), 3600.0)

    def is_deaf(self) -> bool:
        """Tell whether the child is to be ended now; one that has heard is left its time."""
        if time.monotonic() < self.deadline:
            return False
        self.deadline = float("inf")
        return self.count > 2 or not self.told.heard


def _forked(work: Callable[[], None], report: Report) -> None:
    watched = {signal.SIGCHLD, *(getattr(signal, name) for name in _PASSED_ON)}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, watched)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        os.close(reading)
        _notes.append(writing)
        end_with_parent()
        _to_the_end(work)
        return
    os.close(writing)
    os.set_blocking(reading, False)
    told = _Told(lambda: os.read(reading, _MOST_BYTES))
    requests = _Requests(told)
    status, ended_here = _wait(child, watched, requests)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    if ended_here:
        sys.exit(report(Ending(INTERRUPTED, told.facts)))
    if os.WIFEXITED(status):
        if not told.done:
            reason = f"ended the process with the exit code {os.WEXITSTATUS(status)}"
            sys.exit(report(Ending(reason, told.facts)))
        os._exit(os.WEXITSTATUS(status))  # nothing was done here that has to be tidied up
    _report_signal(os.WTERMSIG(status), told.facts, report)


def _wait(child: int, watched: set[signal.Signals], requests: _Requests) -> tuple[int, bool]:
    """Return the status with which a child ended, and whether it was ended here.

    What was sent to this process alone is passed on. Ctrl-C at a terminal is sent to both
    processes, by the system and not by a process.
    """
    killed = False
    while True:
        told = signal.sigtimedwait(watched, requests.left)
        if told is not None and told.si_signo != signal.SIGCHLD:
            requests.enter(told.si_signo)
            if told.si_code <= 0:  # sent by a process
                os.kill(child, told.si_signo)
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status, killed
        if requests.is_deaf():
            killed = True
            os.kill(child, signal.SIGKILL)


def _report_signal(number: int, facts: Mapping[str, Any], report: Report) -> NoReturn:
    """End as the child has ended, with a report if that was a crash."""
    name = signal.Signals(number).name
    if name in _CRASHES:
        sys.exit(report(Ending(name, facts)))
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    sys.exit(128 + number)


def _spawned(command: Sequence[str], report: Report) -> NoReturn:
    from ..temporary import TemporaryFolder

    with TemporaryFolder() as folder:
        note = folder / "note"
        note.touch()
        child = subprocess.Popen(command, env={**os.environ, _NOTE: str(note)})
        signal.signal(signal.SIGTERM, lambda *_: child.terminate())
        told = _Told(note.open("rb").read)
        requests = _Requests(told)
        code = None
        killed = False
        while code is None:
            try:
                code = child.wait(min(requests.left, 1.0))
            except subprocess.TimeoutExpired:
                killed |= _ended_if_deaf(child, requests)
            except KeyboardInterrupt:  # the terminal has told the child as well
                requests.enter(signal.SIGINT)
        facts = told.facts
        done = told.done
    if killed:
        sys.exit(report(Ending(INTERRUPTED, facts)))
    if code < 0:
        _report_signal(-code, facts, report)
    if code >= _FIRST_EXCEPTION:
        sys.exit(report(Ending(f"exception 0x{code:X}", facts)))
    if not done:
        sys.exit(report(Ending(f"ended the process with the exit code {code}", facts)))
    sys.exit(code)


def _ended_if_deaf(child: "subprocess.Popen[bytes]", requests: _Requests) -> bool:
    if not requests.is_deaf():
        return False
    child.kill()
    return True
