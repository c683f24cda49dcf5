"""The command ``rockshed resume``: a run that was ended goes on from its last checkpoints."""

from pathlib import Path
from typing import Annotated

import typer

from ..core.errors import RunFailed
from ..core.supervisor import announce
from ..runs.continuing import resume, stopped_at
from ..runs.run import Run
from .analysis import options_named
from .options import Json, NoFigures, Quiet, Strict
from .run import show_run
from .screen import Screen, opened
from .streams import stdout_for_results

_StoppedRun = Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")]


def command(
    run: _StoppedRun,
    strict: Strict = False,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Let a run that was ended go on from its last checkpoints.

    The results are those of a run that nothing has ended, to the bit.
    """
    announce(quiet=quiet, as_json=as_json, figures=not no_figures)
    with opened(quiet, as_json) as screen:
        with stdout_for_results(), options_named(("checkpoint_every",)):
            done = _resumed(run, screen)
        show_run(done, screen, not no_figures, strict)


def _resumed(folder: Path, screen: Screen) -> Run:
    """Let a run go on; one that fails or is interrupted gives what was computed until then."""
    stopped = stopped_at(folder)
    if stopped is not None:
        begun = stopped.run.time[stopped.base.rows - 1]
        screen.note(f"goes on from t = {1e3 * begun:g} ms")
    with screen.progress("preparing") as progress:
        try:
            done = resume(folder, progress=progress)
        except RunFailed as failure:
            done = failure.run
    if stopped is None:
        screen.note("the run is complete: nothing is left to do")
    return done
