"""Processes that end with the one that has started them, and how they have ended."""

import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from typing import Any

_SET_PARENT_DEATH_SIGNAL = 1
"""Request of prctl(2): a signal that this process gets when its parent has ended."""


@cache
def with_parent() -> Callable[[], Any] | None:
    """Return a function that has the system kill the process it is called in with its parent.

    It is meant for a child between fork and exec, ``subprocess.run(..., preexec_fn=...)``: it only
    calls the system. What the child executes inherits the request, its children do not. The parent
    is the thread that has started the child.

    Returns
    -------
    callable, optional
        None where the system cannot do it: everywhere but on Linux.
    """
    if sys.platform != "linux":
        return None
    import ctypes  # of the standard library, and of no use elsewhere

    prctl = ctypes.CDLL(None).prctl
    return partial(prctl, _SET_PARENT_DEATH_SIGNAL, int(signal.SIGKILL))


def end_with_parent() -> None:
    """Have the system end this process as soon as its parent is killed, where it can."""
    ask = with_parent()
    if ask is not None:
        ask()


def ended_in_words(code: int) -> str:
    """Say how a process has ended.

    Parameters
    ----------
    code : int
        Exit code, or the negative number of the signal that has ended it.

    Returns
    -------
    str
        For ``"its code ..."``.
    """
    if code >= 0:
        return f"ended the process with exit code {code}"
    with suppress(ValueError):
        return f"crashed ({signal.Signals(-code).name})"
    return f"crashed (signal {-code})"
