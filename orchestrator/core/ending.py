"""Requests to end: Ctrl-C, and the signals by which schedulers, containers and terminals end."""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from .supervisor import tell

SIGNALS = tuple(
    getattr(signal, name)
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU")
    if hasattr(signal, name)
)
"""Signals that ask a process to end. SLURM, Docker and systemd send SIGTERM, a terminal that is
closed SIGHUP, a limit of the time on a processor SIGXCPU."""
HEARD = "heard"
"""Word by which a supervisor learns that a request has reached Python code."""

_raised: list[str] = []
"""Names of the signals that became an exception in this process, oldest first."""

_AGAIN = 0.05
"""Time (s) after which a request that Python has lost is made again."""

Handler = Callable[[int, FrameType | None], Any]
"""Called with the number of a signal and the frame that it hits."""


@contextmanager
def asked_to_end(handler: Handler) -> Iterator[Callable[[], None]]:
    """Handle every request to end by one function as long as the block lasts.

    Threads other than the main one get no signals, and nothing is done there. SIGHUP stays
    ignored where it is: that is what ``nohup`` does.

    Parameters
    ----------
    handler : callable
        Called with the number of the signal and the frame.

    Yields
    ------
    callable
        Puts the earlier handlers back before the block ends.
    """
    before: dict[int, Any] = {}

    def put_back() -> None:
        for number, earlier in before.items():
            signal.signal(number, earlier)
        before.clear()

    def called(number: int, frame: FrameType | None) -> Any:
        tell(HEARD)
        return handler(number, frame)

    if threading.current_thread() is threading.main_thread():
        for number in SIGNALS:
            if signal.getsignal(number) is not signal.SIG_IGN or number == signal.SIGINT:
                before[number] = signal.signal(number, called)
    try:
        yield put_back
    finally:
        put_back()


@contextmanager
def put_off() -> Iterator[None]:
    """Let requests to end wait for the end of the block.

    Some libraries cannot be interrupted while they start processes.
    """
    requests: list[int] = []
    with asked_to_end(lambda number, frame: requests.append(number)):
        yield
    if requests:
        signal.raise_signal(requests[0])


@contextmanager
def deaf_to_ctrl_c() -> Iterator[None]:
    """Let threads and processes that begin meanwhile not hear Ctrl-C, unless they unblock it.

    A terminal tells Ctrl-C to all processes. It is for this one, which ends the others; here it
    waits for the end of the block.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    from multiprocessing import resource_tracker  # a run by itself needs none

    # multiprocessing starts its tracker with its first process, and unblocks SIGINT then
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def interrupt(number: int, frame: FrameType | None) -> None:
    """Raise the exception of Ctrl-C, whatever the request was.

    Parameters
    ----------
    number : int
        Of the signal.
    frame : frame
        That it has hit.

    Raises
    ------
    KeyboardInterrupt
        Always.
    """
    _raised.append(signal.Signals(number).name)
    raise KeyboardInterrupt(_raised[-1])


@contextmanager
def true_cause(*told: type[Exception]) -> Iterator[None]:
    """Raise the exception of Ctrl-C again where a library made another one of it.

    Code in C and C++ that calls Python may take any exception for a wrong argument: matplotlib's
    ends with "ValueError: Invalid bounding box" where a request to end hits it.

    Parameters
    ----------
    *told : type of exception
        That are told by themselves even if a request came before, as a full disk is.

    Raises
    ------
    KeyboardInterrupt
        The block failed after a request to end had been made in it.
    """
    before = len(_raised)
    try:
        yield
    except told:
        raise
    except Exception as error:
        if len(_raised) > before:
            raise KeyboardInterrupt(_raised[-1]) from error
        raise


@contextmanager
def lost_requests_repeated() -> Iterator[None]:
    """Make a request to end again if Python has lost the exception that it became.

    In a finalizer or in a callback of a weak reference, Python prints an exception and goes on.
    """
    before = sys.unraisablehook
    again: list[threading.Timer] = []

    def heard(lost: "sys.UnraisableHookArgs") -> None:
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            before(lost)
            return
        name = str(lost.exc_value) or signal.Signals.SIGINT.name
        # not here: the exception would come up in this function, and be lost too
        again.append(threading.Timer(_AGAIN, _ask_main_thread, [signal.Signals[name]]))
        again[-1].daemon = True
        again[-1].start()

    sys.unraisablehook = heard
    try:
        yield
    finally:
        sys.unraisablehook = before
        for timer in again:
            timer.cancel()


def _ask_main_thread(number: int) -> None:
    """Send a signal to the main thread, so that what it waits for ends; Windows has no such way."""
    if sys.platform == "win32":
        signal.raise_signal(number)
    else:
        signal.pthread_kill(threading.main_thread().ident or 0, number)
