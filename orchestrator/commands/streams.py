"""Output of FMUs and leftovers of killed runs, which come beside the results of a command."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from pathlib import Path

from ..core.results.checkpoints import known_checkpoints
from ..core.results.run_folder import leftovers
from .screen import Screen


@contextmanager
def stdout_for_results() -> Iterator[None]:
    """Keep stdout for the results of the command: what FMUs print meanwhile goes to stderr."""
    try:
        sys.stdout.flush()
        kept = os.dup(1)
        os.dup2(2, 1)
    except OSError:  # there are no such streams
        yield
        return
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        with suppress(OSError, AttributeError, TypeError):  # Windows has no such library
            ctypes.CDLL(None).fflush(None)
        os.dup2(kept, 1)
        os.close(kept)


def tell_leftovers(folder: Path, screen: Screen) -> None:
    """Say that killed runs have left something beside the folder of the results.

    Parameters
    ----------
    folder : Path
        Of the results.
    screen : Screen
        Of the command.
    """
    for left in leftovers(Path(os.path.realpath(folder))):
        screen.warn(
            f"a run that did not end has left {left}; it is kept until this one is complete, and "
            f"`rockshed plot {folder}` draws what it has{_or_resumed(left, folder)}"
        )


def _or_resumed(left: Path, folder: Path) -> str:
    """Say how a run goes on that has left checkpoints; nothing of one without."""
    if not known_checkpoints(left):
        return ""
    return f"; `rockshed resume {folder}` would go on with it"
