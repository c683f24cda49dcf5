"""Price of a rockfall trial on one core: a slope of 15 cells and 100 m height with three search lines; and a campaign on Dask."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter, thread_time

from ..analyses.frame import Count
from ..analyses.rockfall.campaign import Campaign, TrialRecords, campaign_of, compute
from ..sites.rockfall.preparation import prepare
from .interleave import Contestant

SITE = Path(__file__).with_name("slope15.toml")
TRIALS = 20_000
"""In one measurement."""
PEER_TRIALS = 1_000
PYROCKFALL = (str(Path(__file__).with_name("pyrockfall_peer.py")),)
"""pyrockfall as a :class:`~.peer.Peer`, which takes its CPU time for so many trials of its own model on the same profile."""
CAMPAIGN = 1_000_000
"""Trials of the campaign on Dask."""


def own_kernel() -> Contestant:
    """Trials of the event-driven kernel on this thread; its CPU time (s)."""
    given = campaign_of(prepare(SITE, trials=TRIALS))

    def work() -> float:
        began = thread_time()
        compute(given, 0, TRIALS)
        return thread_time() - began

    return work


def dask_available() -> bool:
    """Whether the extra ``cluster`` is installed."""
    return find_spec("distributed") is not None


@contextmanager
def dask_campaigns() -> Iterator[dict[str, Contestant]]:
    """The campaign on one and on two local workers, which are there already; wall time (s) until all records are here."""
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
