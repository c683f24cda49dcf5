"""The exchange loop, compiled: calls the C functions of FMUs by their addresses, whatever the FMUs are.

Everything that is compiled is in this file, because numba's cache notices changes of the file a function is in, and no others.
All tables are flat arrays of int64 (addresses, places, ticks), values are float64. The global interpreter lock is kept: FMUs with
Python inside need it.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import carray, njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from .clock import TICKS_PER_SECOND
from .schedule import Action
from .slave import WARNING

Table = NDArray[np.int64]
Floats = NDArray[np.float64]

NOT_FINITE = -1
"""Outcome of an operation that brought a value that is no finite number."""

_SET, _STEP, _GET = int(Action.SET), int(Action.STEP), int(Action.GET)
_WARNING = WARNING
_TICKS_PER_SECOND = float(TICKS_PER_SECOND)


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    """Compile with numba and keep the result; without a place to keep it, compile anew in each process."""
    try:
        return njit(cache=True, error_model="numpy", **options)(function)
    except RuntimeError:
        return njit(error_model="numpy", **options)(function)


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a function that makes no arrays: references to them need not be counted, which would cost 7 us an exchange."""
    return _compile(function, _nrt=False)


def compiled_with_references(function: Callable[..., Any]) -> Any:
    """Compile a function that returns arrays."""
    return _compile(function)


class Program(NamedTuple):
    """The schedule as tables: operations ``first[i]`` to ``first[i + 1]`` happen in exchange i of a period. Times in ticks."""

    first: Table
    action: Table
    component: Table
    begin: Table
    length: Table
    start: int
    exchange: int


class Moves(NamedTuple):
    """Bulk calls that move values: those of component c are ``first[c]`` to ``first[c + 1]``.

    function, instance, references: addresses. ``number`` values from place ``begin`` of the bus on; ``whole`` where they travel as
    32-bit integers, by way of the buffer ``integers``.
    """

    first: Table
    function: Table
    instance: Table
    references: Table
    number: Table
    begin: Table
    whole: Table
    integers: NDArray[np.int32]


class Steps(NamedTuple):
    """Addresses of each component's doStep and of its instance."""

    function: Table
    instance: Table


class Buses(NamedTuple):
    """Values on their way: inputs, outputs, and for each input the place of the output that feeds it."""

    inputs: Floats
    outputs: Floats
    source: Table


class Ledger(NamedTuple):
    """Work through power bonds, one channel for each force. Places as in :class:`orchestrator.core.plan.Bond`.

    taken, given_back: work (J) on the taker, and on the giver by what it was shown.
    """

    given: Table
    seen: Table
    force: Table
    position: Table
    last_seen: Floats
    last_force: Floats
    last_position: Floats
    taken: Floats
    given_back: Floats


class Extremes(NamedTuple):
    """Smallest and largest value of watched outputs, and the exchanges after which they were reached."""

    place: Table
    low: Floats
    high: Floats
    low_at: Table
    high_at: Table


@compiled
def post(ledger: Ledger, inputs: Floats, outputs: Floats) -> None:
    """Enter the work of one exchange.

    The taker moves under the force that it was given at the exchange: force times its own displacement. The giver sees the
    position jump from one value to the next while its force changes: the mean of both forces times the jump, which is exact
    for a spring.
    """
    for i in range(ledger.given.size):
        position = outputs[ledger.position[i]]
        ledger.taken[i] += inputs[ledger.given[i]] * (position - ledger.last_position[i])
        ledger.last_position[i] = position
        if ledger.seen[i] >= 0:
            seen, force = inputs[ledger.seen[i]], outputs[ledger.force[i]]
            ledger.given_back[i] -= 0.5 * (force + ledger.last_force[i]) * (seen - ledger.last_seen[i])
            ledger.last_seen[i], ledger.last_force[i] = seen, force


