"""Files of this program in a folder, told apart from those of the user by a list.

The list is an entry of the file that describes the results: ``run.json``, ``calibration.json``, ...
What it does not name is the user's, and is neither removed nor overwritten.
"""

import json
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from ...files import write_json
from ..errors import InputRefused, Problem

MARK = ".rockshed"
"""File in a folder in which this program works; its results do not have it."""
FILES = "rockshed_files"
"""Entry with the list, paths relative to the folder."""
_DESCRIPTIONS = ("run.json", "calibration.json", "convergence.json", "exchange-steps.json")
"""Files that may have the list."""
_HEAD = 4096
"""Bytes in which a picture says who has made it."""
_EARLIER = (
    *("run.json", "summary.json", "columns.csv", "timeseries.parquet", "timeseries.csv"),
    *("states.h5", "timeseries.arrows", "states.arrows", "journal.bin", "journal.json"),
    *("trials.parquet", "envelopes.parquet", "envelopes.csv", "traces.parquet", "traces.csv"),
    *("bearing.parquet", "bearing.csv"),
)
"""Files of runs that have no list: earlier versions wrote none."""


def mark(folder: Path) -> None:
    """Mark a folder that this program has made, as long as it works in it."""
    write_json(folder / MARK, {"made by": "rockshed"})


def is_marked(folder: Path) -> bool:
    """Tell whether this program made a folder and has not ended its work in it."""
    return not folder.is_symlink() and "made by" in read_data(folder / MARK)


def read_data(file: Path) -> dict[str, Any]:
    """Read a JSON object; return an empty one where there is none that can be read."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def own_files(folder: Path) -> set[str]:
    """Return the files of this program in a folder, relative to it."""
    own: set[str] = set()
    for name in _DESCRIPTIONS:
        entry = read_data(folder / name).get(FILES)
        if isinstance(entry, list):
            own |= {name, *map(str, entry)}
    if not own and "status" in read_data(folder / "run.json"):
        return set(_EARLIER)
    return own or _of_reproduction(folder)


def _of_reproduction(folder: Path) -> set[str]:
    """Return the files of a reproduction; its pictures are known by themselves."""
    is_own = {"format", "studies"} <= read_data(folder / "reproduction.json").keys()
    return {"reproduction.json", "reproduction.html"} if is_own else set()


def is_foreign_picture(file: Path) -> bool:
    """Tell whether something is there that is no picture of this program.

    Each picture of this program says so in its head.
    """
    if not os.path.lexists(file):
        return False
    try:
        with file.open("rb") as stream:
            return b"Software\0rockshed" not in stream.read(_HEAD)
    except OSError:
        return True


def listed(folder: Path, files: Iterable[Path]) -> list[str]:
    """Return those of some files that lie in a folder as paths relative to it, sorted."""
    inside = (os.path.relpath(file, folder) for file in files)
    return sorted({Path(name).as_posix() for name in inside if not name.startswith("..")})


def add_files(folder: Path, files: Iterable[Path]) -> None:
    """Add files in the folder of a run to its list.

    Parameters
    ----------
    folder : Path
        Of the run.
    files : iterable of Path
        In the folder; those elsewhere are left out.
    """
    content = read_data(folder / "run.json")
    names = set(listed(folder, files))
    known = own_files(folder)
    if content and not names <= known:
        write_json(folder / "run.json", {**content, FILES: sorted(known | names)})


def content_of(folder: Path) -> Iterator[str]:
    """Yield everything in a folder but the mark, folders with a slash behind their name.

    Links are not followed.
    """
    for place, folders, files in os.walk(folder):
        here = Path(place).relative_to(folder)
        links = [name for name in folders if Path(place, name).is_symlink()]
        for name in folders:
            if name not in links:
                yield f"{(here / name).as_posix()}/"
        for name in (*files, *links):
            if here / name != Path(MARK):
                yield (here / name).as_posix()


def foreign(folder: Path) -> list[Path]:
    """Return what is the user's in a folder, relative to it.

    A folder without a file of this program is one entry.
    """
    own = own_files(folder)
    kept = {parent for name in own for parent in Path(name).parents}
    found: list[Path] = []
    for name in sorted(content_of(folder)):
        path = Path(name)
        if name in own or path in kept or any(parent in found for parent in path.parents):
            continue
        found.append(path)
    return found


def refuse_foreign(folder: Path, names: Iterable[str], remedy: str) -> None:
    """Refuse to write files where the user has some of these names.

    Parameters
    ----------
    folder : Path
        In which they are about to be written.
    names : iterable of str
        Of the files, relative to the folder.
    remedy : str
        For the person who has to act.

    Raises
    ------
    InputRefused
        One problem for each file of the user that would be overwritten.
    """
    own = own_files(folder)
    there = [name for name in names if name not in own and os.path.lexists(folder / name)]
    if there:
        what = "is there, was not written by this program, and would be overwritten"
        raise InputRefused([Problem(str(folder / name), what, remedy) for name in there])
