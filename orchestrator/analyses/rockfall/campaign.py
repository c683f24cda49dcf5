"""A campaign: what all trials have in common, and the trials, in blocks on several threads.

A block is a function of the campaign and the numbers of its trials alone: whoever computes it, the bits are the same.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.component import Instance
from rockshed.components.slope_rockfall.declarations import BODY
from rockshed.components.slope_rockfall.trajectory import OUTCOME, PASSAGE, PEAK, trials

Floats = NDArray[np.float64]
Done = Callable[[int, int], None]
"""Told the number of trials done, and of all."""


class CampaignFailed(Exception):  # noqa: N818 (as RunFailed)
    """A campaign began and could not go on."""


BLOCK = 500
"""Trials in a block: some milliseconds, after which Ctrl-C is heard."""


@dataclass(frozen=True)
class Campaign:
    """Buffers of an initialised SlopeRockfall, and what is kept of its trials.

    left, right: x (m) at which a trial ends. lines: (n, 4), search lines and after them barriers (m). barriers: (n, 2), see
    :class:`rockshed.components.slope_rockfall.trajectory.Barrier`. stations: (m,), x (m), evenly spaced. names: of the lines.
    """

    seed: int
    trials: int
    w: Floats
    x: Floats
    k: NDArray[np.int64]
    left: float
    right: float
    lines: Floats
    barriers: Floats
    stations: Floats
    names: Sequence[str]

    @property
    def bytes_per_trial(self) -> int:
        """Memory (bytes) for the records of a trial."""
        return (
            8 * len(OUTCOME)
            + 8 * len(PASSAGE) * len(self.lines)
            + 4 * len(PEAK) * len(self.stations)
        )


def campaign(
    instance: Instance,
    seed: int,
    count: int,
    left: float,
    right: float,
    lines: Floats,
    barriers: Floats,
    stations: Floats,
    names: Sequence[str],
) -> Campaign:
    """A campaign with the parameters of an initialised instance."""
    return Campaign(
        seed,
        count,
        instance.w.copy(),
        instance.x.copy(),
        instance.k.copy(),
        left,
        right,
        lines,
        barriers,
        stations,
        tuple(names),
    )


@dataclass(frozen=True)
class Records:
    """What is kept of n trials: passages (n, lines, len(PASSAGE)), peaks (n, stations, len(PEAK)), outcomes (n, len(OUTCOME)).

    Peaks have half the digits: there are many of them, and only their percentiles are wanted.
    """

    passages: Floats
    peaks: NDArray[np.float32]
    outcomes: Floats


def empty_records(given: Campaign, count: int) -> Records:
    """Records of so many trials, not yet filled."""
    return Records(
        np.empty((count, len(given.lines), len(PASSAGE))),
        np.empty((count, len(given.stations), len(PEAK)), np.float32),
        np.empty((count, len(OUTCOME))),
    )


def compute(given: Campaign, first: int, count: int) -> Records:
    """Trials ``first`` ... ``first + count - 1``."""
    made = empty_records(given, count)
    peaks = np.empty(made.peaks.shape)
    distance = float(given.stations[1] - given.stations[0])
    trials(
        given.seed,
        first,
        given.left,
        given.right,
        given.lines,
        given.barriers,
        float(given.stations[0]),
        distance,
        given.w,
        given.x,
        given.k,
        np.zeros(len(BODY)),
        made.passages,
        peaks,
        made.outcomes,
    )
    made.peaks[:] = peaks
    return made


def fill(made: Records, first: int, block: Records) -> int:
    """Put the records of a block of trials, the first of which is number ``first``, where they belong; returns their number."""
    count = len(block.outcomes)
    rows = slice(first, first + count)
    made.passages[rows], made.peaks[rows], made.outcomes[rows] = (
        block.passages,
        block.peaks,
        block.outcomes,
    )
    return count


@dataclass(frozen=True)
class Crew:
    """Who computes the trials. run: all of a campaign; facts: what ``run.json`` says of it."""

    run: Callable[[Campaign, Done], Records]
    facts: Mapping[str, Any]


@contextmanager
def threads(workers: int) -> Iterator[Crew]:
    """So many threads of this process."""
    yield Crew(lambda given, done: run(given, workers, done), {"workers": workers})


def run(given: Campaign, workers: int, done: Done = lambda count, total: None) -> Records:
    """All trials of a campaign, on so many threads."""
    made = empty_records(given, given.trials)
    with ThreadPoolExecutor(workers) as pool:
        waiting = [
            pool.submit(_compute_into, given, start, min(BLOCK, given.trials - start), made)
            for start in range(0, given.trials, BLOCK)
        ]
        try:
            finished = 0
            for block in as_completed(waiting):
                finished += block.result()
                done(finished, given.trials)
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return made


def _compute_into(given: Campaign, first: int, count: int, made: Records) -> int:
    return fill(made, first, compute(given, first, count))
