"""The command ``rockshed verify``: a run is run again, and every bit is compared."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..core.ending import true_cause
from ..core.errors import InputRefused
from ..core.supervisor import announce
from ..runs.verification import Verification, verify
from .options import Json, Quiet
from .screen import CHECK_FAILED, INTERRUPTED, Screen, opened
from .streams import stdout_for_results

_CompleteRun = Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a complete run.")]


def command(run: _CompleteRun, as_json: Json = False, quiet: Quiet = False) -> None:
    """Run a run again and compare every bit of its results.

    Ends with exit code 3 where one differs, and says which.
    """
    announce(quiet=quiet, as_json=as_json)
    with opened(quiet, as_json) as screen:
        try:
            with (
                true_cause(InputRefused, OSError),
                stdout_for_results(),
                screen.progress("preparing") as progress,
            ):
                found = verify(run, progress=progress)
        except KeyboardInterrupt:
            screen.warn("interrupted: nothing has been compared")
            raise typer.Exit(INTERRUPTED) from None
        _show(found, screen)


def _show(found: Verification, screen: Screen) -> None:
    """Show what was found; a difference gives its exit code."""
    if screen.as_json:
        difference = asdict(found.difference) if found.difference is not None else None
        told = {"folder": str(found.run.folder), "same": bool(found), **found.counts}
        screen.dump({**told, "difference": difference})
    elif found:
        screen.say(str(found))
    if not found:
        screen.fail(str(found))
        raise typer.Exit(CHECK_FAILED)
