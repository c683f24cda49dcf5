"""The exchange loop: every slave is called by the addresses of its C functions."""

from collections import Counter
from collections.abc import Mapping
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..fmu.slave import BOOLEAN, Addresses, Slave
from ..fmu.types import TYPES
from ..system.schedule import Action, Operation
from .blocks import Block
from .buses import Buses
from .callbacks import Callbacks
from .machine_code import advance
from .tables import (
    CHANNEL,
    FORMS,
    MOVE,
    NUMBERS,
    OPERATION,
    TRUTH_OF_INTEGER,
    WATCHED,
    IntegerTable,
    Records,
    Tables,
    head,
)
from .texts import TextCalls


class Fault(NamedTuple):
    """An operation that ended the loop.

    exchange: number of the exchange, counted from 0. status: of FMI, or NOT_FINITE. cause: the
    exception of a slave in Python. what: why, where that is known to the driver alone.
    """

    exchange: int
    operation: Operation
    status: int
    cause: Exception | None = None
    what: str = ""


class ExchangeLoop:
    """Carries out exchanges between slaves, and takes snapshots.

    Parameters
    ----------
    buses : Buses
        Values that the exchanges change.
    slaves : mapping of str to Slave
        Initialised, by component. Those that are made of Python are called back.

    Attributes
    ----------
    done : int
        Exchange steps of the newest call without a fault: fewer than were asked for where a
        condition has come true.
    """

    def __init__(self, buses: Buses, slaves: Mapping[str, Slave]) -> None:
        self._operations = buses.operations
        schedules = [buses.plan.schedule, *buses.plan.longer]
        numbers = [sum(map(len, schedule.operations)) for schedule in schedules]
        self._places = [0, *accumulate(numbers)]
        self._callbacks = {
            name: Callbacks(slave) for name, slave in slaves.items() if slave.addresses is None
        }
        self._waiting = buses.snapshots.waiting
        self.done = 0
        self._texts = TextCalls(buses.texts, slaves)
        self._tables = _tables(buses, self._addresses(slaves), self._texts)
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

    @property
    def returned_table(self) -> IntegerTable:
        """Return how often the step of each operation has ended early, to be changed in place."""
        return self._tables.returned

    @property
    def returned(self) -> Counter[str]:
        """Return how often a step of each component has ended early."""
        counts: Counter[str] = Counter()
        for operation, count in zip(self._operations, self._tables.returned):
            counts[operation.component] += int(count)
        return +counts

    @property
    def reached(self) -> float:
        """Return the time (s) that the newest step of an FMU of FMI 3.0 has reached."""
        return float(self._tables.reached[0])

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

    def part(self, begin: int, end: int, source: NDArray[np.uint64] | None = None) -> "Excerpt":
        """Return a part of the loop, which forgets no state and enters nothing into the accounts.

        Parameters
        ----------
        begin, end : int
            The operations from the first up to before the second, by their places in
            :attr:`~.buses.Buses.operations`.
        source : array of uint64, optional
            For each input, the place that feeds it, where that is another one.
        """
        return Excerpt(
            self,
            self.with_tables(
                every=_NEVER,
                forgets=0,
                first=np.array([begin, end], np.int64),
                channels=np.zeros(0, CHANNEL),
                watched=np.zeros(0, WATCHED),
                source=self._tables.source if source is None else source,
            ),
        )

    def longer(self, level: int, forgets: bool) -> "Excerpt":
        """Return exchanges of ``2**level`` exchange steps, which take no snapshots.

        Parameters
        ----------
        level : int
            0 for one exchange step; at most the number of :attr:`~.plan.Plan.longer`.
        forgets : bool
            Whether no FMU goes back to a time before them.
        """
        begin, end = self._places[level : level + 2]
        return Excerpt(
            self,
            self.with_tables(
                every=_NEVER,
                forgets=int(forgets),
                first=np.array([begin, end], np.int64),
                units=1 << level,
            ),
        )

    def accounts(self) -> "Excerpt":
        """Return what ends an exchange, without its operations: accounts, a row if it is due."""
        nothing = np.full(2, self._tables.first[-1], np.int64)
        return Excerpt(self, self.with_tables(first=nothing))

    def with_tables(self, **others: Any) -> Tables:
        """Return the tables of the loop with some others, by field; they lie in the same memory."""
        return self._tables._replace(**others)

    def _call(self, first: int, count: int) -> Fault | None:
        return self.carry_out(self._head, first, count)

    def carry_out(self, head: IntegerTable, first: int, count: int, rows: int = 0) -> Fault | None:
        """Carry out exchanges with the tables that a head points to; see :meth:`advance`.

        ``rows`` have been taken since the last ones that wait.
        """
        head[NUMBERS.index("row")] = len(self._waiting) + rows
        done, number, status = self._loop(head, first, count)
        if not status:
            self.done = int(done)
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


_NEVER = 1 << 62
"""Number of exchanges for a row of snapshots where none is to be taken."""


