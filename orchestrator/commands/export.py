"""The command ``rockshed export``: a system as files."""

from pathlib import Path
from typing import Annotated

import typer

from ..core.errors import Problem
from ..runs.request import Request
from ..runs.system import System
from .analysis import options_named
from .assignments import sizes_of, values_of
from .options import Assignments, CaseSizes, CouplingScheme, ModelName, Target
from .screen import opened

_Folder = Annotated[Path, typer.Argument(metavar="FOLDER", help="A new or empty folder.")]


def command(
    target: Target,
    folder: _Folder,
    set_: Assignments = None,
    size: CaseSizes = None,
    coupling: CouplingScheme = None,
    model: ModelName = None,
) -> None:
    """Write a system as TOML, with its FMUs, to change and run it."""
    problems: list[Problem] = []
    with opened() as screen:
        values = values_of("--set", set_ or [], problems)
        sizes = sizes_of(size or [], problems)
        request = Request(target, values, sizes, coupling, model=model)
        with options_named(("values", "sizes", "coupling", "model"), target):
            system = System.prepared(request, screen.note, problems)
        screen.say(str(system.save(folder)))
