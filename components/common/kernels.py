"""Compilation of kernels. Only modules that hold kernels import this one: numba takes 0.4 s.

A component names its module of kernels, and it is imported when the first of them is called. Who
reads declarations only, or runs native FMUs, needs no numba.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import RLock
from typing import Any

from numba import config, njit

from .cache import SourceLocator, cache_directory

_LOCATOR = f"{SourceLocator.__module__}.{SourceLocator.__qualname__}"
_locating = RLock()


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
    with _cache_by_sources():
        return njit(
            error_model="numpy", cache=cache_directory() is not None, _nrt=False, **options
        )(function)


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
