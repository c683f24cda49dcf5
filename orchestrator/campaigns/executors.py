"""Who computes the trials of a campaign, and how what has ended is gathered and kept."""

from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..animations.formats import Count
from .campaign import Campaign, TrialRecords, empty_records, on_threads
from .kept import KeptTrials

TrialBlock = tuple[int, int]
"""First trial, and number of trials."""
Blocks = Callable[[TrialRecords, NDArray[np.bool_]], Generator[TrialBlock, None, None]]
"""Computes the trials that are not done, and yields each block that has ended."""


@dataclass(frozen=True)
class Executor:
    """Threads or processes that compute trials.

    Attributes
    ----------
    run : callable
        Computes all trials of a campaign, and counts them.
    facts : mapping of str to Any
        Entries of ``run.json`` about it.
    """

    run: Callable[[Campaign, Count], TrialRecords]
    facts: Mapping[str, Any]


@contextmanager
def threads(workers: int, kept: KeptTrials | None = None) -> Iterator[Executor]:
    """Open an executor of so many threads of this process.

    Parameters
    ----------
    workers : int
        Number of threads.
    kept : KeptTrials, optional
        Trials that have been computed before, to which others are added.

    Yields
    ------
    Executor
        There until the block ends.
    """

    def run(campaign: Campaign, count: Count) -> TrialRecords:
        def blocks(
            records: TrialRecords, done: NDArray[np.bool_]
        ) -> Generator[TrialBlock, None, None]:
            return on_threads(campaign, workers, records, done)

        return gather(campaign, blocks, count, kept)

    yield Executor(run, {"workers": workers})


def gather(
    campaign: Campaign, blocks: Blocks, count: Count, kept: KeptTrials | None = None
) -> TrialRecords:
    """Compute the trials of a campaign but those that are kept; keep what ends meanwhile.

    Parameters
    ----------
    campaign : Campaign
        To be computed.
    blocks : callable
        Computes what is missing.
    count : Count
        Called with the numbers of trials done and of all.
    kept : KeptTrials, optional
        Trials that have been computed before, to which others are added: now and then, and when
        this ends before its time. A kill takes what has ended since then.

    Returns
    -------
    TrialRecords
        In the order of the trials.
    """
    records = empty_records(campaign, campaign.trials)
    done = kept.find(campaign, records) if kept else np.zeros(campaign.trials, bool)
    if done.any():
        count(int(done.sum()), campaign.trials)
    try:
        with closing(blocks(records, done)) as computed:
            for first, number in computed:
                done[first : first + number] = True
                count(int(done.sum()), campaign.trials)
                if kept:
                    kept.add(campaign, records, first, number)
    except BaseException:
        if kept:
            kept.write(campaign, records)
        raise
    return records
