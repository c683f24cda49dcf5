"""Price of a rockfall trial on one core: a slope of 15 cells and 100 m height with three search lines; and a campaign on Dask."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter, thread_time

from ..rockfall.campaign import Campaign, Done, Records, compute
from ..rockfall.preparation import prepare
from .interleave import Contestant

SITE = Path(__file__).with_name("slope15.toml")
TRIALS = 20_000
"""In one measurement."""
PEER_TRIALS = 1_000
_PEER = Path(__file__).with_name("pyrockfall_peer.py")
CAMPAIGN = 1_000_000
"""Trials of the campaign on Dask."""


def own_kernel() -> Contestant:
    """Trials of the event-driven kernel on this thread; its CPU time (s)."""
    given = prepare(SITE, trials=TRIALS).campaign

    def work() -> float:
        began = thread_time()
        compute(given, 0, TRIALS)
        return thread_time() - began

    return work


class PyrockfallPeer:
    """pyrockfall in a process of its own, which takes its CPU time."""

    def __init__(self) -> None:
        self._process = subprocess.Popen([sys.executable, str(_PEER)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                         stderr=subprocess.DEVNULL, text=True)

    def contestant(self) -> Contestant:
        """So many trials of its own model on the same profile."""
        def work() -> float:
            assert self._process.stdin is not None
            assert self._process.stdout is not None
            self._process.stdin.write(f"{PEER_TRIALS}\n")
            self._process.stdin.flush()
            return float(self._process.stdout.readline())

        return work

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(10.0)


def pyrockfall_available() -> bool:
    """Whether pyrockfall runs here."""
    return subprocess.run([sys.executable, str(_PEER), "probe"], capture_output=True, check=False).returncode == 0


def dask_available() -> bool:
    """Whether the extra ``cluster`` is installed."""
    return find_spec("distributed") is not None


@contextmanager
def dask_campaigns() -> Iterator[dict[str, Contestant]]:
    """The campaign on one and on two local workers, which are there already; wall time (s) until all records are here."""
    from ..rockfall.cluster import dask_workers

    given = prepare(SITE, trials=CAMPAIGN).campaign
    with ExitStack() as running:
        crews = {f"{count} workers": running.enter_context(dask_workers("local", count)) for count in (1, 2)}
        yield {name: partial(_timed, crew.run, given) for name, crew in crews.items()}


def _timed(run: Callable[[Campaign, Done], Records], given: Campaign) -> float:
    began = perf_counter()
    run(given, lambda count, total: None)
    return perf_counter() - began
