"""The report of a run whose process was ended by the code of an FMU."""

from pathlib import Path
from typing import Any

import typer

from ..core.loop.journal import FILE, LEGEND, last_entry
from ..core.results.own_files import read_data
from ..core.results.run_folder import RUN, keep_crashed, unlock
from ..core.supervisor import Ending
from ..files import write_json
from ..runs.simulation import measured
from ..temporary import sweep
from .run import show_run
from .screen import INTERRUPTED, RUN_FAILED, Screen, opened


def report_crash(ending: Ending) -> int:
    """Say which component has crashed, and keep and show what was computed.

    Parameters
    ----------
    ending : Ending
        Of the process of the run.

    Returns
    -------
    int
        Exit code of the command.
    """
    sweep()  # the FMUs that it had unpacked
    facts = ending.facts
    code = INTERRUPTED if ending.interrupted else RUN_FAILED
    try:
        with opened(facts.get("quiet", False), facts.get("as_json", False)) as screen:
            return _report(ending, screen, code)
    except typer.Exit as exit_:
        return exit_.exit_code or code


def _report(ending: Ending, screen: Screen, code: int) -> int:
    if "running" not in ending.facts:
        screen.fail(f"the command {_how(ending)}")
        return code
    folder = Path(ending.facts["folder"])
    running = Path(ending.facts["running"])
    unlock(folder)
    place = running if running.is_dir() else folder
    if not place.is_dir():  # it was a temporary one
        screen.fail(last_entry(place, ending.reason))
        return code
    error = last_entry(place, ending.reason)
    for name in (FILE, LEGEND):
        (place / name).unlink(missing_ok=True)
    status = "interrupted" if ending.interrupted else "failed"
    if place == folder:
        _add_warning(folder, error)
        screen.fail(error)
    elif not keep_crashed(folder, running, error, status, warnings=[]):
        screen.fail(error)
        screen.say("nothing was computed")
        return code
    elif ending.interrupted:
        screen.fail(error)
    show_run(measured(folder), screen, ending.facts.get("figures", False) and place == folder)
    return code


def _how(ending: Ending) -> str:
    named = ending.reason.startswith(("SIG", "exception"))
    return f"crashed ({ending.reason})" if named else ending.reason


def _add_warning(folder: Path, text: str) -> None:
    """Add a warning to a run that had ended when its process crashed."""
    content: dict[str, Any] = read_data(folder / RUN)
    if content:
        content["warnings"] = [*content.get("warnings", []), text]
        write_json(folder / RUN, content)
