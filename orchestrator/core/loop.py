"""The exchange loop, compiled: calls the C functions of FMUs by their addresses, whatever the FMUs are.

Everything that is compiled is in this file, because numba's cache notices changes of the file a function is in, and no others.
Addresses, places and ticks are int64, values are float64. The global interpreter lock is kept: FMUs with Python inside need it.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from .clock import TICKS_PER_SECOND
from .schedule import Action
from .slave import WARNING

Records = NDArray[np.void]
Floats = NDArray[np.float64]

NOT_FINITE = -1
"""Outcome of an operation that brought a value that is no finite number."""

_SET, _STEP = int(Action.SET), int(Action.STEP)
_WARNING = WARNING
_TICKS_PER_SECOND = float(TICKS_PER_SECOND)


def compiled(function: Callable[..., Any]) -> Any:
    """Compile with numba and keep the result; without a place to keep it, compile anew in each process.

    Nothing is allocated, so arrays need no counted references; counting them would cost 7 us an exchange.
    """
    try:
        return njit(cache=True, error_model="numpy", _nrt=False)(function)
    except RuntimeError:
        return njit(error_model="numpy", _nrt=False)(function)


def _record(integers: str, reals: str = "") -> np.dtype[np.void]:
    return np.dtype([(name, np.int64) for name in integers.split()] + [(name, np.float64) for name in reals.split()])


OPERATION = _record("action instance do_step begin length first_move end_move")
"""One action of the schedule. instance, do_step: addresses. begin, length: of a step, in ticks, from the beginning of the period.
first_move, end_move: rows in the table of moves, for any other action."""

MOVE = _record("function instance references number begin whole")
"""A bulk call that moves ``number`` values from place ``begin`` of a bus on. function, instance, references: addresses. whole: the
values travel as 32-bit integers."""

CHANNEL = _record("given seen force position", "last_seen last_force last_position taken given_back")
"""A force of a power bond. Places as in :class:`orchestrator.core.plan.Bond`. taken, given_back: work (J) on the taker, and on the
giver by what it was shown."""

WATCHED = _record("place low_at high_at", "low high last area")
"""Smallest and largest value of a watched output, and the exchanges after which they were reached; its newest value, and the area
under it: its integral in units of the exchange step."""


class Tables(NamedTuple):
    """Everything that the loop works on. Few arrays with many fields: taking an argument apart costs 0.25 us an array.

    first: operations ``first[i]`` to ``first[i + 1]`` are those of exchange i of a period. start, exchange: ticks.
    inputs, outputs: the two buses. source: for each input, the place of the output that feeds it.
    integers: buffer for values on their way as integers, as long as the longer bus.
    """

    start: int
    exchange: int
    first: NDArray[np.int64]
    operations: Records
    moves: Records
    inputs: Floats
    outputs: Floats
    source: NDArray[np.int64]
    integers: NDArray[np.int32]
    channels: Records
    watched: Records


@compiled
def post(channels: Records, inputs: Floats, outputs: Floats) -> None:
    """Enter the work of one exchange.

    The taker moves under the force that it was given at the exchange: force times its own displacement. The giver sees the
    position jump from one value to the next while its force changes: the mean of both forces times the jump, which is exact
    for a spring.
    """
    for i in range(channels.size):
        channel = channels[i]
        position = outputs[channel["position"]]
        channel["taken"] += inputs[channel["given"]] * (position - channel["last_position"])
        channel["last_position"] = position
        if channel["seen"] >= 0:
            seen, force = inputs[channel["seen"]], outputs[channel["force"]]
            channel["given_back"] -= 0.5 * (force + channel["last_force"]) * (seen - channel["last_seen"])
            channel["last_seen"] = seen
            channel["last_force"] = force


@compiled
def watch(watched: Records, outputs: Floats, exchange: int) -> None:
    """Enter the values after ``exchange`` exchanges into extremes and integrals (trapezoidal rule)."""
    for i in range(watched.size):
        entry = watched[i]
        value = outputs[entry["place"]]
        if value > entry["high"]:
            entry["high"] = value
            entry["high_at"] = exchange
        if value < entry["low"]:
            entry["low"] = value
            entry["low_at"] = exchange
        if exchange > 0:
            entry["area"] += 0.5 * (entry["last"] + value)
        entry["last"] = value


@compiled
def is_bad(status: int) -> bool:
    """Whether a run has to end at this status."""
    return status > _WARNING or status == NOT_FINITE


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
def _give(tables, move):  # type: ignore[no-untyped-def]
    """Set connected inputs of a component to the newest values. Returns the status."""
    begin, end = move["begin"], move["begin"] + move["number"]
    for i in range(begin, end):
        tables.inputs[i] = tables.outputs[tables.source[i]]
    address = tables.inputs.ctypes.data + 8 * begin
    if move["whole"]:
        for i in range(begin, end):
            tables.integers[i] = int(tables.inputs[i])
        address = tables.integers.ctypes.data + 4 * begin
    return _call_move(move["function"], move["instance"], move["references"], move["number"], address)


@compiled
def _take(tables, move):  # type: ignore[no-untyped-def]
    """Get exchanged outputs of a component. Returns the status, or :data:`NOT_FINITE`."""
    begin, end = move["begin"], move["begin"] + move["number"]
    address = (tables.integers.ctypes.data + 4 * begin) if move["whole"] else (tables.outputs.ctypes.data + 8 * begin)
    status = _call_move(move["function"], move["instance"], move["references"], move["number"], address)
    if move["whole"]:
        for i in range(begin, end):
            tables.outputs[i] = float(tables.integers[i])
    if status <= _WARNING and first_not_finite(tables.outputs, begin, end) >= 0:
        return NOT_FINITE
    return status


@compiled
def _operate(tables, operation, origin):  # type: ignore[no-untyped-def]
    """Carry out an operation of a period that began at the tick ``origin``. Returns the first bad status, or OK."""
    if operation["action"] == _STEP:
        time = float(origin + operation["begin"]) / _TICKS_PER_SECOND
        return _call_step(operation["do_step"], operation["instance"], time, float(operation["length"]) / _TICKS_PER_SECOND)
    for m in range(operation["first_move"], operation["end_move"]):
        status = _give(tables, tables.moves[m]) if operation["action"] == _SET else _take(tables, tables.moves[m])
        if is_bad(status):
            return status
    return 0


@compiled
def advance(tables, first, count):  # type: ignore[no-untyped-def]
    """Carry out ``count`` exchanges from exchange number ``first`` on.

    Returns (exchanges carried out, operation, status): the operation that ended the run early and its status, OK if none did.
    """
    period = tables.first.size - 1
    for n in range(first, first + count):
        origin = tables.start + n // period * period * tables.exchange
        for o in range(tables.first[n % period], tables.first[n % period + 1]):
            status = _operate(tables, tables.operations[o], origin)
            if is_bad(status):
                return n - first, o, status
        post(tables.channels, tables.inputs, tables.outputs)
        watch(tables.watched, tables.outputs, n + 1)
    return count, 0, 0
