"""Checkpoints of a run: everything from which it goes on in another process, in files of data.

A file holds numbers and JSON, behind a line that names its format and one with the hash of what
follows; nothing in it is executed. It is written whole, and the two newest ones are kept beside
that of the begin, so that a process that is killed while it writes loses nothing.
"""

import hashlib
import io
import json
import re
import secrets
import shutil
import zipfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...files import write_file

FOLDER = "checkpoints"
"""Folder of the checkpoints in that of their run."""
BEGIN = 0
"""Number of exchanges of the checkpoint that is kept besides the newest ones."""
_SETTLED = "settled.checkpoint"
"""File of the settled states, which are those of FMUs in initialisation mode."""
KEPT = 2
"""Number of the newest checkpoints that are kept, besides that of the start."""
_FORMAT = b"rockshed checkpoint 1\n"
_HASH = 64
_NAME = re.compile(r"exchange-(\d{12})\.checkpoint")
_UNFINISHED = re.compile(r"\.(exchange-\d{12}|settled)\.[0-9a-f]{8}\.checkpoint")
_FACTS, _STATES = "facts", "states"
"""Entries of a file: JSON, and all states one after the other."""
_DAMAGED = (OSError, ValueError, LookupError, TypeError, MemoryError, EOFError, zipfile.BadZipFile)


@dataclass(frozen=True)
class Checkpoint:
    """State of a run after a number of exchanges.

    Attributes
    ----------
    exchange : int
        Number of exchanges carried out.
    facts : mapping of str to Any
        JSON: rows and frames written, times spent, what was said, program.
    tables : mapping of str to array
        Values of the master: both buses, works, extremes, accounts.
    states : mapping of str to bytes
        Serialized states by component.
    """

    exchange: int
    facts: Mapping[str, Any]
    tables: Mapping[str, NDArray[Any]]
    states: Mapping[str, bytes]

    @property
    def rows(self) -> int:
        """Number of rows that the run had written."""
        return int(self.facts["rows"])

    @property
    def frames(self) -> int:
        """Number of recorded states that the run had written of each component."""
        return int(self.facts["frames"])


class CheckpointDamaged(ValueError):  # noqa: N818 (it says what happened)
    """A file is no checkpoint, or not the one that was written."""


def new_record(every: float, warnings: Sequence[str]) -> dict[str, Any]:
    """Return the entry of a run that takes checkpoints, for its provenance.

    Parameters
    ----------
    every : float
        Simulated time (s) between two checkpoints.
    warnings : sequence of str
        That were known before the first step.

    Returns
    -------
    dict
        With a name by which the folders of one run are known.
    """
    return {"every": every, "run": secrets.token_hex(16), "warnings": list(warnings)}


