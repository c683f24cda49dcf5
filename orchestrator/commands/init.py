"""The command ``rockshed init``: a commented file to begin with."""

from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from ..runs.projects import write_template
from .analysis import options_named
from .screen import opened

_Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the new file.")]
_Template = Annotated[
    str, typer.Option(metavar="shed|slope|pile", help="A rock shed, a slope or a driven pile.")
]
_NEXT = {"shed": "run", "slope": "rockfall", "pile": "pile"}
"""Commands that take the files."""


def command(folder: _Folder, template: _Template = "shed") -> None:
    """Write a commented project file; nothing is overwritten."""
    with opened() as screen:
        with options_named(("template",)):
            file = write_template(folder, template)
        screen.say(f"{file}: change it, then `rockshed {_NEXT[template]} {quote(str(file))}`")
