"""Records of a run: rows of the time series, and frames of serialized states."""

import time
from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import RunFailed
from ..fmu.slave import Slave, without_name
from ..results.run_folder import Column
from .ledger import Accounts
from .snapshots import Snapshots

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
    """

    def __init__(
        self, slaves: Mapping[str, Slave], snapshots: Snapshots, accounts: Accounts, sink: Sink
    ) -> None:
        self._plan = accounts.plan
        self._slaves = slaves
        self._snapshots = snapshots
        self._accounts = accounts
        self._sink = sink
        recorded = self._plan.recorded
        self._places = np.array([snapshots.place[end.name] for end in recorded], np.int64)
        components = self._plan.system.components
        self._framed = [name for name in self._plan.order if components[name].record_states]
        self._flushed_at = time.monotonic()

    @property
    def columns(self) -> list[Column]:
        """Columns of a row, without the time."""
        recorded = [
            Column(end.name, end.port.unit_name, end.port.description)
            for end in self._plan.recorded
        ]
        return recorded + self._accounts.described

    def look(self) -> None:
        """Pass on the snapshots that wait, if they have done so for a while or fill all rows."""
        if time.monotonic() - self._flushed_at > _SECONDS_TOGETHER or self._snapshots.room <= 0:
            self.flush()

    def flush(self) -> None:
        """Pass on the snapshots that wait."""
        waiting = self._snapshots.waiting
        if waiting:
            rows = self._snapshots.rows[: len(waiting)]
            times = np.array([self._plan.timing.seconds(exchange) for exchange in waiting])
            energies = self._accounts.values(rows, times)
            self._sink.rows(times, np.concatenate((rows[:, self._places], energies), axis=1))
            waiting.clear()
        self._flushed_at = time.monotonic()

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
            for name in self._framed:
                self._sink.frame(name, at, self._serialized(name, at))

    def _serialized(self, name: str, at: float) -> bytes:
        try:
            return self._slaves[name].state()
        except RuntimeError as error:
            raise RunFailed(name, at, str(error)) from error


def last_words(slave: Slave) -> str:
    """Return the last message of a slave."""
    if not slave.messages:
        return "without a message"
    return without_name(slave.name, slave.messages[-1][1])
