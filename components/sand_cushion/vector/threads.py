"""Parts of a kernel's work on several threads of the operating system.

Threads live for one call. To start one costs some ten microseconds, so a part should take longer
than that. No result of a part depends on the other parts; then neither the number of threads nor
their order changes a bit.

The calls are written as LLVM IR because a kernel makes them itself, with the same bits in this
process, in an FMU with Python and in a native one. The alternatives fail in one of the three:
numba's ``prange`` needs its runtime, which a native FMU has not, and costs more than it saves below
50,000 discs; a thread pool of Python cannot be used from inside a step; a library in C would need a
compiler where FMUs with Python are made.
"""

import sys
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ..declarations import MOST_THREADS

_NUMBER, _BYTES = ir.IntType(64), ir.IntType(8).as_pointer()
_HAS_THREADS = sys.platform != "win32"
"""Whether there are POSIX threads. Where there are none, and where one cannot be started, parts
follow each other."""


def shared_among_threads(work: Any) -> Any:
    """Return a function for kernels that shares out the calls of a kernel among threads.

    Parameters
    ----------
    work : callable
        Kernel ``work(part, *arguments)``; its result is lost.

    Returns
    -------
    callable
        ``share(threads, parts, *arguments)``, which calls ``work`` for each part from 0 to
        ``parts`` - 1 and returns when all are done. Thread t of T does the parts t, t + T, t + 2 T,
        ...; the last thread is the calling one.
    """

    @intrinsic
    def share(typing: Any, threads: Any, parts: Any, *arguments: Any) -> tuple[Any, Any]:
        kinds = (types.int64, *arguments)
        work.compile(kinds)
        compiled = work.overloads[kinds]

        def generate(
            context: Any, builder: ir.IRBuilder, _: Any, values: list[ir.Value]
        ) -> ir.Value:
            context.add_linking_libs([compiled.library])
            worker = _worker(context, builder, compiled, values[2].type)
            _share(builder, worker, *values)
            return context.get_dummy_value()

        return types.void(types.int64, types.int64, types.StarArgTuple(arguments)), generate

    return share


def _share_type(arguments: ir.Type) -> ir.Type:
    """Return the type of a thread's share of the work.

    It holds the thread's first part, the distance to its next one, the number of parts, and the
    arguments.
    """
    return ir.LiteralStructType([_NUMBER, _NUMBER, _NUMBER, arguments])


def _worker(context: Any, caller: ir.IRBuilder, compiled: Any, arguments: ir.Type) -> ir.Function:
    """Return a function ``void *worker(void *share)`` that does one thread's parts."""
    module = caller.module
    worker = ir.Function(module, ir.FunctionType(_BYTES, [_BYTES]), module.get_unique_name("parts"))
    worker.linkage = "internal"
    builder = ir.IRBuilder(worker.append_basic_block())
    share = builder.bitcast(worker.args[0], _share_type(arguments).as_pointer())
    first, distance, parts, given = (
        builder.load(cgutils.gep_inbounds(builder, share, 0, place)) for place in range(4)
    )
    kernel = context.declare_function(module, compiled.fndesc)
    with cgutils.for_range_slice(builder, first, parts, distance) as (part, _):
        context.call_conv.call_function(
            builder,
            kernel,
            compiled.fndesc.restype,
            compiled.fndesc.argtypes,
            [part, *cgutils.unpack_tuple(builder, given)],
        )
    builder.ret(_BYTES(None))
    return worker


def _share(
    builder: ir.IRBuilder,
    worker: ir.Function,
    threads: ir.Value,
    parts: ir.Value,
    arguments: ir.Value,
) -> None:
    """Start all threads but one, be the last one, and wait for the others."""
    shares = cgutils.alloca_once(builder, _share_type(arguments.type), size=_NUMBER(MOST_THREADS))
    handles = cgutils.alloca_once(builder, _NUMBER, size=_NUMBER(MOST_THREADS))
    used = _least(builder, threads, parts, _NUMBER(MOST_THREADS))
    last = builder.sub(used, _NUMBER(1))

    def told(thread: ir.Value) -> ir.Value:
        share = builder.gep(shares, [thread])
        for place, value in enumerate((thread, used, parts, arguments)):
            builder.store(value, cgutils.gep_inbounds(builder, share, 0, place))
        return builder.bitcast(share, _BYTES)

    with cgutils.for_range(builder, last) as loop:
        share, handle = told(loop.index), builder.gep(handles, [loop.index])
        with builder.if_then(builder.not_(_start(builder, worker, share, handle))):
            builder.store(_NUMBER(0), handle)
            builder.call(worker, [share])
    builder.call(worker, [told(last)])
    with cgutils.for_range(builder, last) as loop:
        handle = builder.load(builder.gep(handles, [loop.index]))
        with builder.if_then(builder.icmp_unsigned("!=", handle, _NUMBER(0))):
            _wait(builder, handle)


def _least(builder: ir.IRBuilder, *numbers: ir.Value) -> ir.Value:
    least = numbers[0]
    for number in numbers[1:]:
        least = builder.select(builder.icmp_signed("<", number, least), number, least)
    return least


def _start(
    builder: ir.IRBuilder, worker: ir.Function, share: ir.Value, handle: ir.Value
) -> ir.Value:
    """Start a thread, and return whether it runs."""
    if not _HAS_THREADS:
        return ir.IntType(1)(0)
    integer = ir.IntType(32)
    kind = ir.FunctionType(integer, [handle.type, _BYTES, worker.type, _BYTES])
    create = cgutils.get_or_insert_function(builder.module, kind, "pthread_create")
    return builder.icmp_signed(
        "==", builder.call(create, [handle, _BYTES(None), worker, share]), integer(0)
    )


def _wait(builder: ir.IRBuilder, handle: ir.Value) -> None:
    """Wait for the end of a thread."""
    if _HAS_THREADS:
        join = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(ir.IntType(32), [_NUMBER, _BYTES]), "pthread_join"
        )
        builder.call(join, [handle, _BYTES(None)])
