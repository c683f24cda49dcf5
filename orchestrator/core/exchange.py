"""The buses of a run, and two ways to carry out exchanges, call by call or in the compiled loop. Both give the same bits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .clock import to_seconds
from .loop import (
    NOT_FINITE,
    Buses,
    Extremes,
    Ledger,
    Moves,
    Program,
    Steps,
    advance_listed,
    directory_of,
    first_not_finite,
    post,
    widen,
)
from .plan import End, Plan
from .schedule import Action, Operation
from .slave import REAL, WARNING, References, Slave

_WORTH_A_CALL = 16
"""Consecutive value references go in a call of their own where the blocks of a component are at least this long on average:
pythonfmu's slaves take such a block as one slice."""


@dataclass(frozen=True)
class Block:
    """Variables that one FMI call moves; their values lie on a bus from place ``begin`` on."""

    kind: str
    references: References
    begin: int

    @property
    def places(self) -> slice:
        """Where the values lie."""
        return slice(self.begin, self.begin + self.references.size)


class Fault(NamedTuple):
    """An operation that ended the run: in which exchange, and the FMI status or :data:`NOT_FINITE`."""

    exchange: int
    operation: Operation
    status: int


def make_blocks(ends: Sequence[End]) -> dict[str, list[Block]]:
    """Blocks of each component for ports that lie in this order on a bus."""
    blocks: dict[str, list[Block]] = {}
    for (component, kind), group in groupby(enumerate(ends), lambda item: (item[1].component, item[1].port.kind)):
        members = list(group)
        references = np.array([end.port.reference for _, end in members], np.uint32)
        cuts = [0, *(np.flatnonzero(np.diff(references.astype(np.int64)) != 1) + 1), len(references)]
        if len(references) < _WORTH_A_CALL * (len(cuts) - 1):
            cuts = [0, len(references)]
        blocks.setdefault(component, []).extend(
            Block(kind, references[a:b].copy(), members[a][0]) for a, b in pairwise(cuts))
    return blocks


def make_ledger(plan: Plan) -> Ledger:
    """A ledger of all bonds, before its first entry."""
    def joined(places: list[NDArray[np.int64]]) -> NDArray[np.int64]:
        return np.concatenate([*places, np.zeros(0, np.int64)])

    given = joined([bond.given for bond in plan.bonds])
    return Ledger(given, joined([bond.seen for bond in plan.bonds]), joined([bond.force for bond in plan.bonds]),
                  joined([bond.position for bond in plan.bonds]), *(np.zeros(given.size) for _ in range(5)))


def make_extremes(plan: Plan) -> Extremes:
    """Extremes of the watched outputs, before the first value."""
    n = plan.watched.size
    return Extremes(plan.watched, np.full(n, np.inf), np.full(n, -np.inf), np.zeros(n, np.int64), np.zeros(n, np.int64))


