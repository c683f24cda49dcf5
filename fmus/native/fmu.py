"""Native FMUs: kernels of a component as machine code behind a slave in C, without Python.

``slave.h`` is that slave, ``shim_fmi2.c`` and ``shim_fmi3.c`` are the functions of FMI 2.0 and 3.0
around it. Kernels are compiled by numba and LLVM for the processor of a platform, on x86-64
:data:`CPU`; the shim by a C compiler for any processor of the platform's kind: on x86-64 it looks
at the processor before it makes an instance. The model
description of FMI 2.0 differs from that of the FMU with Python in GUID, tool and one flag.
"""

import errno
import json
import os
import shlex
import shutil
import subprocess
import sys
import uuid
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rockshed.components.common.cache import CACHE_VARIABLE
from rockshed.components.common.component import Component
from rockshed.components.common.ports import Sizes
from rockshed.platforms import PLATFORMS as KNOWN
from rockshed.platforms import Platform, this_machine
from rockshed.processes import with_parent
from rockshed.temporary import TemporaryFolder
from rockshed.versions import version_of

from ..description.documentation import documentation
from ..description.legal import license_files, needed_by_native
from ..kept_code import kept_or_made
from ..parts import (
    DESCRIPTION,
    EXPERIMENTS,
    BuildError,
    Files,
    Fmi,
    Runtime,
    component_sources,
    digest,
    picture,
    refuse_changed,
)
from .header import Baseline, model_header
from .subset import UNKNOWN_PLACE

_HERE = Path(__file__).parent
_SLAVE = _HERE / "slave.h"
_SHIMS = {Fmi.TWO: _HERE / "shim_fmi2.c", Fmi.THREE: _HERE / "shim_fmi3.c"}
_CONDUCT = _HERE.parent / "python" / "conduct.py"
_LEAST_FREE = 1 << 20
"""Room (bytes) that a compiler needs at least; some say nothing on a full disk."""
NATIVE_KERNELS = (_HERE / "kernels.py", _HERE / "subset.py")
"""Modules that make object code of kernels."""


def _bits(*numbers: int) -> int:
    return sum(1 << number for number in numbers)


CPU = Baseline(
    "x86-64-v3",
    # SSE3, SSSE3, FMA, CX16, SSE4.1, SSE4.2, MOVBE, POPCNT, OSXSAVE, AVX, F16C
    _bits(0, 9, 12, 13, 19, 20, 22, 23, 27, 28, 29),
    _bits(3, 5, 8),  # BMI1, AVX2, BMI2
    _bits(0, 5),  # LAHF, LZCNT
)


@dataclass(frozen=True)
class Toolchain:
    """Settings with which code for a platform is compiled.

    Parameters
    ----------
    platform : Platform
        The platform.
    triple : str
        Its name for LLVM.
    processor : str
        LLVM's name of the processor that kernels are compiled for.
    zig : tuple of str
        Its name for zig, with the C library, and that of the processor of the shim.
    options : tuple of str
        Options of the linker.
    """

    platform: Platform
    triple: str
    processor: str
    zig: tuple[str, str]
    options: tuple[str, ...] = ()


