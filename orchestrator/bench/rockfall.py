"""Price of a rockfall trial on one core, and of a campaign on Dask.

The slope has 15 cells, 100 m height and three search lines.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter, thread_time

from ..analyses.frame import Count
from ..campaigns.campaign import Campaign, TrialRecords, campaign_of, compute
from ..sites.rockfall.preparation import prepare
from .interleave import Contestant

SITE = Path(__file__).with_name("slope15.toml")
TRIALS = 20_000
"""Trials in one measurement."""
PEER_TRIALS = 1_000
"""Trials in one measurement of pyrockfall."""
PYROCKFALL = (str(Path(__file__).with_name("pyrockfall_peer.py")),)
"""pyrockfall as a :class:`~.peer.Peer`: CPU time for so many trials of its own model on the same
profile."""
CAMPAIGN = 1_000_000
"""Trials of the campaign on Dask."""


def own_kernel() -> Contestant:
    """Return trials of the event-driven kernel on this thread as a contestant, in CPU time (s)."""
    given = campaign_of(prepare(SITE, trials=TRIALS))

    def work() -> float:
        began = thread_time()
        compute(given, 0, TRIALS)
        return thread_time() - began

    return work


def dask_available() -> bool:
    """Tell whether the extra ``cluster`` is installed."""
    return find_spec("distributed") is not None


@contextmanager
def dask_campaigns() -> Iterator[dict[str, Contestant]]:
    """Start one and two local workers; yield the campaign on them, in wall time (s)."""
    from ..analyses.rockfall.cluster import dask_workers

    given = campaign_of(prepare(SITE, trials=CAMPAIGN))
    with ExitStack() as running:
        executors = {
            f"{count} workers": running.enter_context(dask_workers("local", count))
            for count in (1, 2)
        }
        yield {name: partial(_timed, executor.run, given) for name, executor in executors.items()}


def _timed(run: Callable[[Campaign, Count], TrialRecords], given: Campaign) -> float:
    began = perf_counter()
    run(given, lambda count, total: None)
    return perf_counter() - began
