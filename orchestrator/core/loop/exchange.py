"""The buses of a run, and two ways to carry out exchanges, call by call or in the compiled loop. Both give the same bits."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from ..fmu.slave import REAL, WARNING, Slave
from ..system.clock import to_seconds
from ..system.plan import End, Plan
from ..system.schedule import Action, Operation
from .blocks import make_blocks
from .machine_code import advance
from .snapshots import Snapshots
from .tables import (
    CHANNEL,
    MOVE,
    NOT_FINITE,
    NUMBERS,
    OPERATION,
    WATCHED,
    Integers,
    Records,
    Tables,
    head,
)


class Fault(NamedTuple):
    """An operation that ended the run: in which exchange, and the FMI status or :data:`NOT_FINITE`."""

    exchange: int
    operation: Operation
    status: int


def make_channels(plan: Plan) -> Records:
    """The channels of all bonds, before the first entry."""
    channels = np.zeros(sum(bond.force.size for bond in plan.bonds), CHANNEL)
    for name in ("given", "seen", "force", "position"):
        channels[name] = np.concatenate(
            [getattr(bond, name) for bond in plan.bonds] or [np.zeros(0, np.int64)]
        )
    return channels


def make_watched(plan: Plan) -> Records:
    """Extremes and integrals of the watched outputs, before the first value."""
    watched = np.zeros(plan.watched.size, WATCHED)
    watched["place"] = plan.watched
    return watched


class State:
    """What a run carries from exchange to exchange: both buses, the accounts of the bonds, what is watched, what is recorded."""

    def __init__(self, plan: Plan, journal: Integers | None = None) -> None:
        self.plan = plan
        self.inputs, self.outputs = np.zeros(len(plan.inputs)), np.zeros(len(plan.outputs))
        self.setters, self.getters = make_blocks(plan.inputs), make_blocks(plan.outputs)
        self.channels, self.watched = make_channels(plan), make_watched(plan)
        self.snapshots = Snapshots(plan)
        self.journal = np.full(2, -1, np.int64) if journal is None else journal
        """Exchange and operation under way; see :mod:`rockshed.core.loop.journal`."""

    @cached_property
    def needs(self) -> dict[str, set[int]]:
        """Places of the outputs that feed each component's inputs."""
        return {
            name: {
                int(place)
                for block in self.setters.get(name, [])
                for place in self.plan.source[block.places]
            }
            for name in self.plan.order
        }

    @cached_property
    def shows(self) -> dict[str, set[int]]:
        """Places of each component's outputs."""
        return {
            name: {
                place
                for block in self.getters.get(name, [])
                for place in range(block.places.start, block.places.stop)
            }
            for name in self.plan.order
        }

    @cached_property
    def operations(self) -> list[Operation]:
        """All operations of a period, and behind them those that read what is recorded."""
        return [
            *(operation for exchange in self.plan.schedule.operations for operation in exchange),
            *(Operation(Action.RECORD, name) for name in self.snapshots.blocks),
        ]

    def give(self, slave: Slave) -> int:
        """Set all connected inputs of a slave to the newest values. Returns the worst status."""
        worst = 0
        for block in self.setters.get(slave.name, []):
            self.inputs[block.places] = self.outputs[self.plan.source[block.places]]
            worst = max(worst, slave.set(block.references, self.inputs[block.places], block.kind))
        return worst

    def take(self, slave: Slave) -> int:
        """Get all exchanged outputs of a slave. Returns the worst status."""
        return max(
            (
                slave.get(block.references, self.outputs[block.places], block.kind)
                for block in self.getters.get(slave.name, [])
            ),
            default=0,
        )

    def not_finite(self, component: str) -> End | None:
        """The first exchanged output of a component that is no finite number."""
        blocks = self.getters.get(component)
        if not blocks:
            return None
        begin, end = blocks[0].places.start, blocks[-1].places.stop
        lost = np.flatnonzero(~np.isfinite(self.outputs[begin:end]))
        return self.plan.outputs[begin + lost[0]] if lost.size else None

    def open_accounts(self) -> None:
        """Take the values at the start as those from which work, extremes and integrals are counted."""
        channels = self.channels
        shown = channels["seen"] >= 0
        channels["last_seen"][shown] = self.inputs[channels["seen"][shown]]
        channels["last_force"], channels["last_position"] = (
            self.outputs[channels["force"]],
            self.outputs[channels["position"]],
        )
        for name in ("low", "high", "last"):
            self.watched[name] = self.outputs[self.watched["place"]]

    def post(self) -> None:
        """Enter the work of one exchange, as the compiled loop does."""
        channels, inputs, outputs = self.channels, self.inputs, self.outputs
        position = outputs[channels["position"]]
        channels["taken"] += inputs[channels["given"]] * (position - channels["last_position"])
        channels["last_position"] = position
        shown = channels["seen"] >= 0
        seen, force = inputs[channels["seen"][shown]], outputs[channels["force"][shown]]
        channels["given_back"][shown] -= (
            0.5 * (force + channels["last_force"][shown]) * (seen - channels["last_seen"][shown])
        )
        channels["last_seen"][shown], channels["last_force"][shown] = seen, force

    def watch(self, exchange: int) -> None:
        """Enter the values after ``exchange`` exchanges into extremes and integrals, as the compiled loop does."""
        watched = self.watched
        value = self.outputs[watched["place"]]
        for bound, exceeds in (("high", value > watched["high"]), ("low", value < watched["low"])):
            watched[bound][exceeds], watched[f"{bound}_at"][exceeds] = value[exceeds], exchange
        watched["area"] += 0.5 * (watched["last"] + value)
        watched["last"] = value

    def record(self, slaves: Mapping[str, Slave], number: int) -> tuple[str, int] | None:
        """Take a snapshot into a row. Returns the component that does not give finite values, and its status."""
        snapshots = self.snapshots
        row = snapshots.rows[number]
        row[: snapshots.exchanged] = self.outputs
        row[snapshots.taken], row[snapshots.given_back] = (
            self.channels["taken"],
            self.channels["given_back"],
        )
        for turn, (name, blocks) in enumerate(snapshots.blocks.items()):
            self.journal[1] = len(self.operations) - len(snapshots.blocks) + turn
            for block in blocks:
                status = slaves[name].get(block.references, row[block.places], block.kind)
                if status > WARNING:
                    return name, status
                if not np.isfinite(row[block.places]).all():
                    return name, NOT_FINITE
        self.journal[1] = -1
        return None


