"""The health of an installation: kept code, compilers, leftovers of runs, and what is slow."""

import os
import re
import stat
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.cache import cache_path, cache_problem, has_kernels, source_stamp
from rockshed.components.common.kept import is_sound
from rockshed.fmus.native.fmu import PLATFORMS, compiler
from rockshed.fmus.parts import BuildError, Runtime
from rockshed.fmus.places import fmu_folder, native_is_fresh

from ..core.loop import machine_code
from ..core.results.run_folder import unfinished
from ..ssp.package import UNPACKED
from ..tables import Table
from ..temporary import left_behind
from ..versions import versions
from .kept import begun

_STAMP = re.compile(r"[0-9a-f]{16}")
_OBJECT = re.compile(rf"\w+-({'|'.join(PLATFORMS)})-[0-9a-f]{{24}}\.o")
_LOOP = re.compile(r"loop-[0-9a-f]{24}\.o")
_UNFINISHED = re.compile(r"\.[0-9a-f]{16}\.tmp")
_OF_SSP = "files of SSPs"
_PACKAGES = ("numpy", "numba", "llvmlite", "scipy", "fmpy", "pythonfmu", "matplotlib", "typer")


@dataclass(frozen=True)
class Kept:
    """A file of kept code.

    Attributes
    ----------
    file : Path
        The file.
    kind : str
        The kind of code in it.
    is_current : bool
        Whether the present sources still lead to it.
    """

    file: Path
    kind: str
    is_current: bool


def kept_files() -> list[Kept]:
    """Return the files of kept code.

    Returns
    -------
    list of Kept
        Those whose names rockshed gives; whatever else lies in the folder is not looked at.
    """
    try:
        folder = cache_path()
        entries = sorted(folder.iterdir())
    except (OSError, RuntimeError):
        return []
    current = _current_stamps()
    return [kept for entry in entries for kept in _kept(entry, current)]


def _current_stamps() -> set[str]:
    return {source_stamp(component(name).folder)[:16] for name in NAMES}


def _kept(entry: Path, current: set[str]) -> Iterator[Kept]:
    """Return the kept files of an entry: the file itself, or those of the kernels of a stamp."""
    if entry.is_symlink():
        return
    if entry.is_dir() and _STAMP.fullmatch(entry.name):
        for file in sorted(entry.iterdir()):
            if file.suffix in (".nbi", ".nbc") or _UNFINISHED.fullmatch(file.name):
                yield Kept(file, "compiled kernels", entry.name in current)
    elif entry.is_file() and _OBJECT.fullmatch(entry.name):
        yield Kept(entry, "kernels of native FMUs", True)
    elif entry.is_file() and _LOOP.fullmatch(entry.name):
        yield Kept(entry, "exchange loop", entry == machine_code.kept_file())
    elif entry.is_file() and _UNFINISHED.fullmatch(entry.name):
        yield Kept(entry, "unfinished file", False)
    elif entry.is_dir() and entry.name == UNPACKED:
        for file in sorted(entry.rglob("*")):
            if file.is_file():
                yield Kept(file, _OF_SSP, True)


def cache_table() -> Table:
    """Return a table of kept code by kind: files, size, health.

    Returns
    -------
    Table
    """
    table = Table(("kept code", "files", "size", "damaged", "of older sources"))
    table.right = table.columns[1:]
    found = kept_files()
    for kind in dict.fromkeys(kept.kind for kept in found):
        members = [kept for kept in found if kept.kind == kind]
        damaged = sum(kept.is_current and not _is_sound(kept) for kept in members)
        old = sum(not kept.is_current for kept in members)
        size = _megabytes(_size(kept.file) for kept in members)
        table.add(kind, str(len(members)), size, str(damaged), str(old))
    return table


def _is_sound(kept: Kept) -> bool:
    """Tell whether a file is as it was written; those of SSPs are not told from others."""
    return kept.kind == _OF_SSP or is_sound(kept.file)


def place_table() -> Table:
    """Return a table of the folders that rockshed writes to by itself: owner and mode.

    Returns
    -------
    Table
    """
    table = Table(("folder", "path", "owner", "mode"))
    folders = {f"{runtime} FMUs": fmu_folder(runtime) for runtime in Runtime}
    with suppress(RuntimeError):  # the user has no home
        folders = {"kept code": cache_path()} | folders
    for name, folder in folders.items():
        table.add(name, str(folder), *_owner_and_mode(folder))
    return table


