"""A process that watches over another one: native code of an FMU may end the process it runs in.

Where a process can be forked, everything is done in the child while its parent waits; a crash of
the child costs nothing but the run, and the parent says how it ended and keeps what was computed.
The fork comes before anything else, as long as there is one thread and little memory.
"""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

_NOTE = "ROCKSHED_SUPERVISOR_NOTE"
"""Environment variable with the path to which the child writes the folder of its run."""
_MOST_BYTES = 65536
"""Length (bytes) of the longest path that the parent reads."""
_CRASHES = ("SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE", "SIGABRT", "SIGKILL")
"""Signals after which the parent reports. SIGKILL is that of a system without memory."""
_PASSED_ON = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals that are meant for the child, whichever process they are sent to."""
_FIRST_EXCEPTION = 0xC0000000
"""Smallest exit code with which Windows ends a process that has crashed."""

Report = Callable[[Path | None, str], int]
"""Called in the parent with the folder of the run, if there is one, and the name of the signal.

Returns the exit code of the command.
"""


def supervised(work: Callable[[], None], command: Sequence[str], report: Report) -> None:
    """Do something in a process of its own, and report how that ended if it crashed.

    The child goes on behind this call as an unsupervised process would; the parent ends with the
    exit code of the child. Ctrl-C and requests to terminate reach the child.

    Parameters
    ----------
    work : callable
        Done in the child. Without supervision, where other threads run already, done here.
    command : sequence of str
        Command that does the same, for systems where processes are not forked.
    report : Report
        Called in the parent after a crash.
    """
    if _NOTE in os.environ or threading.active_count() > 1:
        work()
    elif hasattr(signal, "sigwaitinfo"):
        _forked(work, report)
    else:
        _spawned(command, report)


def announce(folder: Path) -> None:
    """Tell the supervisor, if there is one, where results are about to be written.

    Parameters
    ----------
    folder : Path
        Folder of the run.
    """
    note = os.environ.pop(_NOTE, None)
    if note is not None:
        with open(note, "wb") as stream:
            stream.write(os.fsencode(folder.absolute()))


def _forked(work: Callable[[], None], report: Report) -> None:
    watched = {signal.SIGCHLD, *(getattr(signal, name) for name in _PASSED_ON)}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, watched)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        os.close(reading)
        os.environ[_NOTE] = f"/dev/fd/{writing}"
        _end_with_parent()
        work()
        return
    os.close(writing)
    status = _wait(child, watched)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    if os.WIFEXITED(status):
        os._exit(os.WEXITSTATUS(status))  # nothing was done here that has to be tidied up
    told = b""
    os.set_blocking(reading, False)
    with suppress(BlockingIOError):  # nothing was told, and a child of the child is still there
        told = os.read(reading, _MOST_BYTES)
    _report_signal(os.WTERMSIG(status), told, report)


def _wait(child: int, watched: set[signal.Signals]) -> int:
    """Return the status with which a child ended; pass on what was sent to this process alone.

    Ctrl-C at a terminal is sent to both processes, by the system and not by a process.
    """
    while True:
        told = signal.sigwaitinfo(watched)
        if told.si_signo == signal.SIGCHLD:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                return status
        elif told.si_code <= 0:  # sent by a process
            os.kill(child, told.si_signo)


def _end_with_parent() -> None:
    """Have the system end this process as soon as the parent is killed."""
    import ctypes

    set_parent_death_signal = 1
    ctypes.CDLL(None).prctl(set_parent_death_signal, int(signal.SIGKILL))


def _report_signal(number: int, told: bytes, report: Report) -> NoReturn:
    """End as the child has ended, with a report if that was a crash."""
    name = signal.Signals(number).name
    if name in _CRASHES:
        sys.exit(report(Path(os.fsdecode(told)) if told else None, name))
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    sys.exit(128 + number)


def _spawned(command: Sequence[str], report: Report) -> NoReturn:
    import tempfile

    with tempfile.TemporaryDirectory(prefix="rockshed_") as folder:
        note = Path(folder, "note")
        child = subprocess.Popen(command, env={**os.environ, _NOTE: str(note)})
        signal.signal(signal.SIGTERM, lambda *_: child.terminate())
        code = None
        while code is None:
            try:
                code = child.wait()
            except KeyboardInterrupt:  # the terminal has told the child as well
                continue
        told = note.read_bytes() if note.is_file() else b""
    if code < 0:
        _report_signal(-code, told, report)
    if code >= _FIRST_EXCEPTION:
        sys.exit(report(Path(os.fsdecode(told)) if told else None, f"exception 0x{code:X}"))
    sys.exit(code)
