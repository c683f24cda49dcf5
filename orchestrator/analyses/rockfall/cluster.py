"""A campaign on the workers of a Dask scheduler: processes of this computer, or a cluster.

A task is a block of trials. Its records come back as arrays and are put where they belong, so
nothing depends on who computed a block, or when. A block whose worker dies is computed again by
another.
"""

from collections.abc import Generator, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.cache import source_stamp

from ...campaigns.campaign import (
    Campaign,
    CampaignFailed,
    TrialRecords,
    compute,
    fill,
)
from ...campaigns.executors import Executor, TrialBlock, gather
from ...campaigns.kept import KeptTrials
from ...runs.cluster import GONE, Certificates, ClusterFailed, connected
from ..frame import Count

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["Certificates", "dask_workers"]

FEWEST, MOST = 1000, 20_000
"""Trials in a task: at most some 0.2 s, against the millisecond or so that Dask needs for one."""
MOST_BYTES = 64 << 20
"""Largest size (bytes) of the records of a task."""
TASKS = 8
"""Tasks for each worker, so that all end at about the same time; fewer if they were too small."""
RETRIES = 2
"""Times that a block is computed again after an error; the death of a worker does not count."""
_COMPONENT = "SlopeRockfall"


@contextmanager
def dask_workers(
    scheduler: str,
    workers: int | None,
    certificates: Certificates | None = None,
    kept: KeptTrials | None = None,
) -> Iterator[Executor]:
    """Open an executor of the workers of a Dask scheduler.

    Parameters
    ----------
    scheduler : str
        ``local`` for one that is started here, or the address of a running one.
    workers : int or None
        Number of processes of the local scheduler, by default one for each core.
    certificates : Certificates, optional
        For a scheduler at an address ``tls://HOST:PORT``.
    kept : KeptTrials, optional
        Trials that have been computed before, to which others are added.

    Yields
    ------
    Executor
        There until the block ends.

    Raises
    ------
    InputRefused
        An address that is none, a scheduler that does not answer or has no workers, or no Dask.
    CampaignFailed
        Scheduler and workers cannot be started.
    """
    try:
        with connected(scheduler, workers, certificates) as client:
            facts = {"workers": sum(client.nthreads().values()), "scheduler": scheduler}
            yield Executor(lambda campaign, count: _run(client, campaign, count, kept), facts)
    except ClusterFailed as failure:
        raise CampaignFailed(str(failure)) from failure


# --- the campaign ---


def _run(
    client: "Client", campaign: Campaign, count: Count, kept: KeptTrials | None = None
) -> TrialRecords:
    """Compute all trials of a campaign on the workers of a client, but those that are kept.

    Raises
    ------
    CampaignFailed
        It cannot go on; what has ended is kept.
    """

    def blocks(records: TrialRecords, done: NDArray[np.bool_]) -> Generator[TrialBlock, None, None]:
        return _computed(client, campaign, records, done)

    try:
        return gather(campaign, blocks, count, kept)
    except CampaignFailed as failure:
        if kept is None:
            raise
        text = f"{failure}; trials that have ended are kept: run it again"
        raise CampaignFailed(text) from failure


def _computed(
    client: "Client", campaign: Campaign, records: TrialRecords, done: NDArray[np.bool_]
) -> Generator[TrialBlock, None, None]:
    """Compute the trials that are not done; yield first trial and number of each block."""
    from distributed import as_completed

    # a task that returns the campaign, and no scattered data: where all workers that have it die,
    # it is made again
    common = client.submit(_itself, campaign, pure=False)
    size = _block_size(campaign, sum(client.nthreads().values()))
    stamp = source_stamp(component(_COMPONENT).folder)
    begun = {}
    for start in range(0, campaign.trials, size):
        number = min(size, campaign.trials - start)
        if not done[start : start + number].all():
            block = client.submit(_block, common, start, number, stamp, pure=False, retries=RETRIES)
            begun[block] = start
    for block in as_completed(list(begun)):
        start = begun.pop(block)
        yield start, fill(records, start, _result(block))
        block.release()


def _block_size(campaign: Campaign, workers: int) -> int:
    """Return the number of trials in a task on so many workers. No result depends on it."""
    even = min(MOST, max(FEWEST, campaign.trials // (TASKS * max(1, workers))))
    return max(1, min(even, MOST_BYTES // campaign.bytes_per_trial))


def _itself(campaign: Campaign) -> Campaign:
    return campaign


def _block(campaign: Campaign, first: int, count: int, stamp: str) -> TrialRecords:
    """Compute consecutive trials, by the same program as the client's."""
    if source_stamp(component(_COMPONENT).folder) != stamp:
        raise RuntimeError("it has another version of rockshed: install the same one")
    return compute(campaign, first, count)


def _result(block: Any) -> TrialRecords:
    """Return the records of a block that is done.

    Raises
    ------
    CampaignFailed
        No worker could compute it, or the scheduler is gone.
    """
    from concurrent.futures import CancelledError

    from distributed import KilledWorker

    try:
        records: TrialRecords = block.result()
    except (CancelledError, OSError, TimeoutError) as error:
        raise CampaignFailed(GONE) from error
    except KilledWorker as error:
        text = "workers died again and again while they computed the same block"
        raise CampaignFailed(text) from error
    except Exception as error:
        raise CampaignFailed(f"a worker failed: {type(error).__name__}: {error}") from error
    return records
