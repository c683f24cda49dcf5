"""The command ``rockshed converge``: sizes of sand discs and beam elements of a shed."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from ..analyses.convergence.files import DATA
from ..analyses.convergence.run import converge
from ..core.errors import InputRefused, Problem
from .analysis import options_named, show, stages
from .assignments import values_of
from .options import Assignments, Json, NoFigures, Quiet, Workers
from .results_place import free_folder
from .screen import Screen, opened

_Project = Annotated[
    Path, typer.Argument(metavar="PROJECT.toml", help="A project of `rockshed init`.")
]
_Packings = Annotated[int, typer.Option(min=2, help="Packings of the sand for each mesh.")]
_Finest = Annotated[
    float, typer.Option(help="How many times finer than the project's the finest discs are.")
]
_Folder = Annotated[
    Path | None, typer.Option(help="Folder of the results; default results/NAME-convergence.")
]


def command(
    project: _Project,
    packings: _Packings = 5,
    finest: _Finest = 2.0,
    set_: Assignments = None,
    output_dir: _Folder = None,
    workers: Workers = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compare a shed with coarser and finer discs and elements.

    Each mesh is computed with several packings of the sand.
    """
    with opened(quiet, as_json) as screen:
        problems: list[Problem] = []
        values = values_of("--set", set_ or [], problems)
        if problems:
            raise InputRefused(problems)
        folder = output_dir or _folder(project, screen)
        with options_named(("packings", "finest", "folder")), stages(screen) as progress:
            result = converge(
                project,
                packings=packings,
                finest=finest,
                values=values,
                workers=workers,
                folder=folder,
                pictures=not no_figures,
                progress=progress,
                note=screen.note,
            )
        show(screen, result)


def _folder(project: Path, screen: Screen) -> Path:
    """Return the folder of the results of a project that the user has named no folder for."""
    origin = {"project_file": str(project)}
    return free_folder(f"{project.stem}-convergence", origin, _content, screen)


def _content(folder: Path) -> Any:
    return json.loads((folder / DATA).read_text(encoding="utf-8"))
