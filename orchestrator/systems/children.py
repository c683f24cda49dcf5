"""Processes that a measurement has started, which end with it."""

import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from threading import Lock

from ..processes import with_parent


class MeasurementEnded(Exception):  # noqa: N818 -- it is no error
    """The measurement was ended, and with it the process that was waited for."""


class Children:
    """Processes that can be ended together, from another thread than those which wait for them.

    Attributes
    ----------
    at_work : Lock
        Held by the thread that does something in this process, and released while it waits for one
        of these: a process may not be started (forked) while another thread is inside of a library
        with threads of its own, as OpenBLAS has them.
    """

    def __init__(self) -> None:
        self.at_work = Lock()
        self._lock = Lock()
        self._running: set[subprocess.Popen[str]] = set()
        self._is_ended = False

    def run(
        self, command: Sequence[str], limit: float, environment: Mapping[str, str]
    ) -> tuple[int, str]:
        """Run a program to its end, by a thread that is at work.

        Parameters
        ----------
        command : sequence of str
            Program and words.
        limit : float
            Time (s) after which it is killed.
        environment : mapping of str to str
            Its environment.

        Returns
        -------
        (int, str)
            Exit code, and everything that it has printed.

        Raises
        ------
        subprocess.TimeoutExpired
            It took longer.
        MeasurementEnded
            :meth:`end` was called.
        """
        with self._lock:
            if self._is_ended:
                raise MeasurementEnded
            child = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors="replace",
                env=environment,
                preexec_fn=with_parent(),
                start_new_session=True,  # Ctrl-C is for the measurement, which ends it
            )
            self._running.add(child)
        self.at_work.release()
        try:
            said, _ = child.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            _kill(child)
            raise
        finally:
            with self._lock:
                self._running.discard(child)
            self.at_work.acquire()
        if self._is_ended:
            raise MeasurementEnded
        return child.returncode, said

    def end(self) -> None:
        """Kill all processes, and let no other one begin."""
        with self._lock:
            self._is_ended = True
            for child in self._running:
                _kill(child)


def _kill(child: "subprocess.Popen[str]") -> None:
    """Kill a process, and where the system knows groups, those that it has started."""
    if sys.platform == "win32":
        child.kill()
    else:
        os.killpg(child.pid, signal.SIGKILL)