_OF_LINUX = ("-Wl,-z,defs", "-Wl,-Bsymbolic", "-lm", "-pthread")
_TOOLCHAINS = (
    Toolchain(
        KNOWN["x86_64-linux"],
        "x86_64-unknown-linux-gnu",
        CPU.name,
        ("x86_64-linux-gnu.2.17", "x86_64"),
        _OF_LINUX,
    ),
    Toolchain(
        KNOWN["x86_64-windows"],
        "x86_64-w64-windows-gnu",
        CPU.name,
        ("x86_64-windows-gnu", "x86_64"),
    ),
    Toolchain(
        KNOWN["x86_64-darwin"],
        "x86_64-apple-macosx11.0",
        CPU.name,
        ("x86_64-macos.11.0", "x86_64"),
    ),
    Toolchain(
        KNOWN["aarch64-linux"],
        "aarch64-unknown-linux-gnu",
        "generic",  # ARMv8-A, vectors of two numbers
        ("aarch64-linux-gnu.2.17", "generic"),
        _OF_LINUX,
    ),
    Toolchain(
        KNOWN["aarch64-darwin"],
        "arm64-apple-macosx11.0",
        "apple-m1",  # the oldest one with macOS
        ("aarch64-macos.11.0", "apple_m1"),
    ),
)
PLATFORMS: Mapping[str, Toolchain] = {each.platform.in_fmi2: each for each in _TOOLCHAINS}
"""All platforms that there can be native FMUs for, by their names in FMI 2.0."""
ALL_PLATFORMS = "all"
"""Stands for all platforms."""
_OPTIONS = (
    "-std=gnu11",
    "-O3",
    "-shared",
    "-fPIC",
    "-fvisibility=hidden",
    "-ffp-contract=off",
    "-s",
)
_PYTHON_REMAINS = 'FMUs with Python inside, runtime="python", need no compiler'


def _platform_here() -> str | None:
    """Return the platform of this machine; None where there are no native FMUs for it."""
    name = this_machine().in_fmi2
    return name if name in PLATFORMS else None


def own_platform() -> str:
    """Return the platform of this machine in the words of FMI 2.0.

    Raises
    ------
    BuildError
        There are no native FMUs for it.
    """
    name = _platform_here()
    if name is None:
        raise BuildError(
            "native FMUs are made for x86-64 processors under Linux, Windows and macOS, and for "
            f"64-bit ARM under Linux and macOS; this is {this_machine().in_fmi3}. Remedy: "
            "in_process=True, which needs no FMUs"
        )
    return name


def native_files(
    component: Component, sizes: Sizes, platforms: Sequence[str] = (), fmi: Fmi = Fmi.TWO
) -> Files:
    """Return everything that goes into a native FMU.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    platforms : sequence of str
        Keys of :data:`PLATFORMS`; by default this machine's.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    dict of str to bytes
        Files by their path in the FMU.

    Raises
    ------
    BuildError
        A kernel needs Python, there is no compiler, or it fails.
    """
    own = partial(library_files, component, sizes, platforms, fmi=fmi)
    return files_of_one_stamp(component, sizes, [own], fmi)


def files_of_one_stamp(
    component: Component,
    sizes: Sizes,
    parts: Sequence[Callable[[str], Files]],
    fmi: Fmi = Fmi.TWO,
) -> Files:
    """Return the files of an FMU whose description and binaries have the same token.

    The :func:`stamp` is made once and handed on. It is compared in the end, as compilers read the
    sources in between.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    parts : sequence of callable
        Return the files that belong to a stamp, beside those of :func:`described_files`.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    dict of str to bytes
        Files by their path in the FMU.

    Raises
    ------
    BuildError
        A part cannot be made, or the sources have changed meanwhile.
    """
    token = stamp(component, sizes, fmi)
    files: Files = {}
    for part in parts:
        files |= part(token)
    files = described_files(component, sizes, token, fmi) | files
    refuse_changed(component, token, stamp(component, sizes, fmi))
    return files


def library_files(
    component: Component,
    sizes: Sizes,
    platforms: Sequence[str],
    token: str,
    fmi: Fmi = Fmi.TWO,
) -> Files:
    """Return the libraries of a native FMU, and what they need.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    platforms : sequence of str
        Keys of :data:`PLATFORMS`; by default this machine's.
    token : str
        The FMU's :func:`stamp`.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    dict of str to bytes
        Files by their path in the FMU.

    Raises
    ------
    BuildError
        A kernel needs Python, there is no compiler, or it fails.
    """
    platforms = tuple(dict.fromkeys(platforms)) or (own_platform(),)
    if ALL_PLATFORMS in platforms:
        platforms = tuple(PLATFORMS)
    compilers = {name: compiler(name) for name in platforms}
    files: Files = {}
    libraries = {}
    for name, sources in library_sources(component, sizes, platforms, token, fmi).items():
        path = _library(component, name, fmi)
        files[path] = _linked(
            component.name, compilers[name], name, Path(path).name, _SHIMS[fmi].name, sources
        )
        libraries[path] = (PLATFORMS[name].processor, files[path])
    return files | needed_by_native(libraries)


