"""What is kept of a run: rows of the time series, frames of serialized states, the energies of the couplings."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .errors import RunFailed
from .exchange import State, make_blocks
from .ledger import Accounts
from .plan import Plan
from .results import Column
from .slave import WARNING, Slave, without_name


class Sink(Protocol):
    """Where rows and frames go."""

    def row(self, at: float, values: NDArray[np.float64]) -> None:
        """Append the values of all columns at a time (s)."""

    def frame(self, component: str, at: float, state: bytes) -> None:
        """Append the serialized state of a component at a time (s)."""


class Recorder:
    """Reads what is to be recorded from buses, slaves and ledger, at output times only."""

    def __init__(self, plan: Plan, slaves: Mapping[str, Slave], state: State, accounts: Accounts, sink: Sink) -> None:
        self._plan, self._slaves, self._state, self._accounts, self._sink = plan, slaves, state, accounts, sink
        place = {end.name: i for i, end in enumerate(plan.outputs)}
        self._on_bus = np.array([i for i, end in enumerate(plan.recorded) if end.name in place], np.int64)
        self._places = np.array([place[plan.recorded[i].name] for i in self._on_bus], np.int64)
        apart = [(i, end) for i, end in enumerate(plan.recorded) if end.name not in place]
        apart.sort(key=lambda item: (plan.order.index(item[1].component), item[1].port.kind, item[1].port.reference))
        self._apart = np.array([i for i, _ in apart], np.int64)
        self._read = np.zeros(len(apart))
        self._blocks = make_blocks([end for _, end in apart])
        self._row = np.zeros(len(plan.recorded) + accounts.columns)
        self._framed = [name for name in plan.order if plan.system.components[name].record_states]
        self._last = -1

    @property
    def columns(self) -> list[Column]:
        """The columns of a row."""
        recorded = [Column(end.name, end.port.unit_name, end.port.description) for end in self._plan.recorded]
        return recorded + self._accounts.described

    def next_after(self, exchange: int) -> int:
        """The next exchange after which something is to be recorded."""
        timing = self._plan.timing
        every = [timing.output_every] + ([timing.state_every] if self._framed else [])
        return min(exchange - exchange % n + n for n in every)

    def record(self, exchange: int, finally_too: bool = False) -> None:
        """Record what is due after this many exchanges; ``finally_too``: a row in any case, unless it is there already.

        Raises:
            RunFailed: a slave does not give its values or its state, or a recorded output is no finite number.
        """
        timing = self._plan.timing
        at = timing.seconds(exchange)
        if exchange > self._last and (finally_too or exchange % timing.output_every == 0):
            self._last = exchange
            self._sink.row(at, self._values(at))
        if self._framed and exchange % timing.state_every == 0 and not finally_too:
            for name in self._framed:
                self._sink.frame(name, at, self._serialized(name, at))

    def _values(self, at: float) -> NDArray[np.float64]:
        n = len(self._plan.recorded)
        self._row[self._on_bus] = self._state.outputs[self._places]
        for name, blocks in self._blocks.items():
            slave = self._slaves[name]
            if max(slave.get(block.references, self._read[block.places], block.kind) for block in blocks) > WARNING:
                raise RunFailed(name, at, f"does not give its values: {last_words(slave)}")
        self._row[self._apart] = self._read
        self._row[n:] = self._accounts.values(at)
        for i in np.flatnonzero(~np.isfinite(self._row[:n]))[:1]:
            end = self._plan.recorded[i]
            raise RunFailed(end.component, at, f"{end.name} = {self._row[i]} is no finite number; reduce the steps, or leave the "
                            "variable out of the record if it may be so")
        return self._row

    def _serialized(self, name: str, at: float) -> bytes:
        try:
            return self._slaves[name].state()
        except RuntimeError as error:
            raise RunFailed(name, at, str(error)) from error


def last_words(slave: Slave) -> str:
    """What a slave logged last; nothing if it never did."""
    return without_name(slave.name, slave.messages[-1][1]) if slave.messages else "without a message"