@compiled
def widen(extremes: Extremes, outputs: Floats, exchange: int) -> None:
    """Enter the values after ``exchange`` exchanges into the extremes."""
    for i in range(extremes.place.size):
        value = outputs[extremes.place[i]]
        if value > extremes.high[i]:
            extremes.high[i], extremes.high_at[i] = value, exchange
        if value < extremes.low[i]:
            extremes.low[i], extremes.low_at[i] = value, exchange


@compiled
def first_not_finite(values: Floats, begin: int, end: int) -> int:
    """Place of the first value that is not a finite number; -1 if there is none."""
    for i in range(begin, end):
        if not math.isfinite(values[i]):
            return i
    return -1


_intrinsic: Any = intrinsic


def _pointer(builder: Any, value: Any) -> Any:
    return builder.inttoptr(value, ir.IntType(8).as_pointer())


@_intrinsic
def _call_move(_context, function, instance, references, count, values):  # type: ignore[no-untyped-def]
    """``int function(void* instance, const unsigned* references, size_t count, void* values)`` at an address."""
    def generate(_target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.IntType(32), [pointer, pointer, ir.IntType(64), pointer])
        f, c, r, n, v = arguments
        return builder.call(builder.inttoptr(f, kind.as_pointer()),
                            [_pointer(builder, c), _pointer(builder, r), n, _pointer(builder, v)])
    return types.int32(*[types.int64] * 5), generate


