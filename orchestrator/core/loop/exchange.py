"""The exchange loop: every slave is called by the addresses of its C functions."""

from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..fmu.slave import REAL, Addresses, Slave
from ..system.schedule import Action, Operation
from .buses import Buses
from .callbacks import Callbacks
from .machine_code import advance
from .tables import MOVE, NUMBERS, OPERATION, IntegerTable, Records, Tables, head


class Fault(NamedTuple):
    """An operation that ended the loop.

    exchange: number of the exchange, counted from 0. status: of FMI, or NOT_FINITE. cause: the
    exception of a slave in Python.
    """

    exchange: int
    operation: Operation
    status: int
    cause: Exception | None = None


class ExchangeLoop:
    """Carries out exchanges between slaves, and takes snapshots.

    Parameters
    ----------
    buses : Buses
        Values that the exchanges change.
    slaves : mapping of str to Slave
        Initialised, by component. Those that are made of Python are called back.
    """

    def __init__(self, buses: Buses, slaves: Mapping[str, Slave]) -> None:
        self._operations = buses.operations
        self._callbacks = {
            name: Callbacks(slave) for name, slave in slaves.items() if slave.addresses is None
        }
        self._waiting = buses.snapshots.waiting
        self._tables = _tables(buses, self._addresses(slaves))
        self._head = head(self._tables)
        self._loop = advance()

    @property
    def warned(self) -> Counter[str]:
        """Return how often calls of each component had the status Warning."""
        counts: Counter[str] = Counter()
        for operation, count in zip(self._operations, self._tables.warned):
            counts[operation.component] += int(count)
        return counts

    @property
    def warned_table(self) -> IntegerTable:
        """Return how often each operation had the status Warning, to be changed in its place."""
        return self._tables.warned

    def advance(self, first: int, count: int) -> Fault | None:
        """Carry out exchanges until the first operation that fails.

        Snapshots that are due are taken, behind those that wait.

        Parameters
        ----------
        first, count : int
            Number of the first exchange, counted from 0; how many, at least one.

        Returns
        -------
        Fault or None
            The operation that failed.
        """
        return self._call(first, count)

    def record(self, exchange: int) -> Fault | None:
        """Take a snapshot of the values after so many exchanges, behind those that wait.

        Parameters
        ----------
        exchange : int
            Number of exchanges that have been carried out.

        Returns
        -------
        Fault or None
            The operation that failed.
        """
        return self._call(exchange, 0)

    def _call(self, first: int, count: int) -> Fault | None:
        self._head[NUMBERS.index("row")] = len(self._waiting)
        done, number, status = self._loop(self._head, first, count)
        if not status:
            return None
        operation = self._operations[number]
        called_back = self._callbacks.get(operation.component)
        raised = called_back.raised if called_back else None
        if raised is not None and not isinstance(raised, Exception):
            raise raised  # Ctrl-C or the end of the program
        return Fault(first + done, operation, status, raised)

    def _addresses(self, slaves: Mapping[str, Slave]) -> dict[str, Addresses]:
        own = {name: slave.addresses for name, slave in slaves.items() if slave.addresses}
        return own | {name: made.addresses for name, made in self._callbacks.items()}


def _tables(buses: Buses, addresses: Mapping[str, Addresses]) -> Tables:
    plan = buses.plan
    snapshots = buses.snapshots
    operations, moves = _calls(buses, addresses)
    return Tables(
        start=plan.timing.start,
        exchange=plan.schedule.exchange,
        rate=plan.timing.rate,
        every=snapshots.every,
        width=snapshots.rows.shape[1],
        row=0,
        first=np.cumsum([0, *map(len, plan.schedule.operations)]).astype(np.int64),
        operations=operations,
        moves=moves,
        inputs=buses.inputs,
        outputs=buses.outputs,
        source=plan.source.astype(np.uint64),
        linear=buses.linear,
        integers=np.zeros(max(len(plan.inputs), len(snapshots.ends)), np.int32),
        channels=buses.channels,
        watched=buses.watched,
        snapshots=snapshots.rows.ravel(),
        journal=buses.journal,
        warned=np.zeros(len(operations), np.int64),
    )


def _calls(buses: Buses, addresses: Mapping[str, Addresses]) -> tuple[Records, Records]:
    """Return the tables of operations and of moves.

    The arrays of references that the moves point to belong to the buses.
    """
    operations: list[tuple[int, ...]] = []
    moves: list[tuple[int, ...]] = []
    for operation in buses.operations:
        called = addresses[operation.component]
        first = len(moves)
        moves += _moves(operation, buses, called)
        steps = (operation.begin, operation.length)
        functions = (called.instance, called.do_step)
        operations.append((operation.action, *functions, *steps, first, len(moves)))
    return np.array(operations, OPERATION), np.array(moves, MOVE)


def _moves(operation: Operation, buses: Buses, called: Addresses) -> list[tuple[int, ...]]:
    if operation.action is Action.STEP:
        return []
    is_set = operation.action is Action.SET
    functions = called.set if is_set else called.get
    nothing = slice(0, 0)
    blocks = {
        Action.SET: buses.setters,
        Action.GET: buses.getters,
        Action.RECORD: buses.snapshots.blocks,
    }[operation.action]
    return [
        (
            functions[block.kind],
            called.instance,
            block.references.ctypes.data,
            block.references.size,
            block.begin,
            block.kind != REAL,
            (buses.linear_of(block) if is_set else nothing).start,
            (buses.linear_of(block) if is_set else nothing).stop,
        )
        for block in blocks.get(operation.component, [])
    ]
