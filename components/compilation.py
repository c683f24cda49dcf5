"""Compilation of kernels: one decorator, and a cache that is found again wherever the source lies.

Numba keys its cache by the folder of the source file and by that one file's content. A kernel inside an FMU would then be
compiled again on every run (the FMU is unpacked to a new folder each time), and an edit of a called function in another file
would go unnoticed. Here the key is the content of all files that a kernel may call: those of its component and those that all
components share. A component does not import another one, so a change of it leaves the kernels of the others valid.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from numba import njit
from numba.core.caching import CompileResultCacheImpl, FunctionCache

CACHE_VARIABLE = "ROCKSHED_CACHE_DIR"
"""Environment variable that moves the cache of compiled kernels, by default ``~/.cache/rockshed``."""

_PACKAGE = Path(__file__).parent

F = TypeVar("F", bound=Callable[..., Any])


@cache
def source_stamp(component: str | None) -> str:
    """Hash of the Python sources that kernels of a component (its folder's name) follow from; None: of all components."""
    digest = hashlib.sha256(__name__.encode())
    shared = [path for path in _PACKAGE.glob("*.py") if path.name != "catalogue.py"]
    for path in sorted([*shared, *_PACKAGE.glob(f"{component or '*'}/**/*.py")]):
        digest.update(path.relative_to(_PACKAGE).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


@cache
def cache_directory() -> Path | None:
    """Folder of what was compiled, made if need be; None where no such folder can be written (then nothing is kept)."""
    root = os.environ.get(CACHE_VARIABLE) or os.path.join(os.environ.get("XDG_CACHE_HOME") or "~/.cache", "rockshed")
    folder = Path(root).expanduser()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except (OSError, RuntimeError):
        return None
    return folder


def _component_of(module: str) -> str | None:
    """The component that a module belongs to: ``sand_cushion`` of ``components.sand_cushion.forces``; None for any other module."""
    package, _, rest = module.partition(f"{__package__}.")
    folder = rest.partition(".")[0]
    return folder if not package and (_PACKAGE / folder).is_dir() else None


def has_kernels(component: str) -> bool:
    """Whether kernels of the component in the folder of this name have been compiled and kept."""
    folder = cache_directory()
    return folder is not None and any((folder / source_stamp(component)[:16]).glob("*.nbc"))


class _PackageLocator:
    """Numba's protocol of a cache locator: where a function's cache lies and when it is stale."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self._function = function
        self._stamp = source_stamp(_component_of(function.__module__))
        self._folder = folder / self._stamp[:16]

    @classmethod
    def from_function(cls, function: Callable[..., Any], _source: str) -> "_PackageLocator | None":
        """A locator, if the cache can be kept."""
        folder = cache_directory()
        return None if folder is None else cls(function, folder)

    def ensure_cache_path(self) -> None:
        """Make the folder."""
        self._folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        """The folder of the cache."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Changes with every change of the sources: what was compiled before is stale then."""
        return self._stamp

    def get_disambiguator(self) -> str:
        """Part of the file's name that tells functions of one name apart."""
        return hashlib.sha256(f"{self._function.__module__}:{self._function.__code__.co_firstlineno}".encode()).hexdigest()[:12]


class _PackageCacheImpl(CompileResultCacheImpl):
    _locator_classes = (_PackageLocator,)


class _PackageCache(FunctionCache):
    _impl_class = _PackageCacheImpl


def kernel(function: F) -> F:
    """Compile ``function`` with numba: no fastmath (results are compared bit for bit), division by zero gives inf or NaN.

    Kernels keep to what also compiles without Python: explicit loops, scalar arithmetic, slices, other kernels. No
    allocation, no whole-array expressions, no exceptions; a kernel reports a fault by its return value.
    """
    return _compiled(function, inline="never")


def inlined(function: F) -> F:
    """A :func:`kernel` that the compiler sets into its callers: for small functions inside hot loops."""
    return _compiled(function, inline="always")


def released(function: F) -> F:
    """A :func:`kernel` during which other threads of Python run: for calls from Python that take milliseconds."""
    return _compiled(function, inline="never", nogil=True)


def _compiled(function: F, inline: str, nogil: bool = False) -> F:
    dispatcher = njit(error_model="numpy", inline=inline, nogil=nogil, _nrt=False)(function)
    if cache_directory() is not None:
        dispatcher._cache = _PackageCache(function)
    return dispatcher
