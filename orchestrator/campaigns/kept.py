"""Trials of a campaign that have been computed, kept until all have: what is killed goes on there.

A file has consecutive trials, and the number of the first one.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.cache import source_stamp

from ..kept_parts import Arrays, KeptParts, digest_of
from .campaign import Campaign, TrialRecords

_RECORDS = ("passages", "peaks", "outcomes")


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
    _parts: KeptParts = field(init=False)
    _waiting: list[tuple[int, int]] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        self._parts = KeptParts(self.folder, "trials")

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

        def take(first: int, parts: Arrays) -> None:
            number = _fill(records, first, parts)
            done[first : first + number] = True

        self._parts.read(_digest(campaign), take)
        self.found = int(done.sum())
        return done

    def add(self, campaign: Campaign, records: TrialRecords, first: int, number: int) -> None:
        """Take note of a block of trials that has ended; write what waits every few seconds.

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
        if self._parts.is_due:
            self.write(campaign, records)

    def write(self, campaign: Campaign, records: TrialRecords) -> None:
        """Write the trials that wait; where there is no room for them, none are kept."""
        contents = {
            first: {part: getattr(records, part)[first : first + number] for part in _RECORDS}
            for first, number in _joined(self._waiting)
        }
        self._waiting = []
        self._parts.write(_digest(campaign), contents)

    def clear(self) -> None:
        """Remove all kept trials, and the folder if it holds nothing else."""
        self._parts.clear()


def _fill(records: TrialRecords, first: int, parts: Arrays) -> int:
    """Fill in the trials of a file from the first one on; return their number.

    Raises
    ------
    ValueError
        It has records of another kind.
    """
    number = min(len(parts["outcomes"]), len(records.outcomes) - first)
    for name in _RECORDS:
        values = parts[name]
        target = getattr(records, name)
        is_alike = values.dtype == target.dtype and values.shape[1:] == target.shape[1:]
        if number < 0 or not is_alike or len(values) != len(parts["outcomes"]):
            raise ValueError("it has records of another kind")
    for name in _RECORDS:
        getattr(records, name)[first : first + number] = parts[name][:number]
    return number


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
    """Return a digest of everything that a trial follows from but its number.

    It does not depend on how many trials there are.
    """
    stamp = source_stamp(component("SlopeRockfall").folder)
    return digest_of(stamp, replace(campaign, trials=0))
