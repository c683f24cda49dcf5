"""The exchange loop as machine code.

It is compiled by numba once, kept on this computer, and from then on loaded without numba.
"""

import ctypes
import hashlib
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm

from rockshed.components.common.cache import cache_directory
from rockshed.components.common.kept import is_sound, keep, kept

from ...versions import version_of
from .tables import ENTRY, IntegerTable

Advance = Callable[[IntegerTable, int, int], tuple[int, int, int]]
"""The function :func:`rockshed.core.loop.compiled.advance`, with the :func:`~.tables.head` of the
tables in the place of the tables."""

_CORE = Path(__file__).parents[1]
_SOURCES = (
    "system/clock.py",
    "loop/compiled.py",
    "loop/polynomials.py",
    "loop/machine_code.py",
    "system/schedule.py",
    "fmu/slave.py",
    "fmu/fmi3_slave.py",
    "loop/tables.py",
)
"""Files that the machine code follows from."""


@cache
def _engine() -> Any:
    """Return the machine code in memory."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=_features(), opt=3, codemodel="jitdefault"
    )
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target)
    engine.add_object_file(llvm.ObjectFileRef.from_data(_code(target)))
    engine.finalize_object()
    return engine


@cache
def advance() -> Advance:
    """Return the loop, ready to be called.

    The global interpreter lock is kept during the call.
    """
    integer = ctypes.c_int64
    kind = ctypes.PYFUNCTYPE(integer, integer, integer, integer, integer)
    function = kind(_engine().get_function_address(ENTRY))

    def call(head: IntegerTable, first: int, count: int) -> tuple[int, int, int]:
        outcome = (integer * 3)()
        function(head.ctypes.data, first, count, ctypes.addressof(outcome))
        return outcome[0], outcome[1], outcome[2]

    return call


def _features() -> str:
    return str(llvm.get_host_cpu_features().flatten())


def _code(target: llvm.TargetMachine) -> bytes:
    """Return object code from the cache, or compile and keep it."""
    file = kept_file()
    code = kept(file) if file else None
    if code is not None:
        return code
    from .compiled import object_code

    code = object_code(target)
    if file:
        with suppress(OSError):  # then it is compiled again next time
            keep(file, code)
    return code


def is_kept() -> bool:
    """Tell whether the loop has been compiled for this computer already."""
    file = kept_file()
    return file is not None and is_sound(file)


def kept_file() -> Path | None:
    """Return the file of the machine code.

    Returns
    -------
    Path or None
        None where nothing is kept.
    """
    folder = cache_directory()
    return folder and folder / f"loop-{_stamp()}.o"


@cache
def _stamp() -> str:
    """Return a hash of all that the code follows from: sources, compilers, processor."""
    digest = hashlib.sha256()
    for name in _SOURCES:
        digest.update((_CORE / name).read_bytes() + b"\0")
    compilers = [version_of("numba"), version_of("llvmlite")]
    processor = [llvm.get_default_triple(), llvm.get_host_cpu_name(), _features()]
    digest.update(repr(compilers + processor).encode())
    return digest.hexdigest()[:24]
