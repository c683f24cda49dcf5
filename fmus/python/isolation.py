"""Keep modules that other FMUs ship away from ours, as FMUs in one process share one interpreter.

pythonfmu's binary puts the ``resources`` folder of every instance first in ``sys.path`` and leaves
it there. Whatever stands in such a folder (``json.py``, ``numpy.py``, ``components/``) would be
imported in the place of the library we mean. This module runs before anything else of an FMU is
imported, so it may itself import only what every interpreter has loaded from the start.
"""

# an older Python must get as far as the message that it is too old
from __future__ import annotations

import os
import sys
from types import ModuleType, TracebackType

_MARK = "slavemodule.txt"
_LIBRARIES = ("numpy", "numba")
_OLDEST_PYTHON = (3, 11)


class ForeignFoldersHidden:
    """Context in which ``sys.path`` is free of the folders of FMUs; it is restored afterwards."""

    def __enter__(self) -> None:
        self._path = list(sys.path)
        sys.path[:] = [
            folder for folder in self._path if not os.path.isfile(os.path.join(folder, _MARK))
        ]

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        sys.path[:] = self._path


def require_libraries(fmu: str) -> None:
    """Import numpy and numba, the real ones.

    Parameters
    ----------
    fmu : str
        Name of the FMU, for messages.

    Raises
    ------
    ImportError
        Python is too old, they are not installed, or another FMU's modules stand in their place or
        keep them from loading.
    """
    if sys.version_info < _OLDEST_PYTHON:
        raise ImportError(
            f"{fmu} needs Python 3.11 or later; this process runs {sys.version.split()[0]} "
            f"({sys.prefix})"
        )
    with ForeignFoldersHidden():
        for name in _LIBRARIES:
            try:
                module = __import__(name)
            except Exception as error:
                raise ImportError(
                    f"{fmu} needs {name} in the Python that runs it ({sys.version.split()[0]}, "
                    f"{sys.prefix}); importing it failed with {type(error).__name__}: {error}. "
                    f"Remedy: pip install numpy numba" + _blame()
                ) from error
            if _is_foreign(module):
                raise ImportError(
                    f"{fmu} needs {name}, but another FMU has loaded a module of its own under "
                    f"this name ({module.__file__}). Remedy: instantiate {fmu} first, or in a "
                    f"process of its own"
                )


def _blame() -> str:
    replaced = sorted(
        name for name in sys.stdlib_module_names if _is_foreign(sys.modules.get(name))
    )
    return (
        f"; other FMUs in this process have replaced {', '.join(replaced)} of the standard library"
        if replaced
        else ""
    )


def _is_foreign(module: ModuleType | None) -> bool:
    folder = os.path.dirname(getattr(module, "__file__", None) or "")
    return any(
        os.path.isfile(os.path.join(f, _MARK)) for f in (folder, os.path.dirname(folder)) if f
    )
