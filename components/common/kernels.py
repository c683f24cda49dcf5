"""Compilation of kernels: decorators, and a cache that is found again wherever the source lies.

A kernel is compiled when it is first used, and numba is imported then and not before: it takes 0.4 s, and who reads declarations
only, or runs native FMUs, needs none of it.

Numba keys its cache by the folder of the source file and by that one file's content. A kernel inside an FMU would then be
compiled again on every run (the FMU is unpacked to a new folder each time), and an edit of a called function in another file
would go unnoticed. Here the key is the content of all files that a kernel may call: those of its component and those that all
components share. A component does not import another one, so a change of it leaves the kernels of the others valid.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache, cached_property, update_wrapper
from importlib import import_module
from pathlib import Path
from threading import RLock
from typing import Any

CACHE_VARIABLE = "ROCKSHED_CACHE_DIR"
"""Environment variable that moves the cache of compiled kernels, by default ``~/.cache/rockshed``."""

_PACKAGE = Path(__file__).parents[1]
_SHARED = Path(__file__).parent.name


@cache
def source_stamp(component: str | None) -> str:
    """Hash of the Python sources that kernels of a component (its folder's name) follow from; None: of all components."""
    digest = hashlib.sha256(__name__.encode())
    for path in sorted(
        {*_PACKAGE.glob(f"{_SHARED}/**/*.py"), *_PACKAGE.glob(f"{component or '*'}/**/*.py")}
    ):
        digest.update(
            path.relative_to(_PACKAGE).as_posix().encode() + b"\0" + path.read_bytes() + b"\0"
        )
    return digest.hexdigest()


@cache
def cache_directory() -> Path | None:
    """Folder of what was compiled, made if need be; None where no such folder can be written (then nothing is kept)."""
    root = os.environ.get(CACHE_VARIABLE) or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or "~/.cache", "rockshed"
    )
    folder = Path(root).expanduser()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except (OSError, RuntimeError):
        return None
    return folder


def component_of(module: str) -> str | None:
    """The component that a module belongs to: ``sand_cushion`` of ``rockshed.components.sand_cushion.forces``; None for any other module."""
    package, _, rest = module.partition(f"{__package__.rpartition('.')[0]}.")
    folder = rest.partition(".")[0]
    return folder if not package and (_PACKAGE / folder).is_dir() else None


def has_kernels(component: str) -> bool:
    """Whether kernels of the component in the folder of this name have been compiled and kept."""
    folder = cache_directory()
    return folder is not None and any((folder / source_stamp(component)[:16]).glob("*.nbc"))


_making = RLock()


class Deferred:
    """A function that ``make`` turns into what numba calls a function, when it is first used.

    Everything that is asked of it is asked of what ``make`` gives; compiled functions may call it like any other.
    """

    def __init__(
        self, function: Callable[..., Any], make: Callable[[Callable[..., Any]], Any]
    ) -> None:
        update_wrapper(self, function)
        self._function, self._make = function, make

    @cached_property
    def made(self) -> Any:
        """What ``make`` gives."""
        from . import numba_bridge  # noqa: F401 (tells numba what a Deferred is)

        with _making:  # two threads that come first get the same
            if "made" not in vars(self):
                vars(self)["made"] = self._make(self._function)
            return vars(self)["made"]

    def __call__(self, *arguments: Any) -> Any:
        """Call what ``make`` gives."""
        return self.made(*arguments)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # copy and pickle look for what is not there before anything is
            raise AttributeError(name)
        return getattr(self.made, name)


class Later:
    """A module that is imported when something is first taken from it."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Any:
        return getattr(import_module(self._name), name)


numba_types: Any = Later("numba.types")
numba_cgutils: Any = Later("numba.core.cgutils")


def kernel(function: Callable[..., Any]) -> Any:
    """Compile ``function`` with numba: no fastmath (results are compared bit for bit), division by zero gives inf or NaN.

    Kernels keep to what also compiles without Python: explicit loops, scalar arithmetic, slices, other kernels. No
    allocation, no whole-array expressions, no exceptions; a kernel reports a fault by its return value.
    """
    return _compiled(function, inline="never")


def inlined(function: Callable[..., Any]) -> Any:
    """A :func:`kernel` that the compiler sets into its callers: for small functions inside hot loops."""
    return _compiled(function, inline="always")


def released(function: Callable[..., Any]) -> Any:
    """A :func:`kernel` during which other threads of Python run: for calls from Python that take milliseconds."""
    return _compiled(function, inline="never", nogil=True)


def intrinsic(function: Callable[..., Any]) -> Any:
    """A function that writes the code of a call itself, instruction by instruction: ``numba.extending.intrinsic``."""

    def make(function: Callable[..., Any]) -> Any:
        from numba.core.registry import cpu_target
        from numba.extending import intrinsic

        made = intrinsic(function)
        cpu_target.typing_context.refresh()  # which does not know it before
        return made

    return Deferred(function, make)


def _compiled(function: Callable[..., Any], inline: str, nogil: bool = False) -> Deferred:
    source_stamp(
        component_of(function.__module__)
    )  # now: the folder that an FMU was unpacked to may be gone when it is needed

    def make(function: Callable[..., Any]) -> Any:
        from numba import njit

        from .numba_bridge import PackageCache

        dispatcher = njit(error_model="numpy", inline=inline, nogil=nogil, _nrt=False)(function)
        if cache_directory() is not None:
            dispatcher._cache = PackageCache(function)
        return dispatcher

    return Deferred(function, make)
