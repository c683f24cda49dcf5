"""The report of a run whose process was ended by the code of an FMU."""

from pathlib import Path

from ..core.loop.journal import last_entry
from ..core.results.run_folder import keep_crashed, running_folder
from .screen import RUN_FAILED, opened


def report_crash(folder: Path | None, reason: str) -> int:
    """Say which component has crashed, and keep what was computed.

    Parameters
    ----------
    folder : Path or None
        Folder of the results, if the run had come so far.
    reason : str
        Name of the signal that ended the process.

    Returns
    -------
    int
        Exit code of the command.
    """
    with opened() as screen:
        if folder is None or not running_folder(folder).is_dir():
            screen.fail(f"the command crashed ({reason})")
            return RUN_FAILED
        error = last_entry(running_folder(folder), reason)
        kept = keep_crashed(folder, error, warnings=[])
        screen.fail(error)
        screen.say(f"results in {folder}" if kept else "nothing was computed")
    return RUN_FAILED
