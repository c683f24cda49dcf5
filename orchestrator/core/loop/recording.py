"""Records of a run: rows of the time series, and frames of serialized states."""

import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import RunFailed
from ..fmu.slave import WARNING, Slave, counts_of, times, without_name
from ..results.run_folder import Column
from .driver import Driver
from .ledger import Accounts
from .snapshots import Snapshots

MOST_TEXTS = 5
"""Different messages of a component during a run that are told."""
_SECONDS_TOGETHER = 1.0
"""Time (s) after which rows are passed on: what a killed process may lose."""


class Sink(Protocol):
    """Interface of the files that take rows and frames."""

    def rows(self, times: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        """Append the values of all columns, a row for each time (s)."""

    def frame(self, component: str, at: float, state: bytes) -> None:
        """Append the serialized state of a component at a time (s)."""


class Recorder:
    """Makes rows of snapshots, and frames of states.

    Parameters
    ----------
    slaves : mapping of str to Slave
        By component.
    snapshots : Snapshots
        Rows that the loop has taken.
    accounts : Accounts
        Gives the columns of the energy accounts.
    sink : Sink
        Takes rows and frames.
    driver : Driver
        Gives columns of its own.

    Attributes
    ----------
    ended_at : float or None
        Time (s) of the last row that waits, where a slave has ended the run within an exchange.
    rows_passed, frames_passed : int
        Number of rows, and of states of each component, that have been passed on.
    """

    def __init__(
        self,
        slaves: Mapping[str, Slave],
        snapshots: Snapshots,
        accounts: Accounts,
        sink: Sink,
        driver: Driver,
    ) -> None:
        self._plan = accounts.plan
        self._slaves = slaves
        self._snapshots = snapshots
        self._accounts = accounts
        self._sink = sink
        self._driver = driver
        recorded = self._plan.recorded
        self._runs = list(_runs([snapshots.place[end.name] for end in recorded]))
        components = self._plan.system.components
        self._framed = [name for name in self._plan.order if components[name].record_states]
        self._flushed_at = time.monotonic()
        self.ended_at: float | None = None
        self.rows_passed = 0
        self.frames_passed = 0

    @property
    def columns(self) -> list[Column]:
        """Columns of a row, without the time."""
        recorded = [
            Column(end.name, end.port.unit_name, end.port.description)
            for end in self._plan.recorded
        ]
        return recorded + self._accounts.described + self._driver.columns

    def look(self) -> None:
        """Pass on the snapshots that wait, if they have done so for a while or fill all rows."""
        if time.monotonic() - self._flushed_at > _SECONDS_TOGETHER or self._snapshots.room <= 0:
            self.flush()

    def flush(self) -> None:
        """Pass on the snapshots that wait.

        Raises
        ------
        RunFailed
            Energy runs away; the rows that show it have been passed on.
        """
        waiting = self._snapshots.waiting
        if waiting:
            rows = self._snapshots.rows[: len(waiting)]
            times = self._plan.timing.moments(waiting)
            if self.ended_at is not None:
                times[-1] = self.ended_at
            self._sink.rows(times, self._table(rows, times))
            self.rows_passed += len(waiting)
            waiting.clear()
        self._flushed_at = time.monotonic()
        self._accounts.refuse_runaway()

    def _table(self, rows: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return all columns of snapshots that wait, in memory of its own."""
        behind = (self._accounts.values(rows, times), self._driver.values(self._snapshots.waiting))
        recorded = len(self._plan.recorded)
        table = np.empty((len(rows), recorded + sum(part.shape[1] for part in behind)))
        for first, place, number in self._runs:
            table[:, first : first + number] = rows[:, place : place + number]
        table[:, recorded:] = np.concatenate(behind, axis=1)
        return table

    def next_frames(self, exchange: int) -> int:
        """Return the next exchange after which states are recorded; the last one if none are."""
        every = self._plan.timing.state_every
        return exchange - exchange % every + every if self._framed else self._plan.timing.exchanges

    def frames(self, exchange: int) -> None:
        """Record the states that are due after this many exchanges.

        Parameters
        ----------
        exchange : int
            Number of exchanges carried out.

        Raises
        ------
        RunFailed
            A slave does not give its state.
        """
        if exchange % self._plan.timing.state_every == 0:
            at = self._plan.timing.seconds(exchange)
            self.flush()  # rows come before states, which may fill the disk
            for name in self._framed:
                self._sink.frame(name, at, self._serialized(name, at))
            self.frames_passed += bool(self._framed)

    def _serialized(self, name: str, at: float) -> bytes:
        try:
            return self._slaves[name].state()
        except RuntimeError as error:
            raise RunFailed(name, at, str(error)) from error


def _runs(places: Sequence[int]) -> Iterator[tuple[int, int, int]]:
    """Yield places that follow one another: number of the first one, its place, how many.

    They are copied together, which takes a fraction of one by one.
    """
    jumps = np.flatnonzero(np.diff(places) != 1) + 1
    for begin, end in pairwise([0, *jumps.tolist(), len(places)]):
        if end > begin:
            yield begin, places[begin], end - begin


def last_words(slave: Slave) -> str:
    """Return the last message of a slave."""
    if not slave.messages:
        return "without a message"
    return without_name(slave.name, slave.messages[-1][1])


class Hearing:
    """Listens to what slaves say from now on.

    Parameters
    ----------
    slaves : mapping of str to Slave
        By component.

    Attributes
    ----------
    earlier : mapping of str to Counter
        Messages that an earlier process has heard, by component.
    """

    def __init__(self, slaves: Mapping[str, Slave]) -> None:
        self._slaves = slaves
        self._before = {name: counts_of(slave.messages) for name, slave in slaves.items()}
        self.earlier: Mapping[str, Counter[tuple[int, str]]] = {}

    @property
    def said(self) -> dict[str, Counter[tuple[int, str]]]:
        """Return how often each message has come, by component."""
        nothing: Counter[tuple[int, str]] = Counter()
        return {
            name: self.earlier.get(name, nothing) + counts_of(slave.messages) - self._before[name]
            for name, slave in self._slaves.items()
        }

    def warnings(self, warned: Mapping[str, int]) -> list[str]:
        """Return the first texts of each slave with the number of times that they came.

        Parameters
        ----------
        warned : mapping of str to int
            How often calls of a component had the status Warning.

        Returns
        -------
        list of str
            At most :data:`MOST_TEXTS` for each component, and the number of those left out.
        """
        return [
            text
            for name, new in self.said.items()
            for text in _told(name, new, warned.get(name, 0))
        ]


def _told(name: str, new: Counter[tuple[int, str]], warned: int) -> list[str]:
    """Return the first texts of a component with the number of times that they came."""
    said: Counter[str] = Counter()
    for (status, text), count in new.items():
        if status >= WARNING:
            said[without_name(name, text)] += count
    texts = [f"{name}: {text}{times(count)}" for text, count in said.items()]
    if len(texts) > MOST_TEXTS:
        rest = sum(list(said.values())[MOST_TEXTS:])
        texts[MOST_TEXTS:] = [f"{name}: and {rest} other messages"]
    if warned and not texts:
        texts = [f"{name}: returned Warning without a message{times(warned)}"]
    return texts
