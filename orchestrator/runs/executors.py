"""Processes that carry out many pieces of work, and lose none when one of them dies."""

import os
import signal
import time
from _thread import interrupt_main
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.connection import wait as wait_for
from multiprocessing.process import BaseProcess
from threading import Event, Thread
from typing import Any, Protocol

from ..core.ending import deaf_to_ctrl_c
from ..core.errors import InputRefused, Problem
from ..temporary import sweep

Work = Callable[[Any], Any]
"""A function of a module, which other processes find by its name."""

_DEATHS = 2
"""Processes that one piece of work may take with it; the first one may have been killed."""
_AHEAD = 2
"""Pieces that each process has, so that it never waits for the next one."""
_DEAF = 5.0
"""Time (s) after which a process that was interrupted and goes on is killed."""
_AGAIN = 0.2
"""Time (s) after which a process that goes on is interrupted again."""
_LONGEST_END = 20.0
"""Time (s) after which a run that has been interrupted is no longer waited for."""


def number_of_workers(asked: int | None) -> int:
    """Return the number of processes or threads that are asked for; by default one for each core.

    Parameters
    ----------
    asked : int or None
        As a user gives it.

    Raises
    ------
    InputRefused
        Nobody would do the work.
    """
    if asked is not None and asked < 1:
        raise InputRefused([Problem("workers", f"{asked} do no work", "give one at least")])
    return asked or os.cpu_count() or 1


class Lost:
    """In the place of a result: the processes that did this piece of work have died."""


class Crew(Protocol):
    """Somebody who carries out pieces of work.

    Attributes
    ----------
    facts : mapping of str to Any
        Number of workers, and the scheduler, for the provenance of results.
    """

    facts: Mapping[str, Any]

    def each(self, work: Work, items: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield the number of each item and its result, in the order in which they come.

        A result is :class:`Lost` where the processes that did it have died.
        """


@dataclass
class _Lane:
    """A process and the pieces of work that it has, the one in work first."""

    pool: ProcessPoolExecutor
    pieces: "deque[tuple[int, Future[Any]]]" = field(default_factory=deque)


class Processes:
    """Processes of this computer. A context manager; left early, work that waits is dropped.

    Parameters
    ----------
    workers : int
        Their number.
    """

    def __init__(self, workers: int) -> None:
        self.facts: Mapping[str, Any] = {"workers": workers}
        self._lanes = [_Lane(_one_process()) for _ in range(workers)]

    def __enter__(self) -> "Processes":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            for lane in self._lanes:
                lane.pool.shutdown(wait=False, cancel_futures=True)
            _end(active_children())
        for lane in self._lanes:
            lane.pool.shutdown(cancel_futures=True)

    def each(self, work: Work, items: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield the number of each item and its result, in the order in which they come."""
        waiting = deque(range(len(items)))
        deaths: Counter[int] = Counter()
        while waiting or any(lane.pieces for lane in self._lanes):
            for lane in self._lanes:
                while waiting and len(lane.pieces) < _AHEAD:
                    number = waiting.popleft()
                    lane.pieces.append((number, self._submitted(lane, work, items[number])))
            wait(
                [piece for lane in self._lanes for _, piece in lane.pieces],
                return_when=FIRST_COMPLETED,
            )
            for lane in self._lanes:
                while lane.pieces and lane.pieces[0][1].done():
                    if isinstance(lane.pieces[0][1].exception(), BrokenProcessPool):
                        yield from self._bury(lane, waiting, deaths)
                    else:
                        number, piece = lane.pieces.popleft()
                        yield number, piece.result()

    def _submitted(self, lane: _Lane, work: Work, item: Any) -> "Future[Any]":
        """Hand work to a lane; its process begins with the first, one that has died takes none."""
        try:
            with deaf_to_ctrl_c():
                return lane.pool.submit(work, item)
        except BrokenProcessPool as error:
            broken: Future[Any] = Future()
            broken.set_exception(error)
            return broken

    def _bury(
        self, lane: _Lane, waiting: deque[int], deaths: Counter[int]
    ) -> Iterator[tuple[int, Any]]:
        """Start another process for a lane whose process has died, and do its work again."""
        in_work, *others = [number for number, _ in lane.pieces]
        lane.pieces.clear()
        lane.pool.shutdown(wait=False)
        lane.pool = _one_process()
        waiting.extendleft(reversed(others))
        deaths[in_work] += 1
        if deaths[in_work] < _DEATHS:
            waiting.appendleft(in_work)
        else:
            yield in_work, Lost()


def _end(children: Sequence[BaseProcess]) -> None:
    """Interrupt the runs of processes, and kill those that do not hear it.

    Only a terminal tells Ctrl-C to all processes. They are told again and again: the run that
    hears it may be followed by one that waits in the process already. A kernel that prepares a
    large layer hears nothing for minutes; what a process that is killed so leaves is removed.
    """
    last = time.monotonic() + _DEAF
    living = _living(children)
    while living and time.monotonic() < last:
        for child in living:
            with suppress(OSError):
                os.kill(child.pid or 0, signal.SIGINT)
        wait_for([child.sentinel for child in living], _AGAIN)
        living = _living(living)
    for child in living:
        child.kill()
    for child in living:
        child.join()
    if living:
        sweep()


def _living(children: Sequence[BaseProcess]) -> list[BaseProcess]:
    return [child for child in children if child.is_alive()]


@contextmanager
def processes(workers: int) -> Iterator[Crew]:
    """Open so many processes of this computer as an executor."""
    with Processes(workers) as made:
        yield made


# --- in a process ---

_RUNNING = Event()
"""Whether this process carries out a run."""
_AT_END: list[Callable[[], None]] = []
"""Functions that tidy up before this process ends."""


def at_end(tidy: Callable[[], None]) -> None:
    """Have a function called before this process ends because its parent has been killed."""
    _AT_END.append(tidy)


@contextmanager
def running() -> Iterator[None]:
    """Mark the time in which this process carries out a run, which may take Ctrl-C for itself."""
    _RUNNING.set()
    try:
        yield
    finally:
        _RUNNING.clear()


def _one_process() -> ProcessPoolExecutor:
    """Return a process that starts afresh."""
    return ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=_begin_process)


def _begin_process() -> None:
    """Ignore Ctrl-C between two runs, and end when the parent does.

    Ctrl-C reaches every process: a run takes it for itself while it goes on, between runs the
    parent. Before, while Python imports, it waits, see :func:`deaf_to_ctrl_c`: where it has come,
    there is nothing to do any more. A parent that is killed tells nothing: its end is waited for.
    """
    has_masks = hasattr(signal, "pthread_sigmask")  # not on Windows
    if has_masks and signal.SIGINT in signal.sigpending():
        os._exit(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if has_masks:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    parent = parent_process()
    if parent is not None:
        Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: Any) -> None:
    """Wait for the end of the parent; then interrupt the run, so that it tidies up, and end."""
    parent.join()
    last = time.monotonic() + _LONGEST_END
    while _RUNNING.is_set() and time.monotonic() < last:
        interrupt_main()  # not heard before the run has begun
        time.sleep(0.5)
    for tidy in _AT_END:
        with suppress(Exception):  # nobody is left to be told
            tidy()
    os._exit(1)
