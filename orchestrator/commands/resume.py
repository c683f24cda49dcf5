"""The command ``rockshed resume``: what was ended goes on."""

from pathlib import Path
from typing import Annotated

import typer

from ..analyses.asked import Asked, find_asked
from ..analyses.resuming import go_on
from ..core.errors import RunFailed, counted
from ..core.results.reading import undamaged
from ..core.supervisor import announce
from ..runs.continuing import resume, stopped_at
from ..runs.run import Run
from .analysis import kept_if_ended, options_named, show, stages
from .options import Json, NoFigures, Quiet, Strict
from .run import show_run
from .screen import CHECK_FAILED, Screen, opened
from .streams import stdout_for_results

REPRODUCTION = "reproduction"
"""Kind of what is asked for by `rockshed reproduce`."""
_StoppedRun = Annotated[
    Path, typer.Argument(metavar="RUN", help="Folder of a run, or of an analysis.")
]


def command(
    run: _StoppedRun,
    strict: Strict = False,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Let a run or an analysis that was ended go on.

    The results are those of one that nothing has ended, to the bit.
    """
    with opened(quiet, as_json) as screen:
        asked = find_asked(run)
        if asked is not None and asked.kind == REPRODUCTION:
            _show_reproduction(asked, screen)
            return
        if asked is not None:
            _show_analysis(asked, screen, not no_figures, strict)
            return
        announce(quiet=quiet, as_json=as_json, figures=not no_figures)
        with stdout_for_results(), options_named(("checkpoint_every",)):
            done = _resumed(run, screen)
        show_run(done, screen, not no_figures, strict)


def _show_reproduction(asked: Asked, screen: Screen) -> None:
    """Let a reproduction go on, and show it."""
    from .reproduce import show_reproduction  # the papers are needed for nothing else

    screen.note(f"a {asked.kind} goes on")
    with undamaged(asked.file):
        given = {key: asked.arguments[key] for key in ("paper", "only", "quick")}
        workers = asked.arguments["workers"]
    show_reproduction(given, asked.folder, workers, screen)


def _show_analysis(asked: Asked, screen: Screen, with_figures: bool, strict: bool) -> None:
    """Let an analysis go on, and show its result."""
    article = "an" if asked.kind[0] in "aeiou" else "a"
    screen.note(f"{article} {asked.kind} goes on")
    pictures = None if with_figures else False
    with kept_if_ended(screen, asked.folder), stages(screen) as progress:
        result = go_on(asked, pictures=pictures, progress=progress, note=screen.note)
    show(screen, result)
    if strict and result.warnings:
        screen.fail(f"strict: the result has {counted(len(result.warnings), 'warning')}")
        raise typer.Exit(CHECK_FAILED)


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
