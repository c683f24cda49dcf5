"""Arguments of an analysis, kept while it is carried out: it can go on in another process."""

import hashlib
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from ..core.errors import InputRefused, Problem, RunFailed, refusing_unwritable
from ..core.results.own_files import read_data
from ..files import write_file
from ..runs.kept import ASKED, FINISHED

_LOCK = "asked.lock"
"""File that is locked as long as a process carries out the analysis."""
_AGAIN = "start the same command again"


@dataclass(frozen=True)
class Asked:
    """An analysis that was begun and has not ended.

    Attributes
    ----------
    kind : str
        Of the analysis: ``study``, ``rockfall``.
    folder : Path
        Of its results.
    arguments : mapping of str to Any
        Plain data.
    file : Path
        In which they are kept.
    """

    kind: str
    folder: Path
    arguments: Mapping[str, Any]
    file: Path


def finished_trials(folder: Path) -> Path:
    """Return the folder of finished trials: beside the results, which appear as a whole."""
    return folder.absolute().with_name(f".{folder.absolute().name}-finished-trials")


def find_asked(folder: Path) -> Asked | None:
    """Return the analysis that was begun with results in a folder, and has not ended.

    Parameters
    ----------
    folder : Path
        Of the results.

    Returns
    -------
    Asked or None
        None where there is none.

    Raises
    ------
    InputRefused
        It cannot go on: a file that it was asked with is another one, or its arguments are not
        kept.
    """
    for place in (folder / FINISHED, finished_trials(folder)):
        content = read_data(place / ASKED)
        kind, files = content.get("kind"), content.get("files")
        if not isinstance(kind, str) or not isinstance(files, dict):
            continue
        arguments: Any = content.get("arguments")
        problems = [*_changed(files)]
        if not isinstance(arguments, dict):
            what = "was asked with objects of Python, which no file keeps"
            problems.append(Problem(str(folder), what, "call the function again: it goes on"))
        if problems:
            raise InputRefused(problems)
        return Asked(kind, folder, arguments, place / ASKED)
    return None


def _changed(files: Mapping[str, Any]) -> Iterator[Problem]:
    """Yield the files that are not those with which an analysis was asked."""
    for name, digest in files.items():
        if _digest(Path(name)) != digest:
            what = "has changed since, or is not there any more"
            remedy = f"put the earlier file there, or {_AGAIN} for results of what it is now"
            yield Problem(str(name), what, remedy)


def _digest(file: Path) -> str | None:
    try:
        return hashlib.sha256(file.read_bytes()).hexdigest()
    except (OSError, ValueError):
        return None


@contextmanager
def remembering(
    place: Path | None, kind: str, arguments: Mapping[str, Any], files: Sequence[Path] = ()
) -> Iterator[None]:
    """Keep what an analysis was asked until it has ended, is refused or its first run has failed.

    Whatever else ends the block, a kill for instance, it can go on from there.

    Parameters
    ----------
    place : Path or None
        Folder of what has ended of it; None keeps nothing.
    kind : str
        Of the analysis.
    arguments : mapping of str to Any
        That another process needs to go on.
    files : sequence of Path
        That it reads, absolute.

    Raises
    ------
    InputRefused
        The folder cannot be written, has somebody else's file, or another process is at this work.
    """
    if place is None:
        yield
        return
    missing = [parent for parent in (place, *place.parents) if not os.path.exists(parent)]
    try:
        with _locked(place):
            before = _earlier(place)
            with refusing_unwritable(place, "choose another folder"):
                write_file(place / ASKED, _content(kind, arguments, files))
            try:
                yield
            except InputRefused:
                _put_back(place, before)
                raise
            except RunFailed:
                if not _has_more(place):
                    _put_back(place, None)
                raise
            _put_back(place, None)
    finally:
        _remove_empty(missing)


def _has_more(place: Path) -> bool:
    """Tell whether a folder has anything else than what was asked."""
    return any(file.name not in (ASKED, _LOCK) for file in place.iterdir())


def _earlier(place: Path) -> bytes | None:
    """Return what the file of a folder holds; None where there is none.

    Raises
    ------
    InputRefused
        It is somebody else's.
    """
    file = place / ASKED
    if not file.exists():
        return None
    if "kind" not in read_data(file):
        what = "was not written by this program, and would be overwritten"
        raise InputRefused([Problem(str(file), what, "rename it")])
    return file.read_bytes()


def _put_back(place: Path, before: bytes | None) -> None:
    """Let an analysis be asked as before, or not at all."""
    if before is None:
        # the others were being written when their process was killed
        for file in (place / ASKED, *place.glob(".asked.????????.json")):
            file.unlink(missing_ok=True)
    else:
        write_file(place / ASKED, before)


def _content(kind: str, arguments: Mapping[str, Any], files: Sequence[Path]) -> str:
    """Return the text of the file; without arguments where they are no plain data."""
    known = {"kind": kind, "files": {str(file): _digest(file) for file in files}}
    try:
        return json.dumps({**known, "arguments": arguments}, default=_plain, indent=1) + "\n"
    except (TypeError, ValueError):
        return json.dumps({**known, "arguments": None}, indent=1) + "\n"


def _plain(value: Any) -> Any:
    """Return a number or an array of numpy as Python has it, a path as a text.

    Raises
    ------
    TypeError
        It is something else.
    """
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is no plain data")


@contextmanager
def _locked(place: Path) -> Iterator[None]:
    """Let no other process do this work meanwhile."""
    with refusing_unwritable(place, "choose another folder"):
        place.mkdir(parents=True, exist_ok=True)
    lock = FileLock(place / _LOCK)
    try:
        with suppress(NotImplementedError):  # a file system without locks
            lock.acquire(timeout=0)
    except Timeout:
        what = "another process is at this work"
        remedy = "wait for its end or choose another folder"
        raise InputRefused([Problem(str(place.parent), what, remedy)]) from None
    try:
        yield
    finally:
        (place / _LOCK).unlink(missing_ok=True)
        lock.release()
        _remove_empty([place])


def _remove_empty(folders: Sequence[Path]) -> None:
    """Remove folders, the innermost first, up to one that is not empty."""
    for folder in folders:
        with suppress(OSError):
            folder.rmdir()
