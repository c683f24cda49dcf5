"""The command ``rockshed animate``: rock, sand and beam of a run over time."""

from pathlib import Path
from typing import Annotated

import typer

from ..runs.run import read_run
from .analysis import in_options, options_named
from .options import Json, Quiet
from .screen import opened

_Folder = Annotated[
    Path, typer.Argument(metavar="RUN", help="Folder of a run with recorded states of sand.")
]
_Output = Annotated[
    Path | None,
    typer.Option(
        "--output",
        metavar="FILE.mp4|FILE.gif",
        help="Default: animation.mp4 in RUN/figures, or a GIF file where MP4 cannot be written.",
    ),
]

_OPTIONS = ("state_interval",)
"""Arguments of the library that are options of ``rockshed run``."""


def command(
    run: _Folder, output: _Output = None, as_json: Json = False, quiet: Quiet = False
) -> None:
    """Animate rock, sand with its force chains, and beam of a run."""
    from ..pictures.sand_animation import is_coarse  # imports matplotlib

    with opened(quiet, as_json) as screen, options_named(_OPTIONS):
        found = read_run(run)
        if advice := is_coarse(found):
            screen.note(in_options(advice, _OPTIONS))
        with screen.counting("frames") as count:
            file = found.animate(output, progress=count)
        if as_json:
            screen.dump({"animation": str(file)})
        else:
            screen.say(str(file))
