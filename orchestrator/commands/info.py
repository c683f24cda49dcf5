"""The command ``rockshed info``: the content of an FMU or a system."""

from pathlib import Path
from typing import Annotated

import typer

from ..runs.export import system_text
from ..runs.inspection import describe_fmu
from ..runs.request import Request
from ..runs.system import System
from ..runs.target import is_fmu
from .analysis import options_named
from .options import ModelName
from .screen import opened

_Subject = Annotated[
    str,
    typer.Argument(
        metavar="FMU|CASE|SYSTEM.toml",
        help="An FMU, also a stranger's, a case, or a system file.",
    ),
]
_Toml = Annotated[
    bool, typer.Option("--toml", help="Print the system as a file that `rockshed run` takes.")
]


def command(target: _Subject, toml: _Toml = False, model: ModelName = None) -> None:
    """Show an FMU or a system: ports, values, connections."""
    with opened() as screen:
        if is_fmu(target):
            screen.overview(describe_fmu(Path(target)))
            return
        with options_named(("model",), target):
            system = System.prepared(Request(target, model=model))
        if toml:
            screen.out.file.write(system_text(system.spec))
        else:
            screen.overview(system.describe())
