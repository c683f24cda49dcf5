"""Options of commands that compute on the workers of a Dask scheduler."""

from pathlib import Path
from typing import Annotated

import typer

from ..core.errors import InputRefused, Problem
from ..runs.cluster import Certificates

Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="local|tls://HOST:PORT|tcp://HOST:PORT",
        help="Compute on Dask: on processes of this computer, or on the workers of a running "
        "scheduler. Whoever reaches a scheduler without certificates (tcp) runs programs on it.",
    ),
]
Authority = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Certificate of a cluster's authority (PEM).")
]
Certificate = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Your certificate for a cluster (PEM).")
]
PrivateKey = Annotated[
    Path | None, typer.Option(metavar="FILE", help="The key that belongs to it.")
]


def certificates_of(
    authority: Path | None, certificate: Path | None, key: Path | None
) -> Certificates | None:
    """Return the certificates of a cluster; all three files belong together.

    Parameters
    ----------
    authority, certificate, key : Path, optional
        Files of the options.

    Returns
    -------
    Certificates or None
        None where no option is given.

    Raises
    ------
    InputRefused
        Some of them are missing.
    """
    given = {"--tls-ca": authority, "--tls-cert": certificate, "--tls-key": key}
    if authority and certificate and key:
        return Certificates(authority, certificate, key)
    missing = [option for option, file in given.items() if file is None]
    if len(missing) == len(given):
        return None
    remedy = f"give {', '.join(given)} together"
    raise InputRefused([Problem(option, "is missing", remedy) for option in missing])
