"""What the compilation of kernels has to tell numba. Imported when the first of them is used."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.registry import cpu_target
from numba.extending import typeof_impl

from .kernels import Deferred, cache_directory, component_of, source_stamp


@typeof_impl.register(Deferred)
def _type_of_deferred(value: Deferred, _context: Any) -> Any:
    """To compiled functions, a deferred function is what it stands for."""
    return cpu_target.typing_context.resolve_value_type(value.made)


class _PackageLocator:
    """Numba's protocol of a cache locator: where a function's cache lies and when it is stale."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self._function = function
        self._stamp = source_stamp(component_of(function.__module__))
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
        return hashlib.sha256(
            f"{self._function.__module__}:{self._function.__code__.co_firstlineno}".encode()
        ).hexdigest()[:12]


class _PackageCacheImpl(CompileResultCacheImpl):
    _locator_classes = (_PackageLocator,)


class PackageCache(FunctionCache):
    """The cache of a kernel: see :mod:`rockshed.components.common.kernels`."""

    _impl_class = _PackageCacheImpl