def _owner_and_mode(folder: Path) -> tuple[str, str]:
    try:
        found = folder.stat()
    except OSError:
        return "is not there", ""
    owner = "you" if found.st_uid == getattr(os, "geteuid", lambda: found.st_uid)() else "another"
    return owner, stat.filemode(found.st_mode)


def tool_table() -> Table:
    """Return a table of compilers and versions.

    Returns
    -------
    Table
    """
    table = Table(("tool", ""))
    for platform in PLATFORMS:
        table.add(f"compiler for {platform}", _compiler_in_words(platform))
    for name, version in versions(*_PACKAGES).items():
        table.add(name, version or "is not installed")
    return table


def _compiler_in_words(platform: str) -> str:
    try:
        return " ".join(compiler(platform))
    except BuildError as error:
        return f"none: {error}"


def leftover_table(results: Path) -> Table:
    """Return a table of what killed runs have left.

    Parameters
    ----------
    results : Path
        Folder of results.

    Returns
    -------
    Table
        Unfinished results, which may be of runs that go on, what has ended of studies and
        campaigns, and this user's temporary folders whose processes are gone.
    """
    table = Table(("left by killed runs", "number", "the first", "how it goes"))
    runs = unfinished(results)
    if runs:
        how = "with the next complete run of this name; until then it can be drawn"
        table.add(
            "unfinished results, if not of a run that goes on", str(len(runs)), str(runs[0]), how
        )
    analyses = begun(results)
    if analyses:
        how = "`rockshed resume` goes on from it; or remove it"
        table.add("analyses that have not ended", str(len(analyses)), str(analyses[0]), how)
    folders = [folder for folder, _ in left_behind()]
    if folders:
        how = "with the next run, or a cleaning"
        table.add("temporary folders", str(len(folders)), str(folders[0]), how)
    return table


def slow_reasons() -> list[str]:
    """Return what makes commands slower than they can be, and why.

    Returns
    -------
    list of str
        Empty if nothing does.
    """
    reasons = []
    if problem := cache_problem():
        reasons.append(f"kernels are compiled at every start, a minute or two: {problem}")
    cold = [name for name in NAMES if not has_kernels(component(name).folder)]
    if cold and not problem:
        reasons.append(
            f"the first use compiles the kernels of {', '.join(cold)}, a minute or two, once"
        )
    stale = [name for name in NAMES if not _is_native_ready(name)]
    if stale:
        reasons.append(
            f"native FMUs are missing or older than their sources ({', '.join(stale)}): FMUs with "
            "Python take up to five times as long in a co-simulation; `rockshed build` with "
            'runtime="native" makes them'
        )
    if os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        reasons.append("NUMBA_DISABLE_JIT is set: kernels run without being compiled")
    return reasons


def _is_native_ready(name: str) -> bool:
    declared = component(name)
    return native_is_fresh(declared, declared.with_sizes())


def clean(found: Sequence[Kept]) -> int:
    """Remove files of kept code; they are compiled anew when they are needed.

    Parameters
    ----------
    found : sequence of Kept
        As :func:`kept_files` returned them.

    Returns
    -------
    int
        Bytes that were freed.
    """
    freed = 0
    for kept in found:
        freed += _size(kept.file)
        kept.file.unlink(missing_ok=True)
    for folder in {kept.file.parent for kept in found if _STAMP.fullmatch(kept.file.parent.name)}:
        with suppress(OSError):  # something else lies there
            folder.rmdir()
    _remove_empty({kept.file.parent for kept in found if kept.kind == _OF_SSP})
    return freed


def _remove_empty(folders: Iterable[Path]) -> None:
    """Remove folders of SSPs in which nothing is left, and those around them."""
    for folder in folders:
        for place in (folder, *folder.parents):
            if place.name == UNPACKED:
                break
            with suppress(OSError):
                place.rmdir()


def _size(file: Path) -> int:
    try:
        return file.lstat().st_size
    except OSError:
        return 0


def _megabytes(sizes: Iterable[int]) -> str:
    return f"{sum(sizes) / 1e6:.1f} MB"
