"""Trials of a campaign that have been computed, kept until all have: what is killed goes on there.

A file for consecutive trials, named by everything that they follow from. It has numbers, is written
whole, and one that is damaged is as if it were not there.
"""

import hashlib
import re
import time
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.cache import source_stamp

from ..files import whole_file
from .campaign import Campaign, TrialRecords

INTERVAL = 5.0
"""Time (s) after which trials are written down: what a kill may cost."""
_UNFINISHED = re.compile(r"\.trials-[0-9a-f]{32}-\d{12}\.[0-9a-f]{8}\.npz")
"""Name of one that was being written when its process was killed."""
_RECORDS = ("passages", "peaks", "outcomes")
_NAME = re.compile(r"trials-[0-9a-f]{32}-(\d{12})\.npz")
"""Name of a file: part of the digest of its campaign, and its first trial."""
_DAMAGED = (OSError, ValueError, LookupError, EOFError, MemoryError, RuntimeError)
_DAMAGED_ARCHIVE = (zipfile.BadZipFile, zlib.error)


@dataclass
class KeptTrials:
    """A folder of finished trials.

    Attributes
    ----------
    folder : Path
        Is made with the first trials that are kept.
    found : int
        Number of trials that had been computed before.
    """

    folder: Path
    found: int = field(default=0, init=False)
    _waiting: list[tuple[int, int]] = field(default_factory=list, init=False)
    _written: float = field(default_factory=time.monotonic, init=False)
    _has_room: bool = field(default=True, init=False)

    def find(self, campaign: Campaign, records: TrialRecords) -> NDArray[np.bool_]:
        """Fill in the trials that have been computed before.

        Parameters
        ----------
        campaign : Campaign
            To be computed.
        records : TrialRecords
            Of all its trials.

        Returns
        -------
        array of bool, shape (trials,)
            Trials that are filled in; none of another campaign, or of a file that is damaged.
        """
        done = np.zeros(campaign.trials, bool)
        for file in self._files(_digest(campaign)):
            with suppress(*_DAMAGED, *_DAMAGED_ARCHIVE):
                first, number = _filled(records, file)
                done[first : first + number] = True
        self.found = int(done.sum())
        return done

    def add(self, campaign: Campaign, records: TrialRecords, first: int, number: int) -> None:
        """Take note of a block of trials that has ended; write what waits every :data:`INTERVAL`.

        Parameters
        ----------
        campaign : Campaign
            To which they belong.
        records : TrialRecords
            Of all its trials.
        first, number : int
            First trial of the block, and number of its trials.
        """
        self._waiting.append((first, number))
        if time.monotonic() - self._written > INTERVAL:
            self.write(campaign, records)

    def write(self, campaign: Campaign, records: TrialRecords) -> None:
        """Write the trials that wait.

        Where the disk is full, or cannot be written, all kept trials are removed: the results need
        the room.
        """
        ranges = _joined(self._waiting)
        self._waiting = []
        try:
            for first, number in ranges if self._has_room else []:
                self.folder.mkdir(parents=True, exist_ok=True)
                name = f"trials-{_digest(campaign)}-{first:012d}.npz"
                rows = {part: getattr(records, part)[first : first + number] for part in _RECORDS}
                with whole_file(self.folder / name) as place, place.open("wb") as stream:
                    np.savez(stream, **rows)
        except OSError:
            self._has_room = False
            self.clear()
        self._written = time.monotonic()

    def clear(self) -> None:
        """Remove all kept trials, and the folder if it holds nothing else."""
        unfinished = self.folder.glob(".trials-*.npz")
        for file in [*self._files(), *filter(_is_unfinished, unfinished)]:
            file.unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()

    def _files(self, digest: str = "") -> list[Path]:
        """Return the files of this class in the folder, of a campaign or of all."""
        found = sorted(self.folder.glob(f"trials-{digest}*.npz"))
        return [file for file in found if _NAME.fullmatch(file.name) and not file.is_symlink()]


def _is_unfinished(file: Path) -> bool:
    return _UNFINISHED.fullmatch(file.name) is not None and not file.is_symlink()


def _filled(records: TrialRecords, file: Path) -> tuple[int, int]:
    """Fill in the trials of a file; return the first one and their number.

    Raises
    ------
    ValueError
        It has records of another kind.
    """
    first = int(file.stem.rpartition("-")[2])
    with np.load(file) as stored:
        parts = {name: stored[name] for name in _RECORDS}
    number = min(len(parts["outcomes"]), len(records.outcomes) - first)
    for name, values in parts.items():
        target = getattr(records, name)
        is_alike = values.dtype == target.dtype and values.shape[1:] == target.shape[1:]
        if number < 0 or not is_alike or len(values) != len(parts["outcomes"]):
            raise ValueError("it has records of another kind")
    for name, values in parts.items():
        getattr(records, name)[first : first + number] = values[:number]
    return first, number


def _joined(blocks: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return blocks of trials, with those that follow one another as one."""
    found: list[tuple[int, int]] = []
    for first, number in sorted(blocks):
        if found and sum(found[-1]) == first:
            first, number = found[-1][0], found[-1][1] + number
            found.pop()
        found.append((first, number))
    return found


def _digest(campaign: Campaign) -> str:
    """Return a digest of everything that a trial follows from but its number."""
    digest = hashlib.sha256(source_stamp(component("SlopeRockfall").folder).encode())
    for part in _parts(campaign):
        digest.update(part)
    return digest.hexdigest()[:32]


def _parts(value: Any) -> Iterator[bytes]:
    if isinstance(value, np.ndarray):
        yield repr((value.dtype.str, value.shape)).encode()
        yield value.tobytes()
    elif is_dataclass(value):
        for entry in fields(value):
            if entry.name != "trials":  # a trial does not depend on how many there are
                yield entry.name.encode()
                yield from _parts(getattr(value, entry.name))
    else:
        yield repr(value).encode()
