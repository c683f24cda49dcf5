"""The command ``rockshed animate``: rock, sand and beam of a run over time."""

from pathlib import Path
from typing import Annotated

import typer

from ..analyses.rockfall.result import RockfallResult
from ..analyses.saved import saved_result
from ..animations.formats import animation_format
from ..campaigns.replay import check
from ..core.errors import InputRefused, Problem, all_causes, refusing_unwritable
from ..runs.run import read_run
from .analysis import options_named
from .drawing import refuse_foreign_file
from .options import Json, Quiet
from .screen import Screen, opened

_Folder = Annotated[
    Path,
    typer.Argument(
        metavar="RUN", help="Folder of a run with recorded states of sand, or of a campaign."
    ),
]
_Output = Annotated[
    Path | None,
    typer.Option(
        "--output",
        metavar="FILE.mp4|FILE.gif",
        help="Default: animation.mp4 in RUN/figures, or a GIF file where MP4 cannot be written.",
    ),
]

_Trials = Annotated[
    list[int] | None,
    typer.Option(
        metavar="NUMBER",
        help="Of the results of `rockfall`: this trial, from what is stored. May be repeated.",
    ),
]

_OPTIONS = ("state_interval", "trial")
"""Arguments of the library that are options of ``rockshed run``."""


def command(
    run: _Folder,
    trial: _Trials = None,
    output: _Output = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Animate rock, sand with its force chains, and beam of a run; trials of a campaign."""
    from ..pictures.sand_animation import is_coarse  # imports matplotlib

    form = output.suffix.removeprefix(".").lower() if output else None
    looks = (lambda: form is None or animation_format(form),)
    with opened(quiet, as_json) as screen, options_named(_OPTIONS), all_causes(*looks):
        if trial:
            _replay(run, trial, output, screen)
            return
        found = read_run(run)
        if advice := is_coarse(found):
            screen.note(advice)
        with screen.counting("frames") as count:
            file = found.animate(output, progress=count)
        if as_json:
            screen.dump({"animation": str(file)})
        else:
            screen.say(str(file))


def _replay(folder: Path, trials: list[int], output: Path | None, screen: Screen) -> None:
    """Animate trials of a campaign that has been saved, each by itself."""
    result = saved_result(folder)
    if not isinstance(result, RockfallResult):
        text = "holds no results of a rockfall campaign, and --trial is for those"
        raise InputRefused([Problem(str(folder), text, "name the folder of a campaign")])
    check(result.campaign, trials)
    if output is not None and len(trials) > 1:
        text = "is one file, and there are several trials"
        raise InputRefused([Problem("--output", text, "leave it out, or take one trial")])
    form = animation_format(output.suffix[1:] if output else None)
    files = [output or folder / "figures" / f"trial-{number}.{form}" for number in trials]
    for number, file in zip(trials, files, strict=True):
        if output is not None:  # those in the folder of the campaign are its own
            refuse_foreign_file(file)
        with refusing_unwritable(file.parent):
            file.parent.mkdir(parents=True, exist_ok=True)
        with screen.counting("frames") as count:
            result.pictures_module().animate_trial(result, number, file, count)
    if screen.as_json:
        screen.dump({"animations": [str(file) for file in files]})
        return
    for file in files:
        screen.say(str(file))
