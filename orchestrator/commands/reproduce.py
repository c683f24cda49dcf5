"""The command ``rockshed reproduce``: the studies of a paper."""

from pathlib import Path
from typing import Annotated

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
        with options_named(("only", "folder")), screen.counting("runs") as done:
            made = reproduce(paper, folder, only or [], quick, workers, screen.note, done)
        if as_json:
            screen.dump(made.content)
        else:
            _show(made, folder, screen)
        if made.interrupted:
            screen.warn("interrupted: rows without a value were not run")
            raise typer.Exit(INTERRUPTED)


def _show(made: Reproduction, folder: Path, screen: Screen) -> None:
    screen.show(*made.tables())
    for part in made.parts:
        for text in part.study.notes:
            screen.say(f"{part.study.name}: {text}")
    files = ", ".join(file.name for file in made.files)
    figures = sum(len(part.figures) for part in made.parts)
    screen.say(f"results in {folder}: {files}, {figures} figures")
