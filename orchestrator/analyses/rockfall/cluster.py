"""A campaign on the workers of a Dask scheduler: processes of this computer, or a cluster.

A task is a block of trials. Its records come back as arrays and are put where they belong, so nothing depends on who computed a
block, or when. A block whose worker dies is computed again by another.
"""

import logging
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from multiprocessing import resource_tracker
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from rockshed.components.common.kernels import source_stamp

from ...core.errors import InputRefused, Problem
from .campaign import Campaign, CampaignFailed, Crew, Done, Records, compute, empty_records, fill

if TYPE_CHECKING:
    from distributed import Client

LOCAL = "local"
"""The scheduler that is started with its workers, and ends with the campaign."""
FEWEST, MOST = 1000, 20_000
"""Trials in a task: at most some 0.2 s, against the millisecond or so that Dask needs for a task."""
MOST_BYTES = 64 << 20
"""Of the records of a task."""
TASKS = 8
"""For each worker, so that all end at about the same time, as long as that makes no task too small."""
RETRIES = 2
"""Times that a block is computed again after an error of its worker. Death of a worker does not count."""
CONNECT_TIMEOUT = 5.0
"""Seconds after which a scheduler counts as unreachable, and one without workers as useless."""
_COMPONENT = "slope_rockfall"


@contextmanager
def dask_workers(scheduler: str, workers: int | None) -> Iterator[Crew]:
    """The workers of a Dask scheduler: so many processes of one started here, or by default one for each core; or of a running one.

    Raises:
        InputRefused: an address that is none, a scheduler that does not answer or has no workers, or no Dask here.
    """
    _check(scheduler, workers)
    logging.getLogger("distributed").setLevel(
        logging.CRITICAL
    )  # what matters of it is said in our own words
    with _local(workers) if scheduler == LOCAL else _running(scheduler) as client:
        count = sum(client.nthreads().values())
        yield Crew(
            lambda given, done: _run(client, given, done),
            {"workers": count, "scheduler": scheduler},
        )


def _check(scheduler: str, workers: int | None) -> None:
    problems = []
    option = f"--scheduler {scheduler}"
    if find_spec("distributed") is None:
        problems.append(
            Problem(
                option,
                "needs the package distributed",
                'install it: pip install "rockshed[cluster]"',
            )
        )
    if scheduler != LOCAL and "://" not in scheduler:
        problems.append(
            Problem(
                option, "is no address", f"write {LOCAL}, or tcp://HOST:PORT of a running scheduler"
            )
        )
    if scheduler != LOCAL and workers is not None:
        problems.append(
            Problem("--workers", "a running scheduler has its own workers", "leave it out")
        )
    if problems:
        raise InputRefused(problems)


@contextmanager
def _local(workers: int | None) -> "Iterator[Client]":
    """A scheduler of our own, with worker processes of one thread each; a worker that dies is started again."""
    from distributed import Client, LocalCluster

    with TemporaryDirectory(prefix="rockshed-dask-") as folder:
        with _deaf_to_ctrl_c():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
                local_directory=folder,
            )
        with cluster, Client(cluster, direct_to_workers=True) as client:
            yield client


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Threads that begin meanwhile, and the processes that they ever start, do not hear Ctrl-C; this thread hears it afterwards.

    A terminal tells Ctrl-C to all processes. It is for this one, which ends the others.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # multiprocessing starts it with its first process, and unblocks SIGINT then
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _running(address: str) -> "Iterator[Client]":
    """A client of a running scheduler that has workers."""
    from distributed import Client

    where = f"--scheduler {address}"
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT)
    except Exception as error:  # what something else than a scheduler answers may end in anything
        raise InputRefused(
            [
                Problem(
                    where,
                    f"no scheduler answers there within {CONNECT_TIMEOUT:g} s ({_first_line(error)})",
                    "start it with `dask scheduler`, correct the address, or take --scheduler local",
                )
            ]
        ) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECT_TIMEOUT)
        except TimeoutError as error:
            raise InputRefused(
                [
                    Problem(
                        where,
                        "the scheduler has no workers",
                        f"start some: `dask worker {address}`",
                    )
                ]
            ) from error
        yield client


def _first_line(error: Exception) -> str:
    """What went wrong, as far as it says something to a person."""
    if isinstance(
        error, MemoryError
    ):  # it has taken what something else answers for the length of a message
        return "what answers is no Dask scheduler"
    return (str(error).splitlines() or [type(error).__name__])[0]


# --- the campaign ---


def _run(client: "Client", given: Campaign, done: Done) -> Records:
    """All trials of a campaign."""
    from distributed import as_completed

    made = empty_records(given, given.trials)
    # a task that gives the campaign, and no scattered data: where all workers that have it die, it is made again
    common = client.submit(_itself, given, pure=False)
    size = _block_size(given, sum(client.nthreads().values()))
    first = {
        client.submit(
            _block,
            common,
            start,
            min(size, given.trials - start),
            source_stamp(_COMPONENT),
            pure=False,
            retries=RETRIES,
        ): start
        for start in range(0, given.trials, size)
    }
    finished = 0
    for block in as_completed(list(first)):
        finished += fill(made, first.pop(block), _result(block))
        block.release()
        done(finished, given.trials)
    return made


def _block_size(given: Campaign, workers: int) -> int:
    """Trials in a task of a campaign on so many workers. No result depends on it."""
    even = min(MOST, max(FEWEST, given.trials // (TASKS * max(1, workers))))
    return max(1, min(even, MOST_BYTES // given.bytes_per_trial))


def _itself(given: Campaign) -> Campaign:
    return given


def _block(given: Campaign, first: int, count: int, stamp: str) -> Records:
    """A task: consecutive trials, by the same program as the client's."""
    if source_stamp(_COMPONENT) != stamp:
        raise RuntimeError("it has another version of rockshed: install the same one")
    return compute(given, first, count)


def _result(block: Any) -> Records:
    """The records of a block that is done.

    Raises:
        CampaignFailed: no worker could compute it.
    """
    from distributed import KilledWorker

    try:
        found: Records = block.result()
    except KilledWorker as error:
        raise CampaignFailed(
            "workers died again and again while they computed the same block"
        ) from error
    except Exception as error:
        raise CampaignFailed(f"a worker failed: {type(error).__name__}: {error}") from error
    return found
