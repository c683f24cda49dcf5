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
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from rockshed.components.common.cache import cache_directory
from rockshed.components.common.component import Component
from rockshed.components.common.kept import keep, kept
from rockshed.processes import with_parent
from rockshed.temporary import TemporaryFolder
from rockshed.versions import version_of

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
    files = _kept_files(component, asked, ".wasm")
    found = {name: kept(path) for name, path in files.items()}
    sound = {name: content for name, content in found.items() if content is not None}
    if sound.keys() == set(VARIANTS):
        return sound
    refuse_without_linker()
    with TemporaryFolder() as work:
        _compile(component, asked, VARIANTS, work)
        made = {name: linked(component.name, name, tuple(asked), work) for name in VARIANTS}
    for name, path in files.items():
        with suppress(OSError):  # then it is compiled again next time
            keep(path, made[name])
    return made


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
    file = _kept_files(component, {}, ".o").get(variant)
    if file and (found := kept(file)) is not None:
        return found
    with TemporaryFolder() as work:
        _compile(component, {}, (variant,), work)
        made = (work / f"{variant}.o").read_bytes()
    if file:
        with suppress(OSError):  # then it is compiled again next time
            keep(file, made)
    return made


def _compile(
    component: Component,
    asked: Mapping[str, tuple[str, int]],
    variants: Sequence[str],
    work: Path,
) -> None:
    """Write ``VARIANT.o`` into a folder, or raise a BuildError with everything that is wrong."""
    order = {"folder": str(component.folder), "tables": asked, "variants": variants}
    problems = compiled_apart(f"{__package__}.kernels", component, order, work)
    if problems:
        raise BuildError(
            f"{component.name}: its kernels cannot become WebAssembly: {'; '.join(problems)}"
        )


def _kept_files(
    component: Component, asked: Mapping[str, tuple[str, int]], suffix: str
) -> dict[str, Path]:
    folder = cache_directory()
    if folder is None:
        return {}
    ours = (*_HERE.glob("*.py"), _RUNTIME, FMA, *NATIVE_KERNELS)
    made_from = component_sources(component) | {
        f"{path.parent.name}/{path.name}": path.read_bytes() for path in ours
    }
    versions = [version_of(package) for package in ("numba", "llvmlite", "ziglang")]
    made_from["for"] = repr([CPU.name, asked, versions]).encode()
    stamp = digest(made_from)[:24]
    return {name: folder / f"{component.name}-{name}-{stamp}{suffix}" for name in VARIANTS}


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