def library_sources(
    component: Component,
    sizes: Sizes,
    platforms: Sequence[str],
    token: str,
    fmi: Fmi = Fmi.TWO,
) -> dict[str, Files]:
    """Return the files that a library is made of: the shim, what it includes, and the kernels.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        Sizes to build it with.
    platforms : sequence of str
        Keys of :data:`PLATFORMS`.
    token : str
        The FMU's :func:`stamp`.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    dict of str to Files
        By platform: ``model.h``, ``slave.h``, the shim and ``kernels.o``.

    Raises
    ------
    BuildError
        A kernel needs Python.
    """
    shared = slave_sources(component, sizes, token, fmi)
    objects = _objects(component, sizes, platforms)
    return {name: {**shared, "kernels.o": objects[name]} for name in platforms}


def slave_sources(component: Component, sizes: Sizes, token: str, fmi: Fmi = Fmi.TWO) -> Files:
    """Return the slave in C around kernels: the shim and what it includes.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        Sizes to build it with.
    token : str
        The FMU's :func:`stamp`.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    dict of str to bytes
        ``model.h``, ``slave.h`` and the shim.
    """
    header = model_header(component, sizes, token, CPU)
    return {"model.h": header, **{p.name: p.read_bytes() for p in (_SLAVE, _SHIMS[fmi])}}


def own_binary(component: Component, fmi: Fmi = Fmi.TWO) -> str:
    """Return the path of this machine's library in a native FMU.

    Parameters
    ----------
    component : Component
        The component.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    str
        Path inside the FMU, with forward slashes.

    Raises
    ------
    BuildError
        There are no native FMUs for this machine.
    """
    return _library(component, own_platform(), fmi)


def _library(component: Component, platform: str, fmi: Fmi) -> str:
    """Return the path of the library for a platform inside the FMU."""
    return PLATFORMS[platform].platform.library(component.name, fmi)


def stamp(component: Component, sizes: Sizes, fmi: Fmi = Fmi.TWO) -> str:
    """Return the GUID of a native FMU, in FMI 3.0 its instantiation token.

    It is a hash of the sources and versions that the FMU follows from; nothing has to be computed
    for it but that.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    str
        A UUID in braces.
    """
    beside = [
        path
        for path in component.folder.iterdir()
        if path.suffix in (".md", ".png") or path.name == EXPERIMENTS
    ]
    ours = (
        *_HERE.glob("*.py"),
        *_HERE.glob("*.j2"),
        _CONDUCT,
        *_HERE.parent.glob("*.py"),
        *_HERE.parent.glob("description/*.py"),
        *_HERE.parent.glob("experiments/*.py"),
        *_HERE.parent.glob("experiments/data/*"),
        _SLAVE,
        _SHIMS[fmi],
    )
    made_from = component_sources(component) | {
        f"{path.parent.name}/{path.name}": path.read_bytes() for path in (*ours, *beside)
    }
    made_from["versions"] = repr(
        [CPU, dict(sizes), *_versions("rockshed", "numba", "llvmlite", "lxml", "markdown-it-py")]
    ).encode()
    return f"{{{uuid.UUID(digest(made_from)[:32])}}}"


def described_files(component: Component, sizes: Sizes, token: str, fmi: Fmi = Fmi.TWO) -> Files:
    """Return description, documentation, icon and terminals, for which nothing is compiled.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    token : str
        The FMU's :func:`stamp`.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    dict of str to bytes
        Files by their path in the FMU.
    """
    from ..description import fmi2 as description
    from ..description import fmi3 as description3
    from ..experiments.files import experiment_files

    files = documentation(component, sizes, experiment_files(component, sizes, fmi))
    files |= license_files()
    if fmi is Fmi.THREE:
        own = {DESCRIPTION: description3.model_description(component, sizes, token)}
        return files | own | description3.terminals_and_icon(component)
    own = {DESCRIPTION: description.model_description(component, sizes, token, Runtime.NATIVE)}
    return files | own | picture(component, "model.png")


