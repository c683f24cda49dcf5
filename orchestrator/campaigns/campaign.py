"""A campaign: the values that all trials share, and the trials, in blocks on several threads.

A block is a function of the campaign and the numbers of its trials alone: whoever computes it, the
bits are the same.
"""

from collections.abc import Generator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.declarations import BODY
from rockshed.components.slope_rockfall.records import OUTCOME, PASSAGE, PEAK, ROCK
from rockshed.components.slope_rockfall.trajectory import trials

from ..core.errors import AnalysisFailed, InputRefused, Problem
from ..sites.rockfall.checks import reach
from ..sites.rockfall.preparation import PreparedSlope
from ..sites.rockfall.profile import Node, surface
from ..sites.rockfall.rocks import RockSampler
from ..sites.rockfall.site import Barrier, Line

BLOCK = 500
"""Trials in a block: some milliseconds, after which Ctrl-C is heard."""
MOST_MEMORY = 4 << 30
"""Largest size (bytes) of the records of all trials."""
SKY = 1000.0
"""Height (m) above the surface of a search line that has only an x, and of a barrier's line."""


class CampaignFailed(AnalysisFailed):
    """A campaign began and could not go on."""


@dataclass(frozen=True)
class Campaign:
    """Buffers of an initialised SlopeRockfall, and the places at which its trials are recorded.

    Attributes
    ----------
    seed, trials : int
        Of the random numbers, and number of the trials.
    w, x, k : array
        Buffers of the component.
    left, right : float
        x (m) at which a trial ends.
    lines : array of float, shape (n, 4)
        Both points (m) of the search lines and after them of the barriers.
    barriers : array of float, shape (n, 2)
        Reach (m) and capacity (J); a negative reach stops no rock.
    stations : array of float, shape (m,)
        x (m) of the envelopes, evenly spaced.
    names : sequence of str
        Of the lines.
    rocks : RockSampler or None
        Rock and start of each trial; None where they are those of the buffers.
    """

    seed: int
    trials: int
    w: NDArray[np.float64]
    x: NDArray[np.float64]
    k: NDArray[np.int64]
    left: float
    right: float
    lines: NDArray[np.float64]
    barriers: NDArray[np.float64]
    stations: NDArray[np.float64]
    names: Sequence[str]
    rocks: RockSampler | None = None

    @property
    def bytes_per_trial(self) -> int:
        """Memory (bytes) for the records of a trial."""
        return (
            8 * len(OUTCOME)
            + 8 * len(PASSAGE) * len(self.lines)
            + 4 * len(PEAK) * len(self.stations)
        )


def campaign_of(slope: PreparedSlope) -> Campaign:
    """Return the campaign of a slope.

    Parameters
    ----------
    slope : PreparedSlope
        Site with its component.

    Returns
    -------
    Campaign
        Ready to be computed.

    Raises
    ------
    InputRefused
        The records of all trials need more memory than is allowed.
    """
    site = slope.site
    nodes = slope.nodes
    entries: list[Line | Barrier] = [*site.line, *site.barrier]
    holding = [
        (reach(entry, site), entry.capacity) if isinstance(entry, Barrier) else (-1.0, 0.0)
        for entry in entries
    ]
    right = nodes[-1].x if site.profile.end is None else site.profile.end
    campaign = Campaign(
        seed=site.seed,
        trials=site.trials,
        w=slope.instance.w.copy(),
        x=slope.instance.x.copy(),
        k=slope.instance.k.copy(),
        left=nodes[0].x,
        right=right,
        lines=np.array([_ends(entry, nodes) for entry in entries], np.float64).reshape(-1, 4),
        barriers=np.array(holding, np.float64).reshape(-1, 2),
        stations=np.linspace(nodes[0].x, right, site.stations),
        names=tuple(entry.name for entry in entries),
        rocks=slope.rocks if slope.rocks.varies else None,
    )
    _check_memory(campaign, slope.source.places.of(("trials",)))
    return campaign


def _ends(entry: Line | Barrier, nodes: Sequence[Node]) -> tuple[float, float, float, float]:
    """Return the two points (m) of a search line; those of a barrier begin at its foot."""
    if isinstance(entry, Line) and entry.points is not None:
        (x1, y1), (x2, y2) = entry.points
        return x1, y1, x2, y2
    x = float(entry.x or 0.0)
    foot = surface(nodes, x)
    return x, foot, x, foot + SKY


def _check_memory(campaign: Campaign, where: str) -> None:
    needed = campaign.trials * campaign.bytes_per_trial
    if needed > MOST_MEMORY:
        most = MOST_MEMORY // campaign.bytes_per_trial
        text = (
            f"the records of {campaign.trials} trials need {needed / 2**30:.1f} GiB; allowed are "
            f"{MOST_MEMORY / 2**30:.0f}"
        )
        remedy = f"at most {most} trials, or fewer stations or lines"
        raise InputRefused([Problem(where, text, remedy)])


# --- trials ---


