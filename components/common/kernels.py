"""Compilation of kernels. Only modules that hold kernels import this one: numba takes 0.4 s.

A component names its module of kernels, and it is imported when the first of them is called. Who
reads declarations only, or runs native FMUs, needs no numba.
"""

import hashlib
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import RLock
from typing import Any

from numba import config, njit
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.serialize import dumps

from .cache import SourceLocator, cache_directory
from .kept import keep, kept

_LOCATOR = f"{SourceLocator.__module__}.{SourceLocator.__qualname__}"
_locating = RLock()
_UNREADABLE = (ImportError, AttributeError)
"""Errors of kept code that names a module of an FMU which has been unpacked elsewhere since."""


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function with numba when it is first called.

    There is no fastmath (results are compared bit for bit), and a division by zero gives inf or
    NaN. Kernels keep to what also compiles without Python: explicit loops, scalar arithmetic,
    slices, other kernels. No allocation, no whole-array expressions, no exceptions; a kernel
    reports a fault by its return value.

    Parameters
    ----------
    function : callable
        The kernel.

    Returns
    -------
    callable
        Numba's dispatcher of it.
    """
    return _compiled(function, inline="never")


def inlined(function: Callable[..., Any]) -> Any:
    """Make a :func:`kernel` that is set into its callers: for small functions inside hot loops.

    Parameters
    ----------
    function : callable
        The kernel.

    Returns
    -------
    callable
        Numba's dispatcher of it.
    """
    return _compiled(function, inline="always")


def released(function: Callable[..., Any]) -> Any:
    """Make a :func:`kernel` during which other Python threads run: for calls that take long.

    Parameters
    ----------
    function : callable
        The kernel.

    Returns
    -------
    callable
        Numba's dispatcher of it.
    """
    return _compiled(function, inline="never", nogil=True)


def _compiled(function: Callable[..., Any], **options: Any) -> Any:
    dispatcher = njit(error_model="numpy", _nrt=False, **options)(function)
    if cache_directory() is not None and hasattr(dispatcher, "_cache"):
        with _cache_by_sources():
            dispatcher._cache = _KernelCache(function)
    return dispatcher


class _KernelCache(FunctionCache):
    """Numba's cache of a function, over files that are looked at before they are taken."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file = _KeptFiles(
            self._cache_path, self._impl.filename_base, self._impl.locator.get_source_stamp()
        )

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep compiled code, but not that of sources that may be others than its name says.

        Parameters
        ----------
        sig : tuple
            Signature.
        data : object
            What numba has compiled.
        """
        if not self._impl.locator.has_changed():
            super().save_overload(sig, data)


class _KeptFiles(IndexDataCacheFile):
    """Index and code of a function; a file that was damaged or planted counts as not there.

    Numba unpickles both, which can execute anything.
    """

    def save(self, key: Any, data: Any) -> None:
        """Keep the code of a function for one signature and processor: first it, then its name.

        Numba numbers the files, and names one before it is there. Two processes that compile for
        two processors could then take each other's code, and so could one after a kill in between.
        What cannot be written, on a full disk for instance, is compiled again next time.

        Parameters
        ----------
        key : tuple
            Signature, processor and hash of the function.
        data : tuple
            The code.
        """
        name = f"{self._index_name.removesuffix('.nbi')}.{_digest(key)}.nbc"
        with suppress(OSError):
            self._save_data(name, data)
            self._save_index({**self._load_index(), key: name})

    def _load_index(self) -> Any:
        content = kept(Path(self._index_path))
        if content is None:
            return {}
        try:
            version, stamp, overloads = pickle.loads(content)
        except _UNREADABLE:
            return {}
        fits = (version, stamp) == (self._version, self._source_stamp)
        return overloads if fits else {}

    def _save_index(self, overloads: Any) -> None:
        keep(Path(self._index_path), dumps((self._version, self._source_stamp, overloads)))

    def _load_data(self, name: str) -> Any:
        content = kept(Path(self._data_path(name)))
        if content is None:
            raise FileNotFoundError(name)  # numba compiles anew then
        try:
            return pickle.loads(content)
        except _UNREADABLE as reason:
            raise FileNotFoundError(name) from reason

    def _save_data(self, name: str, data: Any) -> None:
        keep(Path(self._data_path(name)), dumps(data))


def _digest(key: Any) -> str:
    return hashlib.sha256(dumps(key)).hexdigest()[:16]


@contextmanager
def _cache_by_sources() -> Iterator[None]:
    """Let numba look up the place of a cache by :class:`SourceLocator`, and not for longer.

    It does so when it makes a dispatcher, and reads the names of its locators from a setting that
    belongs to the whole process (``NUMBA_CACHE_LOCATOR_CLASSES``), other libraries included.
    """
    with _locating:
        before = config.CACHE_LOCATOR_CLASSES
        config.CACHE_LOCATOR_CLASSES = _LOCATOR
        try:
            yield
        finally:
            config.CACHE_LOCATOR_CLASSES = before


@inlined
def view(buffer, k, entry):
    """Return the array of a table entry of ``k`` as a slice of ``buffer`` (no copy).

    Parameters
    ----------
    buffer : ndarray
        One of the buffers ``w``, ``x`` or ``k``.
    k : ndarray of int64
        The buffer that begins with the table of arrays.
    entry : int
        Place of the entry: a field of :attr:`.ports.Layout.array`.

    Returns
    -------
    ndarray
        The slice.
    """
    return buffer[k[entry] : k[entry] + k[entry + 1]]