class State:
    """What a run carries from exchange to exchange: both buses, the ledger, the extremes."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.buses = Buses(np.zeros(len(plan.inputs)), np.zeros(len(plan.outputs)), plan.source)
        self.setters, self.getters = make_blocks(plan.inputs), make_blocks(plan.outputs)
        self.ledger, self.extremes = make_ledger(plan), make_extremes(plan)

    def give(self, slave: Slave) -> int:
        """Set all connected inputs of a slave to the newest values. Returns the worst status."""
        worst = 0
        for block in self.setters.get(slave.name, []):
            self.buses.inputs[block.places] = self.buses.outputs[self.buses.source[block.places]]
            worst = max(worst, slave.set(block.references, self.buses.inputs[block.places], block.kind))
        return worst

    def take(self, slave: Slave) -> int:
        """Get all exchanged outputs of a slave. Returns the worst status."""
        return max((slave.get(block.references, self.buses.outputs[block.places], block.kind)
                    for block in self.getters.get(slave.name, [])), default=0)

    def not_finite(self, component: str) -> End | None:
        """The first exchanged output of a component that is no finite number."""
        blocks = self.getters.get(component)
        if not blocks:
            return None
        place = first_not_finite(self.buses.outputs, blocks[0].places.start, blocks[-1].places.stop)
        return self.plan.outputs[place] if place >= 0 else None

    def open_ledger(self) -> None:
        """Take the values at the start as those from which work and extremes are counted."""
        inputs, outputs, ledger = self.buses.inputs, self.buses.outputs, self.ledger
        shown = ledger.seen >= 0
        ledger.last_seen[shown] = inputs[ledger.seen[shown]]
        ledger.last_force[:], ledger.last_position[:] = outputs[ledger.force], outputs[ledger.position]
        widen(self.extremes, outputs, 0)


class Driver(Protocol):
    """Carries out exchanges."""

    def advance(self, first: int, count: int) -> Fault | None:
        """Carry out ``count`` exchanges from exchange number ``first`` on; stop at the first operation that fails."""


class PlainDriver:
    """Calls slaves one by one, from Python. For slaves without C functions, and for debugging."""

    def __init__(self, state: State, slaves: Mapping[str, Slave]) -> None:
        self._state, self._slaves = state, slaves

    def advance(self, first: int, count: int) -> Fault | None:
        """See :class:`Driver`."""
        state, schedule, timing = self._state, self._state.plan.schedule, self._state.plan.timing
        for n in range(first, first + count):
            origin = timing.start + n // schedule.period * schedule.period * schedule.exchange
            for operation in schedule.operations[n % schedule.period]:
                status = self._operate(operation, origin)
                if status > WARNING or status == NOT_FINITE:
                    return Fault(n, operation, status)
            post(state.ledger, state.buses.inputs, state.buses.outputs)
            widen(state.extremes, state.buses.outputs, n + 1)
        return None

    def _operate(self, operation: Operation, origin: int) -> int:
        slave = self._slaves[operation.component]
        if operation.action is Action.SET:
            return self._state.give(slave)
        if operation.action is Action.STEP:
            return slave.step(to_seconds(origin + operation.begin), to_seconds(operation.length))
        status = self._state.take(slave)
        return status if status > WARNING or self._state.not_finite(slave.name) is None else NOT_FINITE


class CompiledDriver:
    """Calls the C functions of FMUs from the compiled loop."""

    def __init__(self, state: State, slaves: Mapping[str, Slave]) -> None:
        plan = state.plan
        self._operations = [operation for exchange in plan.schedule.operations for operation in exchange]
        self._tables = (_program(plan), _steps(plan, slaves),
                        _moves(plan, slaves, state.setters, state.buses.inputs.size, "set"),
                        _moves(plan, slaves, state.getters, state.buses.outputs.size, "get"),
                        state.buses, state.ledger, state.extremes)
        self._directory = directory_of(*self._tables)
        advance_listed(0, 0, self._directory)  # compiles, or loads what was compiled before

    def advance(self, first: int, count: int) -> Fault | None:
        """See :class:`Driver`."""
        done, operation, status = advance_listed(first, count, self._directory)
        return None if status != NOT_FINITE and status <= WARNING else Fault(first + done, self._operations[operation], status)


def _table(values: Sequence[int]) -> NDArray[np.int64]:
    return np.array(values, np.int64)


def _program(plan: Plan) -> Program:
    operations = [operation for exchange in plan.schedule.operations for operation in exchange]
    first = np.cumsum([0, *map(len, plan.schedule.operations)]).astype(np.int64)
    return Program(first, _table([int(o.action) for o in operations]), _table([plan.order.index(o.component) for o in operations]),
                   _table([o.begin for o in operations]), _table([o.length for o in operations]),
                   plan.timing.start, plan.schedule.exchange)


def _steps(plan: Plan, slaves: Mapping[str, Slave]) -> Steps:
    addresses = [slaves[name].addresses for name in plan.order]
    return Steps(_table([a.do_step for a in addresses if a]), _table([a.instance for a in addresses if a]))


def _moves(plan: Plan, slaves: Mapping[str, Slave], blocks: Mapping[str, list[Block]], size: int, direction: str) -> Moves:
    owned = [(slaves[name].addresses, block) for name in plan.order for block in blocks.get(name, [])]
    first = np.cumsum([0, *(len(blocks.get(name, [])) for name in plan.order)]).astype(np.int64)
    return Moves(first, _table([getattr(a, direction)[block.kind] for a, block in owned]),
                 _table([a.instance for a, _ in owned if a]), _table([block.references.ctypes.data for _, block in owned]),
                 _table([block.references.size for _, block in owned]), _table([block.begin for _, block in owned]),
                 _table([block.kind != REAL for _, block in owned]), np.zeros(size, np.int32))


def make_driver(state: State, slaves: Mapping[str, Slave], plain: bool = False) -> Driver:
    """The compiled loop where all slaves have C functions, unless ``plain``."""
    usable = not plain and all(slave.addresses is not None for slave in slaves.values())
    return CompiledDriver(state, slaves) if usable else PlainDriver(state, slaves)
