"""The logger of FMI 2.0, which FMUs call as printf: with a format, and values for it.

Python cannot take such values. fmpy brings a proxy in C that makes a text of them, but none for ARM
under Linux: there the same function is made by LLVM.
"""

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

LONGEST_TEXT = 4096
"""Bytes of a message that are kept, with the zero at its end."""


_kept: dict[int, Any] = {}
"""Loggers and owners of proxies, by address: FMUs may call them as long as the process lives."""


def set_logger(callbacks: fmi2CallbackFunctions, logger: fmi2CallbackLoggerTYPE) -> None:
    """Have callbacks call a logger with a text, in place of a format and values.

    Parameters
    ----------
    callbacks : fmi2CallbackFunctions
        Those of an instance.
    logger : fmi2CallbackLoggerTYPE
        It lives as long as the process. One serves all instances: fmpy's proxy remembers only the
        last one.
    """
    address = int(ctypes.cast(logger, ctypes.c_void_p).value or 0)
    _kept[address] = logger
    callbacks.logger = logger
    add = _proxy_of_fmpy()
    if add is not None:
        add(ctypes.byref(callbacks))
    else:
        callbacks.logger = fmi2CallbackLoggerTYPE(proxy(address))


@cache
def _proxy_of_fmpy() -> Callable[[Any], None] | None:
    """Return the function of fmpy that puts its proxy in the place of a logger, if it has one."""
    try:
        from fmpy.logging import addLoggerProxy  # loads a library, which may be missing
    except OSError:
        return None
    found: Callable[[Any], None] = addLoggerProxy
    return found


_PROXY = """
@none = private constant [1 x i8] zeroinitializer
declare i32 @vsnprintf(ptr, i64, ptr, ptr)
declare void @llvm.va_start.p0(ptr)
declare void @llvm.va_end.p0(ptr)

define void @proxy(ptr %environment, ptr %name, i32 %status, ptr %category, ptr %format, ...) {{
    %values = alloca [32 x i8], align 16  ; va_list has 24 bytes on x86-64, 32 on ARM
    %text = alloca [{length} x i8]
    %is_none = icmp eq ptr %format, null
    %shown = select i1 %is_none, ptr @none, ptr %format
    call void @llvm.va_start.p0(ptr %values)
    call i32 @vsnprintf(ptr %text, i64 {length}, ptr %shown, ptr %values)
    call void @llvm.va_end.p0(ptr %values)
    %logger = inttoptr i64 {logger} to ptr
    call void %logger(ptr %environment, ptr %name, i32 %status, ptr %category, ptr %text)
    ret void
}}
"""
"""It is right where va_list is passed by its address: x86-64 and ARM under Linux."""


@cache
def proxy(logger: int) -> int:
    """Return the address of a function that formats a message and calls a logger with it.

    Parameters
    ----------
    logger : int
        Address of the logger, which takes environment, name, status, category and text.

    Returns
    -------
    int
        It lives as long as the process.
    """
    import llvmlite.binding as llvm  # of no use where fmpy has a proxy

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module = llvm.parse_assembly(_PROXY.format(length=LONGEST_TEXT, logger=logger))
    machine = llvm.Target.from_default_triple().create_target_machine()
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    address = int(engine.get_function_address("proxy"))
    _kept[address] = engine
    return address