def write_checkpoint(run: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint of a run, whole or not at all, and remove those that are too old.

    Parameters
    ----------
    run : Path
        Folder of the run.
    checkpoint : Checkpoint
        Its state.

    Raises
    ------
    OSError
        It cannot be written; the earlier ones are there.
    """
    (run / FOLDER).mkdir(exist_ok=True)
    write_file(file_of(run, checkpoint.exchange), _packed(checkpoint))
    later = [exchange for exchange in known_checkpoints(run) if exchange != BEGIN]
    for exchange in later[:-KEPT]:
        file_of(run, exchange).unlink(missing_ok=True)


def write_settled(run: Path, settled: Checkpoint) -> None:
    """Write the settled states with which a run begins, from which variants can begin too."""
    (run / FOLDER).mkdir(exist_ok=True)
    write_file(run / FOLDER / _SETTLED, _packed(settled))


def read_settled(run: Path) -> Checkpoint | None:
    """Return the settled states with which a run began; None where there are none to be had."""
    try:
        return _unpacked((run / FOLDER / _SETTLED).read_bytes())
    except _DAMAGED:
        return None


def file_of(run: Path, exchange: int) -> Path:
    """Return the file of a run's checkpoint after so many exchanges."""
    return run / FOLDER / f"exchange-{exchange:012d}.checkpoint"


def known_checkpoints(run: Path) -> list[int]:
    """Return the exchanges of a run after which there is a checkpoint, in order.

    Parameters
    ----------
    run : Path
        Folder of the run.
    """
    try:
        names = [_NAME.fullmatch(path.name) for path in (run / FOLDER).iterdir()]
    except OSError:
        return []
    return sorted(int(name[1]) for name in names if name)


def read_checkpoint(run: Path, exchange: int) -> Checkpoint:
    """Read a checkpoint of a run.

    Parameters
    ----------
    run : Path
        Folder of the run.
    exchange : int
        One of :func:`known_checkpoints`.

    Raises
    ------
    CheckpointDamaged
        The file is no checkpoint, or damaged.
    """
    file = file_of(run, exchange)
    try:
        found = _unpacked(file.read_bytes())
    except _DAMAGED as error:
        raise CheckpointDamaged(f"{file}: {error}") from error
    if found.exchange != exchange:
        raise CheckpointDamaged(f"{file}: it is that after {found.exchange} exchanges")
    return found


def readable_checkpoints(run: Path) -> list[Checkpoint]:
    """Return the checkpoints of a run that are whole, in order."""
    found = []
    for exchange in known_checkpoints(run):
        with suppress(CheckpointDamaged):
            found.append(read_checkpoint(run, exchange))
    return found


def copy_checkpoints(source: Path, target: Path, exchanges: Sequence[int]) -> None:
    """Copy checkpoints and settled states of a run to the folder in which it goes on."""
    (target / FOLDER).mkdir(exist_ok=True)
    with suppress(OSError):
        shutil.copyfile(source / FOLDER / _SETTLED, target / FOLDER / _SETTLED)
    for exchange in exchanges:
        shutil.copyfile(file_of(source, exchange), file_of(target, exchange))


def remove_checkpoints(run: Path) -> None:
    """Remove the checkpoints of a run, and their folder if it holds nothing else."""
    for file in (run / FOLDER).iterdir() if (run / FOLDER).is_dir() else ():
        if file.name == _SETTLED or _NAME.fullmatch(file.name) or _UNFINISHED.fullmatch(file.name):
            file.unlink(missing_ok=True)
    with suppress(OSError):
        (run / FOLDER).rmdir()


def _packed(checkpoint: Checkpoint) -> bytes:
    sizes = {name: len(state) for name, state in checkpoint.states.items()}
    facts = {**checkpoint.facts, "exchange": checkpoint.exchange, _STATES: sizes}
    entries: dict[str, Any] = {
        _FACTS: np.frombuffer(json.dumps(facts).encode(), np.uint8),
        _STATES: np.frombuffer(b"".join(checkpoint.states.values()), np.uint8),
    }
    stream = io.BytesIO()
    entries |= {f"table-{name}": table for name, table in checkpoint.tables.items()}
    np.savez(stream, **entries)
    content = stream.getbuffer()
    return _FORMAT + hashlib.sha256(content).hexdigest().encode() + b"\n" + content


def _unpacked(data: bytes) -> Checkpoint:
    begin = len(_FORMAT) + _HASH + 1
    content = data[begin:]
    if not data.startswith(_FORMAT):
        raise ValueError("is no checkpoint of this version of the program")
    if data[len(_FORMAT) : begin] != hashlib.sha256(content).hexdigest().encode() + b"\n":
        raise ValueError("is damaged: its hash is that of other content")
    with np.load(io.BytesIO(content), allow_pickle=False) as stored:
        facts = json.loads(stored[_FACTS].tobytes())
        whole = stored[_STATES].tobytes()
        tables = {
            name.removeprefix("table-"): stored[name]
            for name in stored.files
            if name.startswith("table-")
        }
    states = {}
    place = 0
    for name, size in facts.pop(_STATES).items():
        states[str(name)] = whole[place : place + int(size)]
        place += int(size)
    return Checkpoint(int(facts["exchange"]), facts, tables, states)
