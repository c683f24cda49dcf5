"""Connections to the workers of a Dask scheduler: processes of this computer, or a cluster."""

import logging
import os
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..core.ending import deaf_to_ctrl_c, put_off
from ..core.errors import AnalysisFailed, InputRefused, Problem
from ..temporary import TemporaryFolder
from .executors import number_of_workers

if TYPE_CHECKING:
    from distributed import Client, LocalCluster, Security

GONE = "the scheduler or its last worker is gone"
"""Reason for which what is computed by the workers of a scheduler does not go on."""
LOCAL = "local"
"""Name of the scheduler that is started with its workers, and ends with the work."""
CONNECT_TIMEOUT = 5.0
"""Time (s) after which a scheduler counts as unreachable, and one without workers as useless."""
_NO_PAGES: Mapping[str, Any] = {
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.nanny.http.routes": [],
}
"""Settings of Dask with which its web servers show nothing."""


class ClusterFailed(AnalysisFailed):
    """Workers of a scheduler could not begin, or could not go on."""


@dataclass(frozen=True)
class Certificates:
    """Files (PEM) with which the scheduler of a cluster knows its users, and they know it.

    Attributes
    ----------
    authority : str or Path
        Certificate of the authority that has signed those of the cluster.
    certificate, key : str or Path
        Of this user.
    """

    authority: str | Path
    certificate: str | Path
    key: str | Path

    def as_data(self) -> dict[str, str]:
        """Return the files as absolute paths."""
        return {name: str(Path(file).absolute()) for name, file in vars(self).items()}


@contextmanager
def connected(
    scheduler: str, workers: int | None, certificates: Certificates | None = None
) -> "Iterator[Client]":
    """Connect to the workers of a Dask scheduler.

    Parameters
    ----------
    scheduler : str
        ``local`` for one that is started here, or the address of a running one.
    workers : int or None
        Number of processes of the local scheduler, by default one for each core.
    certificates : Certificates, optional
        For a scheduler at an address ``tls://HOST:PORT``.

    Yields
    ------
    distributed.Client
        There until the block ends.

    Raises
    ------
    InputRefused
        An address that is none, a scheduler that does not answer or has no workers, or no Dask.
    ClusterFailed
        Scheduler and workers cannot be started.
    """
    _check(scheduler, workers, certificates)
    _silence()
    with _local(workers) if scheduler == LOCAL else _running(scheduler, certificates) as client:
        yield client


def _silence() -> None:
    """Let Dask say nothing: what matters is raised in our own words.

    It gives some of its loggers levels of their own when it is imported.
    """
    import distributed  # noqa: F401

    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)


def _check(scheduler: str, workers: int | None, certificates: Certificates | None) -> None:
    number_of_workers(workers)
    where = f"scheduler {scheduler}"
    problems = list(_certificate_problems(scheduler, certificates))
    if find_spec("distributed") is None:
        remedy = 'install it: pip install "rockshed[cluster]"'
        problems.append(Problem(where, "needs the package distributed", remedy))
    if scheduler != LOCAL and "://" not in scheduler:
        remedy = f"write {LOCAL}, or tcp://HOST:PORT of a running scheduler"
        problems.append(Problem(where, "is no address", remedy))
    if scheduler != LOCAL and workers is not None:
        text = "a running scheduler has its own workers"
        problems.append(Problem("workers", text, "leave it out"))
    if problems:
        raise InputRefused(problems)


def _certificate_problems(scheduler: str, certificates: Certificates | None) -> Iterator[Problem]:
    """Yield the certificates that are missing, or have no use."""
    if scheduler == LOCAL and find_spec("cryptography") is None:
        remedy = 'install it: pip install "rockshed[cluster]"'
        text = "needs the package cryptography: nobody else may reach its processes"
        yield Problem(f"scheduler {LOCAL}", text, remedy)
    is_secure = scheduler.startswith("tls://")
    if certificates is None:
        if is_secure:
            remedy = "give the files with certificates=..."
            yield Problem(f"scheduler {scheduler}", "needs certificates", remedy)
        return
    if not is_secure:
        text = "are for a scheduler at an address tls://HOST:PORT"
        yield Problem("certificates", text, "leave them out, or correct the address")
    for name, file in vars(certificates).items():
        if not os.path.isfile(file):
            yield Problem(f"certificates: {name}", f"there is no file {file}", "correct the path")


@contextmanager
def _local(workers: int | None) -> "Iterator[Client]":
    """Start a scheduler with worker processes of one thread each; dead ones are replaced.

    Who can hand a task to a scheduler runs code as its user. This one and its workers talk TLS,
    with a certificate that is made here, is in their memory only, and is asked of everybody who
    connects; their web servers have no pages.
    """
    import dask
    from distributed import Client, Security

    security = Security.temporary()
    with ExitStack() as opened:
        folder = str(opened.enter_context(TemporaryFolder("rockshed-dask-")))
        opened.enter_context(dask.config.set({**_NO_PAGES, "temporary-directory": folder}))
        with put_off(), deaf_to_ctrl_c():
            cluster = opened.enter_context(_closing(_started(workers, folder, security)))
        yield opened.enter_context(Client(cluster, direct_to_workers=True, security=security))


def _started(workers: int | None, folder: str, security: "Security") -> "LocalCluster":
    """Start scheduler and workers.

    Raises
    ------
    ClusterFailed
        They cannot be started, for instance because the disk is full.
    """
    from distributed import LocalCluster

    try:
        return LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            memory_limit=0,
            dashboard_address="127.0.0.1:0",
            scheduler_kwargs={"dashboard": False},
            silence_logs=logging.CRITICAL,
            local_directory=folder,
            security=security,
            protocol="tls://",
        )
    except (OSError, RuntimeError) as error:
        text = f"scheduler and workers cannot be started: {_first_line(error)}"
        raise ClusterFailed(text) from error


@contextmanager
def _closing(cluster: "LocalCluster") -> Iterator["LocalCluster"]:
    """Close a cluster at the end, also one that has lost a worker meanwhile.

    Dask strikes off such a worker a second time while it closes, and stumbles over that at its end.
    """
    try:
        yield cluster
    finally:
        with suppress(KeyError):
            cluster.close()


@contextmanager
def _running(address: str, certificates: Certificates | None) -> "Iterator[Client]":
    """Connect to a running scheduler that has workers."""
    from distributed import Client

    where = f"scheduler {address}"
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT, security=_security(certificates))
    except Exception as error:  # a server that is no scheduler may end this in anything
        text = f"no scheduler answers there within {CONNECT_TIMEOUT:g} s ({_first_line(error)})"
        remedy = "start it with `dask scheduler`, correct the address, or take local"
        raise InputRefused([Problem(where, text, remedy)]) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECT_TIMEOUT)
        except TimeoutError as error:
            remedy = f"start some: `dask worker {address}`"
            raise InputRefused([Problem(where, "the scheduler has no workers", remedy)]) from error
        yield client


def _security(certificates: Certificates | None) -> Any:
    """Return the certificates as Dask takes them; None for a scheduler without."""
    from distributed import Security

    if certificates is None:
        return None
    return Security(
        require_encryption=True,
        tls_ca_file=str(certificates.authority),
        tls_client_cert=str(certificates.certificate),
        tls_client_key=str(certificates.key),
    )


def _first_line(error: Exception) -> str:
    """Return the reason of an error, as far as it says something to a person."""
    if isinstance(error, MemoryError):  # the answer was read as the length of a message
        return "what answers is no Dask scheduler"
    return (str(error).splitlines() or [type(error).__name__])[0]
