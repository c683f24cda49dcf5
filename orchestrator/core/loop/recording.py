"""What is kept of a run: rows of the time series, frames of serialized states, the energies of the couplings."""

import time
from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import RunFailed
from ..fmu.slave import Slave, without_name
from ..results.run_folder import Column
from ..system.plan import Plan
from .ledger import Accounts
from .snapshots import Snapshots

_SECONDS_TOGETHER = 1.0
"""Time (s) after which rows are passed on: what a killed process may lose."""


class Sink(Protocol):
    """Where rows and frames go."""

    def rows(self, times: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        """Append the values of all columns, a row for each time (s)."""

    def frame(self, component: str, at: float, state: bytes) -> None:
        """Append the serialized state of a component at a time (s)."""


class Recorder:
    """Makes rows of snapshots, and frames of states."""

    def __init__(
        self,
        plan: Plan,
        slaves: Mapping[str, Slave],
        snapshots: Snapshots,
        accounts: Accounts,
        sink: Sink,
    ) -> None:
        self._plan, self._slaves, self._snapshots, self._accounts, self._sink = (
            plan,
            slaves,
            snapshots,
            accounts,
            sink,
        )
        self._places = np.array([snapshots.place[end.name] for end in plan.recorded], np.int64)
        self._framed = [name for name in plan.order if plan.system.components[name].record_states]
        self._flushed_at = time.monotonic()

    @property
    def columns(self) -> list[Column]:
        """The columns of a row."""
        recorded = [
            Column(end.name, end.port.unit_name, end.port.description)
            for end in self._plan.recorded
        ]
        return recorded + self._accounts.described

    def look(self) -> None:
        """Pass on the snapshots that wait, if they have done so for a while or there is no more room."""
        if time.monotonic() - self._flushed_at > _SECONDS_TOGETHER or self._snapshots.room <= 0:
            self.flush()

    def flush(self) -> None:
        """Pass on the snapshots that wait."""
        waiting = self._snapshots.waiting
        if waiting:
            found = self._snapshots.rows[: len(waiting)]
            times = np.array([self._plan.timing.seconds(exchange) for exchange in waiting])
            self._sink.rows(
                times,
                np.concatenate(
                    (found[:, self._places], self._accounts.values(found, times)), axis=1
                ),
            )
            waiting.clear()
        self._flushed_at = time.monotonic()

    def next_frames(self, exchange: int) -> int:
        """The next exchange after which states are to be recorded; the last one where none are."""
        every = self._plan.timing.state_every
        return exchange - exchange % every + every if self._framed else self._plan.timing.exchanges

    def frames(self, exchange: int) -> None:
        """Record the states that are due after this many exchanges.

        Raises:
            RunFailed: a slave does not give its state.
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
    """What a slave logged last; nothing if it never did."""
    return (
        without_name(slave.name, slave.messages[-1][1]) if slave.messages else "without a message"
    )