@cache
def _versions(*packages: str) -> list[str]:
    return [f"{package} {version_of(package)}" for package in packages]


# --- kernels


def _objects(component: Component, sizes: Sizes, platforms: Sequence[str]) -> dict[str, bytes]:
    """Return the object code of the kernels by platform; it is kept with the compiled kernels."""

    def made(work: Path) -> dict[str, bytes]:
        _compile_or_refuse(component, sizes, platforms, work)
        return {name: (work / f"{name}.o").read_bytes() for name in platforms}

    return kept_or_made(component, lambda: _object_files(component, sizes, platforms), made)


def _object_files(component: Component, sizes: Sizes, platforms: Sequence[str]) -> dict[str, str]:
    """Return the names of the files of object code by platform, with a digest of its sources."""
    made_from = component_sources(component) | {
        path.name: path.read_bytes() for path in NATIVE_KERNELS
    }
    versions = _versions("numba", "llvmlite")
    made_from["for"] = repr([_targets(PLATFORMS), dict(sizes), *versions]).encode()
    tag = digest(made_from)[:24]
    return {platform: f"{component.name}-{platform}-{tag}.o" for platform in platforms}


def _targets(platforms: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Return LLVM's names of platforms and their processors."""
    return {name: (PLATFORMS[name].triple, PLATFORMS[name].processor) for name in platforms}


def _processor_here() -> str:
    """Return the processor of this machine's kind that numba compiles for."""
    here = _platform_here()
    return PLATFORMS[here].processor if here else "generic"


def _compile_or_refuse(
    component: Component, sizes: Sizes, platforms: Sequence[str], work: Path
) -> None:
    """Write ``PLATFORM.o`` into a folder, or raise a BuildError with everything that is wrong."""
    problems = _compile(component, sizes, platforms, work)
    if not problems:
        return
    if any(UNKNOWN_PLACE in problem for problem in problems):
        # once more from the sources, for the lines
        settings = {"NUMBA_DEBUGINFO": "1", CACHE_VARIABLE: f"{work}/cache"}
        problems = _compile(component, sizes, platforms, work, **settings)
    raise BuildError(
        f"{component.name}: its kernels need more than the C library and cannot run without "
        "Python: " + "; ".join(problems) + ". Kernels keep to explicit loops, scalar arithmetic, "
        f"slices and other kernels. No native FMU was built. {_PYTHON_REMAINS}"
    )


def _compile(
    component: Component, sizes: Sizes, platforms: Sequence[str], work: Path, **environment: str
) -> list[str]:
    """Write ``PLATFORM.o`` into a folder, and return the problems."""
    order = {"sizes": dict(sizes), "targets": _targets(platforms)}
    return compiled_apart(f"{__package__}.kernels", component, order, work, **environment)


def compiled_apart(
    module: str, component: Component, order: Mapping[str, Any], work: Path, **environment: str
) -> list[str]:
    """Compile kernels in a process of its own.

    Numba takes the processor from its environment, once per process.

    Parameters
    ----------
    module : str
        Module that carries out the order: it writes files, and a JSON list of problems.
    component : Component
        Whose kernels.
    order : mapping
        What is asked for, with the ``sizes`` that differ from the defaults.
    work : Path
        Folder of the files.
    **environment : str
        Further variables.

    Returns
    -------
    list of str
        What is wrong with the kernels.

    Raises
    ------
    BuildError
        The process failed.
    """
    inherited = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_")}
    settings = {
        "NUMBA_CPU_NAME": _processor_here(),
        "NUMBA_CPU_FEATURES": "",
        "PYTHONPATH": os.pathsep.join(_import_folders()),
    }
    kind = component.instance(**order["sizes"]).kind.hex()
    done = subprocess.run(
        [sys.executable, "-P", "-m", module],
        input=json.dumps({**order, "folder": str(component.folder), "kind": kind}),
        cwd=work,
        text=True,
        env=inherited | settings | environment,
        capture_output=True,
        check=False,
        preexec_fn=with_parent(),
    )
    if done.returncode:
        raise BuildError(
            f"{component.name}: compiling its kernels failed: "
            f"{done.stderr.strip() or done.returncode}"
        )
    problems = json.loads(done.stdout)
    assert isinstance(problems, list)
    return problems


def _import_folders() -> list[str]:
    """Return the folders from which another process imports what this one does.

    The working folder is somebody's: what lies there is imported only if this library does.
    """
    here, ours = Path.cwd(), Path(_HERE.parents[1])
    return [
        folder
        for folder in map(os.path.abspath, filter(None, sys.path))
        if Path(folder) != here or ours.is_relative_to(here)
    ]


# --- the C compiler

_SHIM_FOR = {"linux64": "-march=x86-64", "aarch64-linux": "-march=armv8-a"}
"""Option of compilers of Linux for any processor of the platform's kind."""


def compiler(platform: str) -> list[str]:
    """Return the command of a compiler for a platform.

    For Linux, zig comes before the compilers of this machine: its libraries run with a C library as
    old as :data:`PLATFORMS` says, theirs with one as old as this machine's.

    Parameters
    ----------
    platform : str
        Key of :data:`PLATFORMS`.

    Returns
    -------
    list of str
        Words of the command.

    Raises
    ------
    BuildError
        There is none.
    """
    is_own = sys.platform == "linux" and _platform_here() == platform
    baseline = _SHIM_FOR.get(platform, "")
    if is_own and (chosen := os.environ.get("CC")):
        return [*shlex.split(chosen), baseline]
    if find_spec("ziglang"):
        target, processor = PLATFORMS[platform].zig
        words = ("-target", target, f"-mcpu={processor}")
        return [sys.executable, "-m", "ziglang", "cc", *words]
    found = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if is_own and found:
        return [found, baseline]
    others = "environment variable CC, cc, gcc, clang, " if is_own else ""
    raise BuildError(
        f"no compiler for {platform} was found ({others}Python package ziglang). Remedy: `pip "
        f"install ziglang`. {_PYTHON_REMAINS}"
    )


def _reason(done: "subprocess.CompletedProcess[str]", work: Path) -> str:
    """Return why a compiler failed, in its own words or, on a full disk, without them."""
    full = shutil.disk_usage(work).free < _LEAST_FREE
    words = f"{os.strerror(errno.ENOSPC)} in {work.parent}" if full else ""
    said = (done.stderr or done.stdout).strip()
    return "\n".join(filter(None, (words, said))) or "it said nothing"


def _linked(
    name: str, compiler: Sequence[str], platform: str, library: str, shim: str, sources: Files
) -> bytes:
    """Return the shared library of an FMU, from the shim with all that it includes and kernels.o.

    Raises
    ------
    BuildError
        The compiler fails; its messages.
    """
    with TemporaryFolder() as work:
        for source, content in sources.items():
            (work / source).write_bytes(content)
        command = [
            *compiler,
            *_OPTIONS,
            "-o",
            library,
            shim,
            "kernels.o",
            *PLATFORMS[platform].options,
        ]
        try:
            done = subprocess.run(
                command,
                cwd=work,
                capture_output=True,
                text=True,
                check=False,
                preexec_fn=with_parent(),
            )
        except OSError as error:
            raise BuildError(
                f"{name}: the compiler {compiler[0]} cannot be run: {error.strerror or error}; no "
                f"native FMU was built. Remedy: set CC to another one. {_PYTHON_REMAINS}"
            ) from error
        if done.returncode or not (work / library).is_file():
            raise BuildError(
                f"{name}: the compiler failed for {platform}, no native FMU was built: "
                f"{' '.join(command)}\n{_reason(done, work)}\n{_PYTHON_REMAINS}"
            )
        return (work / library).read_bytes()