class Driver(Protocol):
    """Carries out exchanges."""

    def advance(self, first: int, count: int) -> Fault | None:
        """Carry out ``count`` exchanges from exchange number ``first`` on; stop at the first operation that fails. Snapshots
        that are due are taken, behind those that wait."""


class PlainDriver:
    """Calls slaves one by one, from Python. For slaves without C functions, and for debugging."""

    def __init__(self, state: State, slaves: Mapping[str, Slave]) -> None:
        self._state, self._slaves = state, slaves
        self._first = np.cumsum([0, *map(len, state.plan.schedule.operations)])

    def advance(self, first: int, count: int) -> Fault | None:
        """See :class:`Driver`."""
        state, schedule, timing = self._state, self._state.plan.schedule, self._state.plan.timing
        for n in range(first, first + count):
            origin = timing.start + n // schedule.period * schedule.period * schedule.exchange
            for number, operation in enumerate(
                schedule.operations[n % schedule.period], self._first[n % schedule.period]
            ):
                state.journal[:] = n, number
                status = self._operate(operation, origin)
                if status > WARNING or status == NOT_FINITE:
                    return Fault(n, operation, status)
            state.journal[1] = -1
            state.post()
            state.watch(n + 1)
            if (n + 1) % state.snapshots.every == 0:
                lost = state.record(
                    self._slaves, len(state.snapshots.waiting) + len(state.snapshots.due(first, n))
                )
                if lost is not None:
                    return Fault(n, Operation(Action.RECORD, lost[0]), lost[1])
        return None

    def _operate(self, operation: Operation, origin: int) -> int:
        slave = self._slaves[operation.component]
        if operation.action is Action.SET:
            return self._state.give(slave)
        if operation.action is Action.STEP:
            return slave.step(to_seconds(origin + operation.begin), to_seconds(operation.length))
        status = self._state.take(slave)
        return (
            status if status > WARNING or self._state.not_finite(slave.name) is None else NOT_FINITE
        )


class CompiledDriver:
    """Calls the C functions of FMUs from the compiled loop."""

    def __init__(self, state: State, slaves: Mapping[str, Slave]) -> None:
        plan, snapshots = state.plan, state.snapshots
        self._operations = state.operations
        operations, moves = _calls(self._operations, state, slaves)
        self._tables = Tables(
            plan.timing.start,
            plan.schedule.exchange,
            snapshots.every,
            snapshots.rows.shape[1],
            0,
            np.cumsum([0, *map(len, plan.schedule.operations)]).astype(np.int64),
            operations,
            moves,
            state.inputs,
            state.outputs,
            plan.source.astype(np.uint64),
            np.zeros(max(len(plan.inputs), len(snapshots.ends)), np.int32),
            state.channels,
            state.watched,
            snapshots.rows.ravel(),
            state.journal,
        )
        self._waiting, self._head, self._loop = snapshots.waiting, head(self._tables), advance()

    def advance(self, first: int, count: int) -> Fault | None:
        """See :class:`Driver`."""
        self._head[NUMBERS.index("row")] = len(self._waiting)
        done, number, status = self._loop(self._head, first, count)
        return Fault(first + done, self._operations[number], status) if status else None


def _calls(
    planned: Sequence[Operation], state: State, slaves: Mapping[str, Slave]
) -> tuple[Records, Records]:
    """The tables of operations and of moves. The arrays of references that the moves point to belong to ``state``."""
    operations, moves = [], list[tuple[int, ...]]()
    blocks = {
        Action.SET: state.setters,
        Action.GET: state.getters,
        Action.RECORD: state.snapshots.blocks,
    }
    for operation in planned:
        addresses = slaves[operation.component].addresses
        assert addresses is not None
        first = len(moves)
        if operation.action is not Action.STEP:
            functions = addresses.set if operation.action is Action.SET else addresses.get
            moves += [
                (
                    functions[block.kind],
                    addresses.instance,
                    block.references.ctypes.data,
                    block.references.size,
                    block.begin,
                    block.kind != REAL,
                )
                for block in blocks[operation.action].get(operation.component, [])
            ]
        operations.append(
            (
                operation.action,
                addresses.instance,
                addresses.do_step,
                operation.begin,
                operation.length,
                first,
                len(moves),
            )
        )
    return np.array(operations, OPERATION), np.array(moves, MOVE)


def make_driver(state: State, slaves: Mapping[str, Slave], plain: bool = False) -> Driver:
    """The compiled loop where all slaves have C functions, unless ``plain``."""
    usable = not plain and all(slave.addresses is not None for slave in slaves.values())
    return CompiledDriver(state, slaves) if usable else PlainDriver(state, slaves)
