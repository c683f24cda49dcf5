"""The exchange loop as machine code: compiled by numba once, kept on this computer, and from then on loaded without numba."""

import ctypes
import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm

from ...files import write_file
from ...versions import version_of
from .tables import ENTRY, Integers

CACHE_VARIABLE = "ROCKSHED_CACHE_DIR"
"""Environment variable that moves the folder in which machine code is kept, by default ``~/.cache/rockshed``."""

Advance = Callable[[Integers, int, int], tuple[int, int, int]]
"""The function :func:`rockshed.core.loop.compiled.advance`, but for its tables, which are given by their :func:`~.tables.head`."""

_CORE = Path(__file__).parents[1]
_SOURCES = (
    "system/clock.py",
    "loop/compiled.py",
    "loop/machine_code.py",
    "system/schedule.py",
    "fmu/slave.py",
    "loop/tables.py",
)
"""Files that the machine code follows from."""


@cache
def _engine() -> Any:
    """The machine code in memory."""
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
    """The loop, ready to be called. The global interpreter lock is kept during the call."""
    integer = ctypes.c_int64
    function = ctypes.PYFUNCTYPE(integer, integer, integer, integer, integer)(
        _engine().get_function_address(ENTRY)
    )

    def call(head: Integers, first: int, count: int) -> tuple[int, int, int]:
        outcome = (integer * 3)()
        function(head.ctypes.data, first, count, ctypes.addressof(outcome))
        return outcome[0], outcome[1], outcome[2]

    return call


def _features() -> str:
    return str(llvm.get_host_cpu_features().flatten())


def _code(target: llvm.TargetMachine) -> bytes:
    """Object code from the cache, or compiled and kept."""
    file = _folder() / f"loop-{_stamp()}.o"
    with suppress(OSError):
        return file.read_bytes()
    from .compiled import object_code

    code = object_code(target)
    with suppress(OSError):  # then it is compiled again next time
        file.parent.mkdir(parents=True, exist_ok=True)
        write_file(file, code)
    return code


def is_kept() -> bool:
    """Whether the loop has been compiled for this computer already."""
    return (_folder() / f"loop-{_stamp()}.o").is_file()


def _folder() -> Path:
    root = os.environ.get(CACHE_VARIABLE) or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or "~/.cache", "rockshed"
    )
    return Path(os.path.expanduser(root))


@cache
def _stamp() -> str:
    """Hash of all that the code follows from: sources, compilers, processor."""
    digest = hashlib.sha256()
    for name in _SOURCES:
        digest.update((_CORE / name).read_bytes() + b"\0")
    digest.update(
        repr(
            [
                version_of("numba"),
                version_of("llvmlite"),
                llvm.get_default_triple(),
                llvm.get_host_cpu_name(),
                _features(),
            ]
        ).encode()
    )
    return digest.hexdigest()[:24]
