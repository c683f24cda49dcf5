"""Turns of a measurement that were taken, in a file: ended, a measurement goes on from there."""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple

from filelock import FileLock, Timeout

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..files import naming, write_file
from .measured import MasterRun

_FILE, _LOCK = "measured so far.jsonl", ".measured.lock"


class Turn(NamedTuple):
    """One master with one system and one kind of FMUs, in one round.

    Attributes
    ----------
    system, variant, master : str
        Their names.
    round : int
        Counted from 0.
    """

    system: str
    variant: str
    master: str
    round: int


class TurnJournal:
    """Turns that were taken, and what was measured in them.

    Parameters
    ----------
    file : Path, optional
        Where they are kept, a line each; without it, in memory alone.
    facts : mapping of str to Any
        Plain data that the measurements follow from. A file with others begins anew.
    """

    def __init__(self, file: Path | None = None, facts: Mapping[str, Any] | None = None) -> None:
        self.file = file
        self.rows: dict[Turn, list[MasterRun]] = {}
        self.seconds = 0.0
        """Time that all turns took, added up (s)."""
        self._lock = Lock()
        self.is_other = False
        """Whether the file had measurements of something else, which have been dropped."""
        lines = [json.dumps({"facts": facts or {}}, sort_keys=True)]
        if file is not None:
            there = _whole_lines(file)
            self.is_other = bool(there) and there[0] != lines[0]
            lines += [] if self.is_other else there[1:]
            write_file(file, "".join(f"{line}\n" for line in lines))
        for line in lines[1:]:
            self._enter(json.loads(line))

    def _enter(self, entry: Mapping[str, Any]) -> None:
        self.rows[Turn(*entry["turn"])] = [MasterRun(**row) for row in entry["rows"]]
        self.seconds += entry["seconds"]

    def add(self, turn: Turn, rows: Sequence[MasterRun], seconds: float) -> None:
        """Keep what was measured in a turn, and the time (s) that it took."""
        entry = {"turn": turn, "rows": [asdict(row) for row in rows], "seconds": seconds}
        with self._lock:
            self._enter(entry)
            if self.file is not None:
                with naming(self.file), self.file.open("a", encoding="utf-8") as opened:
                    opened.write(json.dumps(entry) + "\n")

    def remove(self) -> None:
        """Remove the file: everything has been measured, and is kept elsewhere."""
        if self.file is not None:
            self.file.unlink(missing_ok=True)


@contextmanager
def journal_in(folder: Path, facts: Mapping[str, Any]) -> Iterator[TurnJournal]:
    """Open the journal of a folder, which is made, and let no other process measure into it.

    Parameters
    ----------
    folder : Path
        Of the results.
    facts : mapping of str to Any
        As in :class:`TurnJournal`.

    Raises
    ------
    InputRefused
        Another process measures into it, or it cannot be written.
    """
    lock = FileLock(folder / _LOCK)
    with refusing_unwritable(folder):
        folder.mkdir(parents=True, exist_ok=True)
        try:
            lock.acquire(timeout=0)
        except Timeout:
            what = "another process is measuring into this folder"
            remedy = "wait until it has ended, or choose another folder"
            raise InputRefused([Problem(str(folder), what, remedy)]) from None
    try:
        with refusing_unwritable(folder):
            made = TurnJournal(folder / _FILE, facts)
        yield made
    finally:
        lock.release()


def _whole_lines(file: Path) -> list[str]:
    """Return the lines of a file up to the first one that was not written to its end."""
    found: list[str] = []
    try:
        text = file.read_text(encoding="utf-8", errors="replace")
    except FileNotFoundError:
        return found
    for line in text.splitlines():
        try:
            json.loads(line)
        except ValueError:
            break
        found.append(line)
    return found
