"""The command ``rockshed page``: an impact to play with, in a browser."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from ..core.errors import InputRefused, Problem, all_causes
from ..pages.writing import page
from ..runs.job import look_at_target
from ..runs.request import Request
from .analysis import options_named
from .assignments import sizes_of, values_of
from .options import Assignments, CaseSizes, CouplingScheme, ModelName, Quiet
from .screen import opened

_Target = Annotated[
    str,
    typer.Argument(
        metavar="[CASE|PROJECT.toml]", help="A case of `rockshed list`, or the project of a shed."
    ),
]
_Output = Annotated[
    Path | None,
    typer.Option("--output", metavar="FILE.html", help="Default: NAME.html in this folder."),
]


_OPTIONS = ("values", "sizes", "coupling", "model", "output")


def command(
    target: _Target = "lab-impact",
    output: _Output = None,
    set_: Assignments = None,
    size: CaseSizes = None,
    coupling: CouplingScheme = None,
    model: ModelName = None,
    quiet: Quiet = False,
) -> None:
    """Write a page that computes an impact in the browser."""
    problems: list[Problem] = []
    values = values_of("--set", set_ or [], problems)
    asked = Request(target, values, sizes_of(size or [], problems), coupling, model=model)
    look, named = partial(look_at_target, target), options_named(_OPTIONS, target)
    with opened(quiet) as screen, named, all_causes(look):
        if problems:
            raise InputRefused(problems)
        with screen.progress("compiling"):
            file = page(asked, output, note=screen.note)
        screen.say(str(file))
