"""Where compiled kernels are kept, and what they follow from.

Numba keys its cache by the folder of the source file and by the content of that one file. A kernel
inside an FMU would then be compiled again on every run (the FMU is unpacked to a new folder each
time), and an edit of a called function in another file would go unnoticed. Here the key is the
content of all files that a kernel may call: those of its component and those that all components
share. A component does not import another one, so a change of it leaves the kernels of the others
valid.

Nothing here imports numba.
"""

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from inspect import getfile
from pathlib import Path
from typing import Any

from .kept import folder_problem, make_private

CACHE_VARIABLE = "ROCKSHED_CACHE_DIR"
"""Environment variable that names the folder of compiled kernels; by default it is ``rockshed``
in the user's cache folder."""

_SHARED = Path(__file__).parent
_COMPONENTS = _SHARED.parent
_LIBRARY = Path(getattr(sys.modules[__name__.partition(".")[0]], "__file__", None) or ".").parent
_TAG_LENGTH = 16
"""Characters of a stamp that name a folder of the cache."""


def cache_directory() -> Path | None:
    """Make the folder of compiled kernels if need be, and return it.

    Returns
    -------
    Path or None
        The folder; None where none can be used: then nothing is kept, see :func:`cache_problem`.
    """
    return None if cache_problem() else cache_path()


def cache_problem() -> str:
    """Return why no compiled code is kept.

    Returns
    -------
    str
        The reason in words, with a remedy; empty where code is kept.
    """
    try:
        folder = cache_path()
    except RuntimeError:
        return f"the user has no home: set {CACHE_VARIABLE} to a folder of yours"
    problem = _use_problem(folder)
    if not problem:
        return ""
    return f"{problem}: set {CACHE_VARIABLE} to a folder that you alone can write"


@cache
def _use_problem(folder: Path) -> str:
    """Return why a folder can be neither trusted nor written; it is made if it is not there."""
    if problem := folder_problem(folder):
        return problem
    try:
        make_private(folder)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        return f"{folder} cannot be written ({error.strerror or error})"
    return folder_problem(folder)


def cache_path() -> Path:
    """Return the folder of compiled kernels, there or not.

    It is the one that platformdirs names. An FMU finds it in an interpreter that has numpy and
    numba and nothing else, so the rule stands here once more.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    RuntimeError
        The user has no home.
    """
    if chosen := os.environ.get(CACHE_VARIABLE):
        return Path(chosen).expanduser()
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData/Local"
        return Path(local) / "rockshed" / "Cache"
    if sys.platform == "darwin":
        return Path.home() / "Library/Caches/rockshed"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rockshed"


def source_stamp(place: Path) -> str:
    """Return a hash of all Python sources that the kernels at a place may follow from.

    Parameters
    ----------
    place : Path
        A component's folder, or any Python file.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    return _stamp(_root_of(place))


@cache
def _stamp(root: Path) -> str:
    """Return the hash of the sources when this process first asked, which it has imported."""
    return _present_stamp(root)


def _present_stamp(root: Path) -> str:
    digest = hashlib.sha256(__name__.encode())
    for path in sorted(set(_sources(root))):
        digest.update(f"{_name(path, root)}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()


def _root_of(place: Path) -> Path:
    """Return the outermost package around a place that is no room of this library; else the place.

    Kernels of a package may call any function of it.
    """
    folder = place if place.is_dir() else place.parent
    if not (folder / "__init__.py").is_file():
        return place
    while (folder.parent / "__init__.py").is_file() and folder.parent not in (
        _COMPONENTS,
        _LIBRARY,
    ):
        folder = folder.parent
    return folder


def _sources(root: Path) -> Iterator[Path]:
    """Return the files of a root and of what it may call: a component calls no other one."""
    yield from _SHARED.rglob("*.py")
    yield from root.rglob("*.py") if root.is_dir() else [root]
    if root.parent != _COMPONENTS:
        yield from _COMPONENTS.rglob("*.py")


def _name(path: Path, root: Path) -> str:
    """Return a file's name in the hash, which depends on no folder outside the sources."""
    base = _COMPONENTS if path.is_relative_to(_COMPONENTS) else root.parent
    return path.relative_to(base).as_posix()


def has_kernels(folder: Path) -> bool:
    """Tell whether kernels of a component have been compiled and kept.

    Parameters
    ----------
    folder : Path
        The component's folder.

    Returns
    -------
    bool
        True if there are any, for the present sources.
    """
    kept = cache_directory()
    return kept is not None and any((kept / source_stamp(folder)[:_TAG_LENGTH]).glob("*.nbc"))


class SourceLocator:
    """Numba's protocol of a cache locator: where a function's code lies and when it is stale."""

    def __init__(self, function: Callable[..., Any], source: str, folder: Path) -> None:
        self._function = function
        self._root = _root_of(Path(source))
        self._stamp = _stamp(self._root)
        self._folder = folder / self._stamp[:_TAG_LENGTH]

    @classmethod
    def from_function(cls, function: Callable[..., Any], _source: str) -> "SourceLocator | None":
        """Return a locator, or None if nothing can be kept.

        Parameters
        ----------
        function : callable
            The Python function that is compiled.
        _source : str
            Its file as numba knows it.

        Returns
        -------
        SourceLocator or None
            The locator.
        """
        folder = cache_directory()
        return None if folder is None else cls(function, getfile(function), folder)

    def ensure_cache_path(self) -> None:
        """Make the folder of this function's code."""
        make_private(self._folder)

    def get_cache_path(self) -> str:
        """Return the folder of this function's code."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Return what changes with every change of the sources and makes older code stale."""
        return self._stamp

    def has_changed(self) -> bool:
        """Tell whether the sources are others now: then it is not known which ones were compiled.

        They may have been edited while they were imported, or imported anew after an edit.

        Returns
        -------
        bool
        """
        try:
            return _present_stamp(self._root) != self._stamp
        except OSError:  # they are being removed
            return True

    def get_disambiguator(self) -> str:
        """Return the part of the file's name that tells functions of one name apart."""
        place = f"{self._function.__module__}:{self._function.__code__.co_firstlineno}"
        return hashlib.sha256(place.encode()).hexdigest()[:12]
