"""The exchange loop, compiled: calls the C functions of slaves by their addresses.

What numba makes of it is kept as object code (:mod:`rockshed.core.loop.machine_code`), and this
module is imported only where there is none yet. The global interpreter lock is kept while the loop
runs: FMUs with Python inside need it, and so do slaves that are called back.
"""

import math
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from numba import from_dtype, types
from numba.extending import intrinsic

from ..fmu.fmi3_slave import MOST_RETURNS, ROUNDING
from ..fmu.slave import OK, WARNING
from ..system.schedule import Action
from .polynomials import compiled as _compiled
from .polynomials import extrapolate, keep_values, look_for_jumps
from .tables import (
    BYTE,
    DOUBLE,
    ENDED,
    ENTRY,
    KINDS,
    LONG,
    NOT_FINITE,
    NOT_FITTING,
    NUMBERS,
    SHORT,
    SINGLE,
    STUCK,
    TAKER,
    TRUTH,
    TRUTH_OF_INTEGER,
    Tables,
)

_SET = int(Action.SET)
_STEP = int(Action.STEP)
_GET = int(Action.GET)
_EXTRAPOLATE = int(Action.EXTRAPOLATE)
_OK = OK
_WARNING = WARNING


_intrinsic: Any = intrinsic


def _pointer(builder: Any, value: Any) -> Any:
    return builder.inttoptr(value, ir.IntType(8).as_pointer())


@_intrinsic
def _call_move(  # type: ignore[no-untyped-def]
    _context, function, instance, references, count, values
):
    """Call a C function at an address.

    ``int function(void* instance, const unsigned* references, size_t count, void* values)``
    """

    def generate(_target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.IntType(32), [pointer, pointer, ir.IntType(64), pointer])
        f, c, r, n, v = arguments
        return builder.call(
            builder.inttoptr(f, kind.as_pointer()),
            [_pointer(builder, c), _pointer(builder, r), n, _pointer(builder, v)],
        )

    return types.int32(*[types.int64] * 5), generate


