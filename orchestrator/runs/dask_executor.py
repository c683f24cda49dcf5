"""The workers of a Dask scheduler as an executor of runs."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .cluster import GONE, Certificates, ClusterFailed, connected
from .executors import Crew, Lost, Work
from .kept import program_stamp

if TYPE_CHECKING:
    from distributed import Client

_AHEAD = 4
"""Pieces of work for each worker that the scheduler has; it need not hold all of them."""


class DaskWorkers:
    """The workers of a connected scheduler; dead ones are replaced, or others do their work.

    Parameters
    ----------
    client : distributed.Client
        Of the scheduler.
    scheduler : str
        Its address, or ``local``.
    """

    def __init__(self, client: "Client", scheduler: str) -> None:
        self._client = client
        self.facts: Mapping[str, Any] = {"workers": self._workers, "scheduler": scheduler}

    @property
    def _workers(self) -> int:
        return sum(self._client.nthreads().values())

    def each(self, work: Work, items: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield the number of each item and its result, in the order in which they come.

        Raises
        ------
        ClusterFailed
            The scheduler has died, or a worker has another version of this program.
        """
        from distributed import as_completed

        stamp = program_stamp()
        waiting = iter(enumerate(items))
        begun: dict[Any, int] = {}
        pieces = as_completed()

        def submit() -> None:
            found = next(waiting, None)
            if found is not None:
                piece = self._client.submit(_done_by_same, work, found[1], stamp, pure=False)
                begun[piece] = found[0]
                pieces.add(piece)

        with _failing():
            for _ in range(_AHEAD * max(1, self._workers)):
                submit()
            for piece in pieces:
                yield begun.pop(piece), _result(piece)
                piece.release()
                submit()


@contextmanager
def dask(
    scheduler: str, workers: int | None, certificates: Certificates | None = None
) -> Iterator[Crew]:
    """Open the workers of a Dask scheduler as an executor.

    Parameters
    ----------
    scheduler : str
        ``local``, or the address of a running one, whose workers see the same files.
    workers : int or None
        Number of processes of the local scheduler.
    certificates : Certificates, optional
        For a scheduler at an address ``tls://HOST:PORT``.

    Yields
    ------
    Crew
        There until the block ends.
    """
    with connected(scheduler, workers, certificates) as client:
        yield DaskWorkers(client, scheduler)


class _OtherVersion(Exception):  # noqa: N818 (it is a state of a worker)
    """A worker has another version of this program."""


def _done_by_same(work: Work, item: Any, stamp: str) -> Any:
    """Do a piece of work by the same program as the client's."""
    if program_stamp() != stamp:
        raise _OtherVersion("a worker has another version of rockshed: install the same one")
    return work(item)


def _result(piece: Any) -> Any:
    from distributed import KilledWorker

    try:
        return piece.result()
    except KilledWorker:
        return Lost()


@contextmanager
def _failing() -> Iterator[None]:
    """Say what has ended the work on a scheduler, unless the work itself says so."""
    from concurrent.futures import CancelledError

    try:
        yield
    except (_OtherVersion, ImportError) as error:
        raise ClusterFailed(f"a worker failed: {error}") from error
    except (CancelledError, OSError, TimeoutError) as error:
        text = f"{GONE}; what has ended is kept: run it again"
        raise ClusterFailed(text) from error
