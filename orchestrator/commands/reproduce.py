"""The command ``rockshed reproduce``: the studies of a paper."""

from collections.abc import Mapping
from pathlib import Path
from shlex import quote
from typing import Annotated, Any

import typer

from ..papers.reproduction import PAPERS, Reproduction, reproduce
from .analysis import options_named
from .options import RESULTS, Json, Quiet, Workers
from .screen import INTERRUPTED, Screen, opened

_Paper = Annotated[str, typer.Argument(metavar="PAPER", help=f"One of {', '.join(PAPERS)}.")]
_Only = Annotated[
    list[str] | None, typer.Option(metavar="STUDY", help="This study only. May be repeated.")
]
_Quick = Annotated[
    bool, typer.Option("--quick", help="One seed in the place of eight or ten, and fewer models.")
]
_Folder = Annotated[Path | None, typer.Option(help="Folder of the results; default results/PAPER.")]


def command(
    paper: _Paper,
    only: _Only = None,
    quick: _Quick = False,
    output_dir: _Folder = None,
    workers: Workers = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Carry out the studies of a paper.

    What is computed stands beside what was printed and measured: table, JSON, figures, HTML page.
    """
    with opened(quiet, as_json) as screen:
        folder = output_dir or RESULTS / paper
        show_reproduction(
            {"paper": paper, "only": only or [], "quick": quick}, folder, workers, screen
        )


def show_reproduction(
    asked: Mapping[str, Any], folder: Path, workers: int | None, screen: Screen
) -> None:
    """Carry out a reproduction, or let one go on, and show it.

    Parameters
    ----------
    asked : mapping of str to Any
        Paper, names of studies, and whether one run stands for all seeds.
    folder : Path
        Of the results.
    workers : int or None
        Number of processes.
    screen : Screen
        Of the command.
    """
    with options_named(("only", "folder")), screen.counting("runs") as done:
        made = reproduce(**asked, folder=folder, workers=workers, note=screen.note, counted=done)
    if screen.as_json:
        screen.dump(made.content)
    else:
        _show(made, folder, screen)
    if made.interrupted:
        again = f"`rockshed resume {quote(str(folder))}` goes on"
        screen.warn(f"interrupted: rows without a value were not run; {again}")
        raise typer.Exit(INTERRUPTED)


def _show(made: Reproduction, folder: Path, screen: Screen) -> None:
    screen.show(*made.tables())
    for part in made.parts:
        for text in part.study.notes:
            screen.say(f"{part.study.name}: {text}")
    files = ", ".join(file.name for file in made.files)
    figures = sum(len(part.figures) for part in made.parts)
    screen.say(f"results in {folder}: {files}, {figures} figures")