class Excerpt:
    """Some operations of the loop, to be carried out apart from their exchange.

    Parameters
    ----------
    loop : ExchangeLoop
        To which they belong.
    tables : Tables
        Of :meth:`ExchangeLoop.with_tables`.
    """

    def __init__(self, loop: ExchangeLoop, tables: Tables) -> None:
        self._loop = loop
        self._tables = tables  # keeps alive what the head points to
        self._head = head(tables)

    def carry_out(self, exchange: int, rows: int = 0) -> Fault | None:
        """Carry them out; steps are those of the period that begins after so many exchanges.

        Parameters
        ----------
        exchange, rows : int
            Number of exchanges before, and of rows that wait for the master to count them.

        Returns
        -------
        Fault or None
            The operation that failed.
        """
        return self._loop.carry_out(self._head, exchange, 1, rows)


def _tables(buses: Buses, addresses: Mapping[str, Addresses], texts: TextCalls) -> Tables:
    plan, snapshots = buses.plan, buses.snapshots
    operations, moves = _calls(buses, addresses, texts)
    longs = np.zeros(max(len(plan.inputs), len(snapshots.ends)), np.int64)
    return Tables(
        start=plan.timing.start,
        exchange=plan.schedule.exchange,
        rate=plan.timing.rate,
        every=snapshots.every,
        width=snapshots.rows.shape[1],
        row=0,
        units=1,
        recording=len(operations) - len(snapshots.blocks),
        exchanged=len(plan.outputs),
        forgets=1,
        first=np.cumsum([0, *map(len, plan.schedule.operations)]).astype(np.int64),
        operations=operations,
        moves=moves,
        inputs=buses.inputs,
        outputs=buses.outputs,
        source=plan.source.astype(np.uint64),
        linear=buses.linear,
        extrapolated=buses.extrapolated,
        discrete=buses.discrete,
        jumps=buses.jumps,
        **_buffers(longs),
        longs=longs,
        channels=buses.channels,
        posted=buses.posted,
        watched=buses.watched,
        snapshots=snapshots.rows.ravel(),
        **_of_scenario(buses),
        journal=buses.journal,
        warned=np.zeros(len(operations), np.int64),
        returned=np.zeros(len(operations), np.int64),
        told=np.zeros(1, np.int64),
        reached=np.zeros(1),
    )


def _buffers(longs: NDArray[np.int64]) -> dict[str, Any]:
    """Return the buffer of values on their way in the forms other than that of whole numbers."""
    return {
        "singles": longs.view(np.float32),
        "bytes": longs.view(np.int8),
        "shorts": longs.view(np.int16),
        "integers": longs.view(np.int32),
    }


def _of_scenario(buses: Buses) -> dict[str, Any]:
    """Return the tables of what a scenario changes, and waits for, within the loop."""
    return {
        "course": buses.course.ravel(),
        "course_rows": buses.course_rows,
        "course_span": buses.course_span,
        "conditions": buses.conditions,
    }


def _calls(
    buses: Buses, addresses: Mapping[str, Addresses], texts: TextCalls
) -> tuple[Records, Records]:
    """Return the tables of operations and of moves.

    The arrays of references that the moves point to belong to the buses.
    """
    operations: list[tuple[int, ...]] = []
    moves: list[tuple[float, ...]] = []
    for operation in buses.operations:
        name = operation.component
        called = addresses[name]
        first = len(moves)
        moves += _moves(operation, buses, called)
        moves += map(_text_move, texts.addresses(name, operation.action))
        steps = (operation.begin, operation.length)
        functions = (called.instance, called.do_step, called.may_return_early)
        rows = (*_ends(buses.discrete_of(name)), *_ends(buses.posted_of(name)))
        owner = buses.plan.order.index(name)
        operations.append((operation.action, *functions, *steps, first, len(moves), owner, *rows))
    return np.array(operations, OPERATION), np.array(moves, MOVE)


def _moves(operation: Operation, buses: Buses, called: Addresses) -> list[tuple[float, ...]]:
    if operation.action is Action.STEP:
        return []
    is_set = operation.action in (Action.SET, Action.EXTRAPOLATE)
    functions = called.set if is_set else called.get
    nothing = slice(0, 0)
    blocks = {
        Action.SET: buses.setters,
        Action.EXTRAPOLATE: buses.setters,
        Action.GET: buses.getters,
        Action.RECORD: buses.snapshots.blocks,
    }[operation.action]
    return [
        (
            functions[block.type],
            called.instance,
            *_move(
                block,
                buses.linear_of(block) if is_set else nothing,
                buses.extrapolated_of(block) if is_set else nothing,
            ),
        )
        for block in blocks.get(operation.component, [])
    ]


def _text_move(address: int) -> tuple[float, ...]:
    """Return the row of a call that moves texts, and no number."""
    return (address, *[0] * (len(MOVE.names or ()) - 1))


def _ends(rows: slice) -> tuple[int, int]:
    return rows.start, rows.stop


def _move(block: Block, linear: slice, extrapolated: slice) -> tuple[float, ...]:
    """Return the row of a block in the table of moves, without function and instance."""
    moved = TYPES[block.type]
    form = FORMS[moved.number.name]
    if moved.kind == BOOLEAN and not moved.is_counted:
        form = TRUTH_OF_INTEGER
    references = block.references
    called = (references.ctypes.data, references.size, block.number, block.begin)
    ways = (*_ends(linear), *_ends(extrapolated))
    return (*called, form, moved.is_counted, *ways, moved.low, moved.high)