@_intrinsic
def _call_step(_context, function, instance, time, step):  # type: ignore[no-untyped-def]
    """``int function(void* instance, double time, double step, int)`` at an address; no earlier state will be asked for."""
    def generate(_target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        real, integer = ir.DoubleType(), ir.IntType(32)
        kind = ir.FunctionType(integer, [ir.IntType(8).as_pointer(), real, real, integer])
        f, c, t, h = arguments
        return builder.call(builder.inttoptr(f, kind.as_pointer()), [_pointer(builder, c), t, h, ir.Constant(integer, 1)])
    return types.int32(types.int64, types.int64, types.float64, types.float64), generate


@compiled
def _give(buses: Buses, moves: Moves, component: int) -> int:
    """Set all connected inputs of a component. Returns the worst status."""
    worst = 0
    for b in range(moves.first[component], moves.first[component + 1]):
        begin, count = moves.begin[b], moves.number[b]
        for i in range(begin, begin + count):
            buses.inputs[i] = buses.outputs[buses.source[i]]
        address = buses.inputs.ctypes.data + 8 * begin
        if moves.whole[b]:
            for i in range(begin, begin + count):
                moves.integers[i] = int(buses.inputs[i])
            address = moves.integers.ctypes.data + 4 * begin
        worst = max(worst, _call_move(moves.function[b], moves.instance[b], moves.references[b], count, address))
    return worst


@compiled
def _take(buses: Buses, moves: Moves, component: int) -> int:
    """Get all exchanged outputs of a component. Returns the worst status."""
    worst = 0
    for b in range(moves.first[component], moves.first[component + 1]):
        begin, count = moves.begin[b], moves.number[b]
        address = (moves.integers.ctypes.data + 4 * begin) if moves.whole[b] else (buses.outputs.ctypes.data + 8 * begin)
        worst = max(worst, _call_move(moves.function[b], moves.instance[b], moves.references[b], count, address))
        if moves.whole[b]:
            for i in range(begin, begin + count):
                buses.outputs[i] = float(moves.integers[i])
    return worst


@compiled
def _operate(o, origin, program, steps, setters, getters, buses):  # type: ignore[no-untyped-def]
    """Carry out operation ``o`` of a period that began at the tick ``origin``. Returns the FMI status."""
    component = program.component[o]
    if program.action[o] == _SET:
        return _give(buses, setters, component)
    if program.action[o] == _GET:
        return _take(buses, getters, component)
    time = float(origin + program.begin[o]) / _TICKS_PER_SECOND
    return _call_step(steps.function[component], steps.instance[component], time, float(program.length[o]) / _TICKS_PER_SECOND)


@compiled
def advance(first, count, program, steps, setters, getters, buses, ledger, extremes):  # type: ignore[no-untyped-def]
    """Carry out ``count`` exchanges from exchange number ``first`` on.

    Returns (exchanges carried out, operation, status): the operation that ended the run early and its status, WARNING or less
    if none did. :data:`NOT_FINITE` stands for a status of its own.
    """
    period = program.first.size - 1
    for n in range(first, first + count):
        origin = program.start + n // period * period * program.exchange
        for o in range(program.first[n % period], program.first[n % period + 1]):
            status = _operate(o, origin, program, steps, setters, getters, buses)
            if status > _WARNING:
                return n - first, o, status
            if program.action[o] == _GET:
                begin, end = getters.first[program.component[o]], getters.first[program.component[o] + 1]
                if begin < end and first_not_finite(buses.outputs, getters.begin[begin],
                                                    getters.begin[end - 1] + getters.number[end - 1]) >= 0:
                    return n - first, o, NOT_FINITE
        post(ledger, buses.inputs, buses.outputs)
        widen(extremes, buses.outputs, n + 1)
    return count, 0, 0


# --- one argument instead of forty-two: taking the tables apart would cost 10 us a call

def _as_pointer(kind: Any) -> Any:
    """Function that takes an address for a pointer to numbers of a kind."""
    @_intrinsic
    def pointer(_context, address):  # type: ignore[no-untyped-def]
        def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return builder.inttoptr(arguments[0], target.get_value_type(signature.return_type))
        return types.CPointer(kind)(types.int64), generate
    return pointer


_to_reals, _to_integers, _to_words = _as_pointer(types.float64), _as_pointer(types.int64), _as_pointer(types.int32)


@compiled_with_references
def _reals(directory, entry):  # type: ignore[no-untyped-def]
    return carray(_to_reals(directory[2 * entry]), (directory[2 * entry + 1],))


@compiled_with_references
def _integers(directory, entry):  # type: ignore[no-untyped-def]
    return carray(_to_integers(directory[2 * entry]), (directory[2 * entry + 1],))


@compiled_with_references
def _words(directory, entry):  # type: ignore[no-untyped-def]
    return carray(_to_words(directory[2 * entry]), (directory[2 * entry + 1],))


@compiled_with_references
def _listed_moves(d, at):  # type: ignore[no-untyped-def]
    return Moves(_integers(d, at), _integers(d, at + 1), _integers(d, at + 2), _integers(d, at + 3), _integers(d, at + 4),
                 _integers(d, at + 5), _integers(d, at + 6), _words(d, at + 7))


def directory_of(*tables: NamedTuple) -> Table:
    """Address and length of every array of the tables, one after the other; a number stands for itself. The tables must be kept."""
    return np.array([entry for table in tables for value in table
                     for entry in ((value.ctypes.data, value.size) if isinstance(value, np.ndarray) else (value, 0))], np.int64)


@compiled_with_references
def advance_listed(first, count, d):  # type: ignore[no-untyped-def]
    """:func:`advance` with the tables that :func:`directory_of` has listed in ``d``, in the order of its arguments."""
    program = Program(_integers(d, 0), _integers(d, 1), _integers(d, 2), _integers(d, 3), _integers(d, 4), d[10], d[12])
    steps = Steps(_integers(d, 7), _integers(d, 8))
    buses = Buses(_reals(d, 25), _reals(d, 26), _integers(d, 27))
    ledger = Ledger(_integers(d, 28), _integers(d, 29), _integers(d, 30), _integers(d, 31), _reals(d, 32), _reals(d, 33),
                    _reals(d, 34), _reals(d, 35), _reals(d, 36))
    extremes = Extremes(_integers(d, 37), _reals(d, 38), _reals(d, 39), _integers(d, 40), _integers(d, 41))
    return advance(first, count, program, steps, _listed_moves(d, 9), _listed_moves(d, 17), buses, ledger, extremes)
