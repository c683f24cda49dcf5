"""The command ``rockshed plot``: pictures of a run, drawn again."""

from pathlib import Path
from typing import Annotated

import typer

from ..analyses.saved import saved_result
from ..core.errors import InputRefused, Problem
from ..core.results.run_folder import running_folder
from ..runs.run import read_run
from .analysis import options_named, stages
from .drawing import draw
from .options import Quiet
from .screen import opened

_Folder = Annotated[
    Path,
    typer.Argument(
        metavar="RUN", help="Folder of a run, finished or not, or of `rockfall` or `pile`."
    ),
]
_Pictures = Annotated[
    Path | None, typer.Option(help="Folder of the pictures; default RUN/figures.")
]


def command(run: _Folder, output_dir: _Pictures = None, quiet: Quiet = False) -> None:
    """Draw a run again, also one that failed or was killed."""
    with opened(quiet) as screen, options_named(("folder",)):
        result = saved_result(run)
        if result is not None:
            with stages(screen) as progress:
                files = result.write_pictures(output_dir or run / "figures", progress)
            for file in files:
                screen.say(str(file))
            return
        found = read_run(run)
        if found.folder.absolute() == run.absolute() and running_folder(run.absolute()).exists():
            screen.warn(f"there is a newer run that has not ended, in {running_folder(run)}")
        if not found.time.size:
            reason = "the run was ended before its first row was written"
            raise InputRefused([Problem(str(found.folder), reason, "run it again")])
        if found.status != "complete":
            screen.warn(
                f"this run is not complete ({found.status}): pictures show what was computed until "
                f"t = {1e3 * found.time[-1]:g} ms"
            )
        for file in draw(found, output_dir or found.folder / "figures", screen):
            screen.say(str(file))