@dataclass(frozen=True)
class TrialRecords:
    """Records of n trials.

    Attributes
    ----------
    passages : array of float, shape (n, lines, len(PASSAGE))
        First passage of each line.
    peaks : array of float32, shape (n, stations, len(PEAK))
        Largest values at each station. They have half the digits: there are many of them, and only
        their percentiles are wanted.
    outcomes : array of float, shape (n, len(OUTCOME))
        End of each trial.
    """

    passages: NDArray[np.float64]
    peaks: NDArray[np.float32]
    outcomes: NDArray[np.float64]


def empty_records(campaign: Campaign, count: int) -> TrialRecords:
    """Return records of so many trials, not yet filled.

    Parameters
    ----------
    campaign : Campaign
        With the lines and stations.
    count : int
        Number of trials.

    Returns
    -------
    TrialRecords
        Of undefined content.

    Raises
    ------
    InputRefused
        The computer has not so much memory.
    """
    try:
        return TrialRecords(
            np.empty((count, len(campaign.lines), len(PASSAGE))),
            np.empty((count, len(campaign.stations), len(PEAK)), np.float32),
            np.empty((count, len(OUTCOME))),
        )
    except MemoryError as error:
        size = count * campaign.bytes_per_trial / 2**30
        text = f"the records of {count} trials need {size:.2g} GiB, which cannot be had here"
        remedy = "give fewer trials, stations or lines"
        raise InputRefused([Problem("trials", text, remedy)]) from error


def compute(campaign: Campaign, first: int, count: int) -> TrialRecords:
    """Compute consecutive trials on this thread.

    Parameters
    ----------
    campaign : Campaign
        To which they belong.
    first : int
        Number of the first trial.
    count : int
        Number of trials.

    Returns
    -------
    TrialRecords
        The same bits, whatever trials are computed together.
    """
    records = empty_records(campaign, count)
    peaks = np.empty(records.peaks.shape)
    w, x, k, rocks = own_buffers(campaign, first, count)
    trials(
        campaign.seed,
        first,
        campaign.left,
        campaign.right,
        campaign.lines,
        campaign.barriers,
        float(campaign.stations[0]),
        float(campaign.stations[1] - campaign.stations[0]),
        rocks,
        w,
        x,
        k,
        np.zeros(len(BODY)),
        records.passages,
        peaks,
        records.outcomes,
    )
    records.peaks[:] = peaks
    return records


def own_buffers(
    campaign: Campaign, first: int, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Return buffers for consecutive trials, and their rocks.

    Parameters
    ----------
    campaign : Campaign
        To which the trials belong.
    first, count : int
        Number of the first trial, and of trials.

    Returns
    -------
    w, x, k : array
        Those of the campaign; copies, where the rocks differ and are set in them.
    rocks : array of float, shape (count or 0, len(ROCK))
        No rows, where all rocks are that of the buffers.
    """
    if campaign.rocks is None:
        return campaign.w, campaign.x, campaign.k, np.empty((0, len(ROCK)))
    rocks = campaign.rocks.sample(first, count)
    return campaign.w.copy(), campaign.x.copy(), campaign.k.copy(), rocks


def fill(records: TrialRecords, first: int, block: TrialRecords) -> int:
    """Put the records of a block of trials where they belong.

    Parameters
    ----------
    records : TrialRecords
        Of the whole campaign.
    first : int
        Number of the first trial of the block.
    block : TrialRecords
        Of consecutive trials.

    Returns
    -------
    int
        Number of trials in the block.
    """
    count = len(block.outcomes)
    rows = slice(first, first + count)
    records.passages[rows] = block.passages
    records.peaks[rows] = block.peaks
    records.outcomes[rows] = block.outcomes
    return count


# --- threads ---


def run(campaign: Campaign, workers: int) -> TrialRecords:
    """Compute all trials of a campaign on threads.

    Parameters
    ----------
    campaign : Campaign
        To be computed.
    workers : int
        Number of threads. Kernels release Python's lock.

    Returns
    -------
    TrialRecords
        In the order of the trials.
    """
    records = empty_records(campaign, campaign.trials)
    for _ in on_threads(campaign, workers, records, np.zeros(campaign.trials, bool)):
        pass
    return records


def on_threads(
    campaign: Campaign, workers: int, records: TrialRecords, done: NDArray[np.bool_]
) -> Generator[tuple[int, int], None, None]:
    """Compute the trials that are not done, in blocks on threads.

    Parameters
    ----------
    campaign : Campaign
        To be computed.
    workers : int
        Number of threads.
    records : TrialRecords
        Of all trials; those of a block are filled in when it is yielded.
    done : array of bool, shape (trials,)
        Trials that need not be computed.

    Yields
    ------
    (int, int)
        First trial and number of trials of a block that has ended.
    """
    with ThreadPoolExecutor(workers) as pool:
        waiting = [
            pool.submit(_compute_into, campaign, first, records)
            for first in range(0, campaign.trials, BLOCK)
            if not done[first : first + BLOCK].all()
        ]
        try:
            for block in as_completed(waiting):
                yield block.result()
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def _compute_into(campaign: Campaign, first: int, records: TrialRecords) -> tuple[int, int]:
    number = min(BLOCK, campaign.trials - first)
    return first, fill(records, first, compute(campaign, first, number))
