"""Temporary folders that go with their process: a later run removes those of one that was killed.

Each folder holds a locked file. The system releases the lock when the process ends, however it
ends, so that a folder whose file can be locked belongs to nobody any more.
"""

import os
import shutil
import tempfile
import weakref
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import TracebackType

from filelock import FileLock, Timeout

ALIVE = ".alive"
"""File that is locked as long as the process of a temporary folder lives."""
_PREFIXES = ("rockshed_", "rockshed-", ".rockshed-")
_ATTEMPTS = 10
"""Most attempts to make a folder; one is lost where a sweep comes between making and locking."""
_PATIENCE = 5.0
"""Time (s) for which a sweep may hold the lock of a folder that it removes."""


class TemporaryFolder:
    """A temporary folder of this process. A context manager that gives its path.

    Parameters
    ----------
    prefix : str
        Beginning of its name; ``rockshed_``, ``rockshed-`` or ``.rockshed-`` stand in front.
    place : Path, optional
        Folder in which it is made; by default that of temporary files.

    Attributes
    ----------
    name : str
        Path of the folder.
    """

    def __init__(self, prefix: str = "rockshed_", place: Path | None = None) -> None:
        where = str(place or tempfile.gettempdir())
        sweep_once(where)
        self.name, lock = _made(prefix, where)
        self._remove = weakref.finalize(self, _removed, self.name, lock)

    def cleanup(self) -> None:
        """Remove the folder with all its content."""
        self._remove()

    def __enter__(self) -> Path:
        return Path(self.name)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.cleanup()


def _made(prefix: str, place: str) -> tuple[str, FileLock]:
    """Make a folder and lock it; without a lock where the file system has none."""
    for _ in range(_ATTEMPTS):
        name = tempfile.mkdtemp(prefix=prefix, dir=place)
        lock = _lock(Path(name))
        try:
            lock.acquire(timeout=_PATIENCE)
        except NotImplementedError:
            Path(name, ALIVE).unlink(missing_ok=True)
            return name, lock
        except (Timeout, OSError):  # swept before it was locked
            shutil.rmtree(name, ignore_errors=True)
            continue
        if Path(name, ALIVE).exists():
            return name, lock
        lock.release()
    raise OSError(f"no temporary folder can be made in {place}")


def _lock(folder: Path) -> FileLock:
    return FileLock(folder / ALIVE, thread_local=False)


def _removed(name: str, lock: FileLock) -> None:
    lock.release()  # Windows removes no file that is open
    shutil.rmtree(name, ignore_errors=True)


def sweep_once(place: str = "") -> None:
    """Remove temporary folders of processes that were killed, the first time that this is called.

    Parameters
    ----------
    place : str
        Where to look; by default the folder of temporary files.
    """
    _swept(place or tempfile.gettempdir())


@cache
def _swept(place: str) -> list[Path]:
    return sweep(Path(place))


def left_behind(place: Path | None = None) -> Iterator[tuple[Path, FileLock]]:
    """Find temporary folders of processes that were killed.

    Parameters
    ----------
    place : Path, optional
        Where to look; by default the folder of temporary files.

    Yields
    ------
    (Path, FileLock)
        Folder of this user, and its lock, which is held until the next one is asked for.
    """
    for folder in _candidates(place or Path(tempfile.gettempdir())):
        lock = _lock(folder)
        try:
            lock.acquire(timeout=0)
        except (Timeout, OSError, NotImplementedError):  # its process lives, or it is gone
            continue
        try:
            yield folder, lock
        finally:
            lock.release()


def _candidates(place: Path) -> list[Path]:
    """Return the folders of this user that have a file to lock."""
    try:
        entries = [entry for entry in os.scandir(place) if entry.name.startswith(_PREFIXES)]
    except OSError:
        return []
    return [Path(entry.path) for entry in entries if _is_own(entry)]


def _is_own(entry: "os.DirEntry[str]") -> bool:
    user = getattr(os, "geteuid", lambda: 0)()
    try:
        return (
            entry.is_dir(follow_symlinks=False)
            and entry.stat(follow_symlinks=False).st_uid == user
            and Path(entry.path, ALIVE).is_file()
            and not Path(entry.path, ALIVE).is_symlink()
        )
    except OSError:
        return False


def sweep(place: Path | None = None) -> list[Path]:
    """Remove temporary folders of processes that were killed.

    Parameters
    ----------
    place : Path, optional
        Where to look; by default the folder of temporary files.

    Returns
    -------
    list of Path
        Folders that were removed.
    """
    removed = []
    for folder, _ in left_behind(place):
        shutil.rmtree(folder, ignore_errors=True)
        removed.append(folder)
    return removed
