"""Trials that had been computed when a campaign could not go on, kept until it is run again."""

import hashlib
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.cache import source_stamp

from ..files import whole_file
from .campaign import Campaign, TrialRecords

_RECORDS = ("passages", "peaks", "outcomes")
_DAMAGED = (OSError, ValueError, LookupError, EOFError, MemoryError, RuntimeError)
_DAMAGED_ARCHIVE = (zipfile.BadZipFile, zlib.error)


@dataclass(frozen=True)
class KeptTrials:
    """A file of finished trials.

    Attributes
    ----------
    file : Path
        Its folder has to exist when trials are kept.
    """

    file: Path

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
        with suppress(*_DAMAGED, *_DAMAGED_ARCHIVE), np.load(self.file) as stored:
            if stored["campaign"].tobytes() == _digest(campaign):
                before = stored["done"][: campaign.trials]
                rows = int(before.sum())
                parts = {name: stored[name] for name in _RECORDS}
                for name, values in parts.items():
                    target = getattr(records, name)
                    if values.dtype != target.dtype or values.shape[1:] != target.shape[1:]:
                        raise ValueError("it has records of another kind")
                    target[: len(before)][before] = values[:rows]
                done[: len(before)] = before
        return done

    def keep(self, campaign: Campaign, records: TrialRecords, done: NDArray[np.bool_]) -> bool:
        """Keep the trials that are done; tell whether that was possible.

        A file that is not of this class stays as it is.
        """
        if self.file.exists() and not self._is_own():
            return False
        with suppress(OSError):
            with whole_file(self.file) as place, place.open("wb") as stream:
                np.savez(
                    stream,
                    campaign=np.frombuffer(_digest(campaign), np.uint8),
                    done=done,
                    **{name: getattr(records, name)[done] for name in _RECORDS},
                )
            return True
        return False

    def clear(self) -> None:
        """Remove the file, if its content is of this class."""
        if self._is_own():
            self.file.unlink(missing_ok=True)

    def _is_own(self) -> bool:
        with suppress(*_DAMAGED, *_DAMAGED_ARCHIVE), np.load(self.file) as stored:
            return {"campaign", "done", *_RECORDS} <= set(stored)
        return False


def _digest(campaign: Campaign) -> bytes:
    """Return a digest of everything that a trial follows from but its number."""
    digest = hashlib.sha256(source_stamp(component("SlopeRockfall").folder).encode())
    for part in _parts(campaign):
        digest.update(part)
    return digest.digest()


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
