"""A component as a WebAssembly module: its kernels, compiled, linked and kept.

A module brings its memory and needs nothing from its host. It is for any sizes of the component:
who uses it lays the buffers ``w``, ``x`` and ``k`` of
:class:`~rockshed.components.common.component.Instance` into the memory behind ``__heap_base`` and
gives their addresses and lengths to

    int initialise(w, x, k, nw, nx, nk),   int evaluate(w, x, k, nw, nx, nk),
    int step(double t, double h, w, x, k, nw, nx, nk),

which return the status of the kernel. All results have the bits of native FMUs.
"""

import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path

from rockshed.components.common.component import Component
from rockshed.processes import with_parent
from rockshed.versions import version_of

from ..kept_code import kept_or_made
from ..native.fmu import CPU, NATIVE_KERNELS, compiled_apart
from ..parts import BuildError, component_sources, digest

VARIANTS = ("plain", "simd", "relaxed")
"""Keys of :data:`.kernels.VARIANTS`, from the host that can least to the one that can most."""
_HERE = Path(__file__).parent
_RUNTIME = _HERE / "runtime.c"
FMA = _HERE / "fma.h"
"""Multiply-add of three numbers in C."""
_STACK = 1 << 16
"""Room (bytes) for what functions hold while they run."""
_LINKER = "-Wl,--"
"""Beginning of an option that is meant for the linker."""
_TARGET = "wasm32-freestanding"
_ASSEMBLER = ("-target", _TARGET, "-mcpu=generic+simd128+relaxed_simd+bulk_memory")
_OPTIONS = (
    "-target", _TARGET, "-O2", "-fno-math-errno", "-ffp-contract=off",
    "-mbulk-memory", "-s", f"{_LINKER}no-entry", f"-Wl,-z,stack-size={_STACK}",
    f"{_LINKER}export=__heap_base",
)  # fmt: skip


@dataclass(frozen=True)
class RowKernel:
    """A kernel that reads an instance and writes rows of numbers; it returns how many.

    Parameters
    ----------
    kernel : str
        ``module:name`` of ``kernel(w, x, k, table)``.
    columns : int
        Numbers in a row.
    """

    kernel: str
    columns: int


def wasm_modules(
    component: Component, tables: Mapping[str, RowKernel] | None = None
) -> dict[str, bytes]:
    """Return the module of a component for every kind of host.

    Parameters
    ----------
    component : Component
        The component.
    tables : mapping of str to RowKernel, optional
        Further functions of the module, ``int64 NAME(w, x, k, table, int64 nw, nx, nk, rows)``.

    Returns
    -------
    dict of str to bytes
        By :data:`VARIANTS`.

    Raises
    ------
    BuildError
        A kernel needs Python, or the linker is missing or fails.
    """
    asked = {name: (table.kernel, table.columns) for name, table in (tables or {}).items()}

    def made(work: Path) -> dict[str, bytes]:
        refuse_without_linker()
        _compile(component, asked, VARIANTS, work)
        return {name: linked(component.name, name, tuple(asked), work) for name in VARIANTS}

    return kept_or_made(component, lambda: _file_names(component, asked, VARIANTS, ".wasm"), made)


def kernel_object(component: Component, variant: str) -> bytes:
    """Return the kernels of a component as object code, for what is linked elsewhere.

    Parameters
    ----------
    component : Component
        The component.
    variant : str
        One of :data:`VARIANTS`.

    Returns
    -------
    bytes
        An object file with the entries ``rockshed_initialise``, ``rockshed_evaluate`` and
        ``rockshed_step``, for buffers of any size.

    Raises
    ------
    BuildError
        A kernel needs Python.
    """

    def made(work: Path) -> dict[str, bytes]:
        _compile(component, {}, (variant,), work)
        return {variant: (work / f"{variant}.o").read_bytes()}

    names = partial(_file_names, component, {}, (variant,), ".o")
    return kept_or_made(component, names, made)[variant]


def _compile(
    component: Component,
    asked: Mapping[str, tuple[str, int]],
    variants: Sequence[str],
    work: Path,
) -> None:
    """Write ``VARIANT.o`` into a folder, or raise a BuildError with everything that is wrong."""
    order = {"sizes": {}, "tables": asked, "variants": variants}
    problems = compiled_apart(f"{__package__}.kernels", component, order, work)
    if problems:
        raise BuildError(
            f"{component.name}: its kernels cannot become WebAssembly: {'; '.join(problems)}"
        )


def _file_names(
    component: Component,
    asked: Mapping[str, tuple[str, int]],
    variants: Sequence[str],
    suffix: str,
) -> dict[str, str]:
    """Return the names of the files of code by variant, with a digest of its sources."""
    ours = (*_HERE.glob("*.py"), _RUNTIME, FMA, *NATIVE_KERNELS)
    made_from = component_sources(component) | {
        f"{path.parent.name}/{path.name}": path.read_bytes() for path in ours
    }
    versions = [version_of(package) for package in ("numba", "llvmlite", "ziglang")]
    made_from["for"] = repr([CPU.name, asked, versions]).encode()
    tag = digest(made_from)[:24]
    return {name: f"{component.name}-{name}-{tag}{suffix}" for name in variants}


def refuse_without_linker() -> None:
    """Raise a BuildError if zig, which links WebAssembly, is not there."""
    if not find_spec("ziglang"):
        raise BuildError(
            "WebAssembly is linked by zig, the Python package ziglang, which is not there. Remedy: "
            "`pip install ziglang`, or `pip install rockshed[page]`"
        )


def linked(component: str, variant: str, exported: tuple[str, ...], work: Path) -> bytes:
    """Return the module made of ``VARIANT.o`` or ``VARIANT.s`` in a folder."""
    for source in (_RUNTIME, FMA):
        shutil.copy(source, work)
    if (work / f"{variant}.s").is_file():
        _zig(component, (*_ASSEMBLER, "-c", f"{variant}.s"), f"{variant}.o", work)
    shown = [f"{_LINKER}export={name}" for name in exported]
    options = (*_OPTIONS, *shown, _RUNTIME.name, f"{variant}.o")
    return _zig(component, options, f"{variant}.wasm", work)


def _zig(component: str, options: Sequence[str], result: str, work: Path) -> bytes:
    """Return a file that zig makes in a folder."""
    done = subprocess.run(
        [sys.executable, "-m", "ziglang", "cc", *options, "-o", result],
        cwd=work,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=with_parent(),
    )
    if done.returncode or not (work / result).is_file():
        raise BuildError(
            f"{component}: zig failed to link its WebAssembly: "
            f"{(done.stderr or done.stdout).strip() or done.returncode}"
        )
    return (work / result).read_bytes()