@_intrinsic
def _call_counted_move(  # type: ignore[no-untyped-def]
    _context, function, instance, references, count, values, number
):
    """Call a C function at an address.

    ``int function(void* instance, const unsigned* references, size_t count, void* values,
    size_t number)``
    """

    def generate(_target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        size = ir.IntType(64)
        kind = ir.FunctionType(ir.IntType(32), [pointer, pointer, size, pointer, size])
        f, c, r, n, v, m = arguments
        return builder.call(
            builder.inttoptr(f, kind.as_pointer()),
            [_pointer(builder, c), _pointer(builder, r), n, _pointer(builder, v), m],
        )

    return types.int32(*[types.int64] * 6), generate


@_intrinsic
def _call_step_of_3(  # type: ignore[no-untyped-def]
    _context, function, instance, time, step, forgets, told, reached
):
    """Call a C function at an address.

    ``int function(void* instance, double time, double step, bool forgets, bool* event, bool* end,
    bool* early, double* reached)``; the three answers lie at ``told``, one byte each.
    """

    def generate(_target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        real = ir.DoubleType()
        pointer = ir.IntType(8).as_pointer()
        integer = ir.IntType(32)  # a bool is passed in the lowest byte of a register
        kind = ir.FunctionType(integer, [pointer, real, real, integer, *[pointer] * 4])
        f, c, t, h, forgets, told, reached = arguments
        answers = [builder.add(told, ir.Constant(told.type, place)) for place in range(3)]
        return builder.call(
            builder.inttoptr(f, kind.as_pointer()),
            [
                _pointer(builder, c),
                t,
                h,
                builder.trunc(forgets, integer),
                *(_pointer(builder, place) for place in [*answers, reached]),
            ],
        )

    whole = types.int64
    real = types.float64
    return types.int32(whole, whole, real, real, whole, whole, whole), generate


@_intrinsic
def _call_step(  # type: ignore[no-untyped-def]
    _context, function, instance, time, step, forgets
):
    """Call a C function at an address.

    ``int function(void* instance, double time, double step, int forgets)``
    """

    def generate(_target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        real = ir.DoubleType()
        integer = ir.IntType(32)
        kind = ir.FunctionType(integer, [ir.IntType(8).as_pointer(), real, real, integer])
        f, c, t, h, forgets = arguments
        return builder.call(
            builder.inttoptr(f, kind.as_pointer()),
            [_pointer(builder, c), t, h, builder.trunc(forgets, integer)],
        )

    whole = types.int64
    return types.int32(whole, whole, types.float64, types.float64, whole), generate


@_compiled
def _post(channels, inputs, outputs):  # type: ignore[no-untyped-def]
    """Enter the work of one exchange."""
    for i in range(channels.size):
        if channels[i]["given"] >= 0:
            _post_taker(channels[i], inputs, outputs)
        if channels[i]["seen"] >= 0:
            _post_giver(channels[i], inputs, outputs)


@_compiled
def _post_taker(channel, inputs, outputs):  # type: ignore[no-untyped-def]
    """Enter the work on a taker: the force that was set in it times its own displacement."""
    position = outputs[channel["position"]]
    channel["taken"] += inputs[channel["given"]] * (position - channel["last_position"])
    channel["last_position"] = position


@_compiled
def _post_giver(channel, inputs, outputs):  # type: ignore[no-untyped-def]
    """Enter the work on a giver.

    It sees the position jump from one value to the next while its force changes: the mean of both
    forces times the jump, which is exact for a spring.
    """
    seen = inputs[channel["seen"]]
    force = outputs[channel["force"]]
    channel["given_back"] -= 0.5 * (force + channel["last_force"]) * (seen - channel["last_seen"])
    channel["last_seen"] = seen
    channel["last_force"] = force


@_compiled
def _post_sides(tables, operation):  # type: ignore[no-untyped-def]
    """Enter the work of one step of a component, whose force or motion is another in the next."""
    for i in range(operation["first_posted"], operation["end_posted"]):
        side = tables.posted[i]
        channel = tables.channels[side["channel"]]
        if side["side"] == TAKER:
            _post_taker(channel, tables.inputs, tables.outputs)
        else:
            _post_giver(channel, tables.inputs, tables.outputs)


@_compiled
def _watch(watched, outputs, exchange, units):  # type: ignore[no-untyped-def]
    """Enter the values after so many exchanges into extremes and integrals (trapezoidal rule).

    units: exchange steps since the values before.
    """
    for i in range(watched.size):
        entry = watched[i]
        value = outputs[entry["place"]]
        if value > entry["high"]:
            entry["high"] = value
            entry["high_at"] = exchange
        if value < entry["low"]:
            entry["low"] = value
            entry["low_at"] = exchange
        entry["area"] += 0.5 * (entry["last"] + value) * units
        entry["last"] = value


@_compiled
def _follow(tables, exchange):  # type: ignore[no-untyped-def]
    """Change the inputs of a course for the exchange after so many of them.

    Polynomials of those that are extrapolated begin anew.
    """
    number = tables.course_rows.size
    at = exchange - tables.course_span[0]
    if number == 0 or at < 0 or at >= tables.course_span[1]:
        return
    for i in range(number):
        factor = tables.course[2 * (at * number + i)]
        if factor != factor:  # it is not changed now
            continue
        way = tables.linear[tables.course_rows[i]]
        way["factor"] = factor
        way["offset"] = tables.course[2 * (at * number + i) + 1]
        for row in range(tables.extrapolated.size):
            if tables.extrapolated[row]["place"] == way["place"]:
                tables.extrapolated[row]["known"] = 0


@_compiled
def _has_come(conditions, outputs):  # type: ignore[no-untyped-def]
    """Tell whether a condition that waits is true."""
    for i in range(conditions.size):
        condition = conditions[i]
        if condition["waits"] == 0:
            continue
        value = outputs[condition["place"]]
        number = condition["number"]
        sign = condition["sign"]
        if (
            (sign == 0 and value < number)
            or (sign == 1 and value <= number)
            or (sign == 2 and value > number)
            or (sign == 3 and value >= number)
        ):
            return True
    return False


@_compiled
def _is_bad(status):  # type: ignore[no-untyped-def]
    """Tell whether a run has to end at this status."""
    return status > _WARNING or status < _OK


@_compiled
def _lost(values):  # type: ignore[no-untyped-def]
    """Count the values that are no finite numbers.

    Without a way out in between, the compiler takes several at a time.
    """
    count = 0
    for i in range(values.size):
        count += 0 if math.isfinite(values[i]) else 1
    return count


@_compiled
def _give(tables, move, begin_of_step, length):  # type: ignore[no-untyped-def]
    """Set connected inputs of a component to the newest values; return the status.

    Those that are extrapolated, for a step (ticks).
    """
    begin = move["begin"]
    number = move["number"]
    inputs = tables.inputs[begin : begin + number]
    source = tables.source[begin : begin + number]
    for i in range(number):
        inputs[i] = tables.outputs[source[i]]
    for i in range(move["first_linear"], move["end_linear"]):
        way = tables.linear[i]
        value = tables.inputs[way["place"]]
        tables.inputs[way["place"]] = way["factor"] * value + way["offset"]
    if move["first_extrapolated"] < move["end_extrapolated"]:
        keep_values(tables, move, begin_of_step)
        extrapolate(tables, move, begin_of_step, length)
    return _set(tables, move)


@_compiled
def _give_extrapolated(tables, move, begin, length):  # type: ignore[no-untyped-def]
    """Set connected inputs of a component for another step (ticks); return the status."""
    if move["first_extrapolated"] == move["end_extrapolated"]:
        return _OK
    extrapolate(tables, move, begin, length)
    return _set(tables, move)


@_compiled
def _set(tables, move):  # type: ignore[no-untyped-def]
    """Set inputs of a component to the values on the bus; return the status."""
    begin = move["begin"]
    address = tables.inputs.ctypes.data + 8 * begin
    if move["form"] != DOUBLE:
        inputs = tables.inputs[begin : begin + move["number"]]
        if _pack(tables, move, inputs) > 0:
            return NOT_FITTING
        address = tables.longs.ctypes.data
    return _call(move, address)


@_compiled
def _call(move, address):  # type: ignore[no-untyped-def]
    """Let an FMU set or get the values at an address; return the status."""
    function = move["function"]
    instance = move["instance"]
    references = move["references"]
    count = move["count"]
    if move["is_counted"]:
        number = move["number"]
        return _call_counted_move(function, instance, references, count, address, number)
    return _call_move(function, instance, references, count, address)


@_compiled
def _pack(tables, move, values):  # type: ignore[no-untyped-def]
    """Write values into the buffer as they travel; return how many do not fit."""
    form = move["form"]
    unfit = 0
    for i in range(values.size):
        value = values[i]
        if not move["low"] <= value <= move["high"]:
            unfit += 1
        elif form == SINGLE:
            tables.singles[i] = value
        elif form in (BYTE, TRUTH):
            tables.bytes[i] = int(value)
        elif form == SHORT:
            tables.shorts[i] = int(value)
        elif form == LONG:
            tables.longs[i] = int(value)
        else:
            tables.integers[i] = int(value)
    return unfit


@_compiled
def _unpack(tables, move, values):  # type: ignore[no-untyped-def]
    """Read values from the buffer; return how many the bus cannot hold."""
    form = move["form"]
    bits = 0
    unfit = 0
    for i in range(values.size):
        if form == SINGLE:
            values[i] = tables.singles[i]
            continue
        if form in (BYTE, TRUTH):
            value = float(tables.bytes[i])
            bits = 8
        elif form == SHORT:
            value = float(tables.shorts[i])
            bits = 16
        elif form == LONG:
            value = float(tables.longs[i])
            bits = 64
        else:
            value = float(tables.integers[i])
            bits = 32
        if form in (TRUTH, TRUTH_OF_INTEGER):
            value = 1.0 if value != 0.0 else 0.0
        elif value < 0.0 and move["low"] == 0.0:
            value += 2.0**bits
        values[i] = value
        unfit += 0 if move["low"] <= value <= move["high"] else 1
    return unfit


@_compiled
def _take(tables, move, values, base):  # type: ignore[no-untyped-def]
    """Get outputs of a component into a row of numbers that begins at ``base``.

    Returns the status, or :data:`NOT_FINITE`.
    """
    begin = base + move["begin"]
    number = move["number"]
    address = values.ctypes.data + 8 * begin
    if move["form"] != DOUBLE:
        address = tables.longs.ctypes.data
    status = _call(move, address)
    if _is_bad(status):
        return status
    if move["form"] != DOUBLE and _unpack(tables, move, values[begin : begin + number]) > 0:
        return NOT_FITTING
    if _lost(values[begin : begin + number]) > 0:
        return NOT_FINITE
    return status


@_compiled
def _step_in_parts(tables, number, time, step):  # type: ignore[no-untyped-def]
    """Make a step of FMI 3.0, in as many parts as the FMU makes of it; return the status."""
    operation = tables.operations[number]
    told = tables.told.ctypes.data
    reached = tables.reached.ctypes.data
    end = time + step
    worst = 0
    for _ in range(MOST_RETURNS):
        tables.told[0] = 0
        tables.reached[0] = time
        status = _call_step_of_3(
            operation["do_step"], operation["instance"], time, step, tables.forgets, told, reached
        )
        if _is_bad(status):
            return status
        if status != 0:
            worst = status
        if tables.told[0] >> 8 & 255:
            return ENDED
        at = tables.reached[0]
        if tables.told[0] >> 16 & 255 == 0 or at >= end - ROUNDING * abs(end):
            return worst
        if not at >= time:  # at the time of an event, a step may come no further
            return STUCK
        tables.returned[number] += 1
        tables.jumps[operation["owner"]] += 1
        time = at
        step = end - time
    return STUCK


@_compiled
def _operate(tables, number, origin):  # type: ignore[no-untyped-def]
    """Carry out an operation of a period that began at the tick ``origin``.

    Returns the first bad status, or the worst one.
    """
    operation = tables.operations[number]
    if operation["action"] == _STEP:
        time = float(origin + operation["begin"]) / float(tables.rate)
        step = float(operation["length"]) / float(tables.rate)
        if operation["may_return"]:
            return _step_in_parts(tables, number, time, step)
        return _call_step(operation["do_step"], operation["instance"], time, step, tables.forgets)
    worst = 0
    begin = origin + operation["begin"]
    for m in range(operation["first_move"], operation["end_move"]):
        if operation["action"] == _SET:
            status = _give(tables, tables.moves[m], begin, operation["length"])
        elif operation["action"] == _EXTRAPOLATE:
            status = _give_extrapolated(tables, tables.moves[m], begin, operation["length"])
        else:
            status = _take(tables, tables.moves[m], tables.outputs, 0)
        if _is_bad(status):
            return status
        if status != 0:
            worst = status
    if operation["action"] == _GET:
        look_for_jumps(tables, operation)
        _post_sides(tables, operation)
    return worst


@_compiled
def _record(tables, base):  # type: ignore[no-untyped-def]
    """Take a snapshot into the row that begins at ``base``.

    Returns the operation that failed, and its status.
    """
    for i in range(tables.exchanged):
        tables.snapshots[base + i] = tables.outputs[i]
    works = base + tables.width - 2 * tables.channels.size
    for i in range(tables.channels.size):
        tables.snapshots[works + i] = tables.channels[i]["taken"]
        tables.snapshots[works + tables.channels.size + i] = tables.channels[i]["given_back"]
    for o in range(tables.recording, tables.operations.size):
        tables.journal[1] = o
        for m in range(tables.operations[o]["first_move"], tables.operations[o]["end_move"]):
            status = _take(tables, tables.moves[m], tables.snapshots, base)
            if _is_bad(status):
                return o, status
            if status != 0:
                tables.warned[o] += 1
    tables.journal[1] = -1
    return 0, 0


@_compiled
def advance(tables, first, count):  # type: ignore[no-untyped-def]
    """Carry out exchanges, and take the snapshots that are due.

    Parameters
    ----------
    tables : Tables
        Values and addresses.
    first : int
        Number of exchange steps before the first exchange.
    count : int
        How many exchanges. With 0, a snapshot of the present values is taken.

    Returns
    -------
    (int, int, int)
        Number of exchange steps before the exchange that failed; operation and status that ended
        the loop early, status OK if none did.
    """
    if count == 0:
        tables.journal[0] = first - 1
        o, status = _record(tables, tables.row * tables.width)
        return -1, o, status
    period = tables.first.size - 1
    units = tables.units
    for i in range(count):
        n = first + i * units
        origin = tables.start + n // period * period * tables.exchange
        tables.journal[0] = n
        _follow(tables, n)
        for o in range(tables.first[n % period], tables.first[n % period + 1]):
            tables.journal[1] = o
            status = _operate(tables, o, origin)
            if status != 0:
                if _is_bad(status):
                    return n - first, o, status
                tables.warned[o] += 1
        _post(tables.channels, tables.inputs, tables.outputs)
        end = n + units
        _watch(tables.watched, tables.outputs, end, units)
        if end % tables.every == 0:
            row = tables.row + end // tables.every - first // tables.every - 1
            o, status = _record(tables, row * tables.width)
            if status != 0:
                return n - first, o, status
        tables.journal[1] = -1
        if _has_come(tables.conditions, tables.outputs):
            return end - first, 0, 0
    return count * units, 0, 0


def object_code(target: llvm.TargetMachine) -> bytes:
    """Compile :func:`advance` to object code that needs nothing from outside.

    Its one C function :data:`ENTRY` takes the address of :func:`rockshed.core.loop.tables.head`,
    ``first``, ``count``, and the address of three numbers for the result.

    Parameters
    ----------
    target : llvmlite.binding.TargetMachine
        Processor.

    Returns
    -------
    bytes
        An object file.
    """
    arrays = [types.Array(from_dtype(kind), 1, "C") for kind in KINDS.values()]
    tables = types.NamedTuple([*[types.int64] * len(NUMBERS), *arrays], Tables)
    signature = (tables, types.int64, types.int64)
    advance.compile(signature)
    compiled = advance.overloads[signature]
    whole = llvm.parse_assembly(compiled.library.get_llvm_str())
    whole.link_in(llvm.parse_assembly(str(_entry(compiled))))
    for function in whole.functions:
        if not function.is_declaration and function.name != ENTRY:
            function.linkage = "internal"
            # a call would pass all tables on, field by field
            function.add_function_attribute("alwaysinline")
    builder = llvm.create_pass_builder(target, llvm.create_pipeline_tuning_options(speed_level=3))
    builder.getModulePassManager().run(whole, builder)
    foreign = [
        f.name for f in whole.functions if f.is_declaration and not f.name.startswith("llvm.")
    ]
    assert not foreign, f"the loop needs {', '.join(foreign)}"
    code = target.emit_object(whole)
    assert isinstance(code, bytes)
    return code


def _entry(compiled: Any) -> ir.Module:
    """Return the C function, which calls the compiled one by numba's own convention.

    Nothing in that one raises, so its status says nothing.
    """
    module = ir.Module()
    integer = ir.IntType(64)
    convention = compiled.target_context.call_conv
    descriptor = compiled.fndesc
    kind = convention.get_function_type(descriptor.restype, descriptor.argtypes)
    callee = ir.Function(module, kind, descriptor.llvm_func_name)
    entry = ir.Function(module, ir.FunctionType(integer, [integer] * 4), ENTRY)
    builder = ir.IRBuilder(entry.append_basic_block())
    head, first, count, outcome = entry.args
    results = [builder.alloca(callee.function_type.args[place].pointee) for place in range(2)]
    tables = _table_arguments(builder, head, callee.function_type.args[2:])
    builder.call(callee, [*results, *tables, first, count])
    found = builder.load(results[0])
    for place in range(3):
        builder.store(builder.extract_value(found, place), _number(builder, outcome, place))
    builder.ret(integer(0))
    return module


def _table_arguments(builder: Any, head: Any, kinds: Any) -> list[Any]:
    """Return the fields of :class:`Tables` as numba passes them, read from their head."""
    integer = ir.IntType(64)
    arguments = [builder.load(_number(builder, head, place)) for place in range(len(NUMBERS))]
    for place, kind in enumerate(KINDS.values()):
        at = len(NUMBERS) + 2 * place
        address = builder.load(_number(builder, head, at))
        length = builder.load(_number(builder, head, at + 1))
        owner, parent, _elements, _bytes, data = kinds[len(arguments) :][:5]
        size = integer(kind.itemsize)
        values = builder.inttoptr(address, data)
        # owner, parent, number of elements, bytes of one, data, shape, strides
        arguments += [owner(None), parent(None), length, size, values, length, size]
    return arguments


def _number(builder: Any, address: Any, place: int) -> Any:
    """Return a pointer to an integer in a row at an address."""
    integer = ir.IntType(64)
    return builder.gep(builder.inttoptr(address, integer.as_pointer()), [integer(place)])
