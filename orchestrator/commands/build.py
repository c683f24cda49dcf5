"""The command ``rockshed build``: FMUs of components."""

from pathlib import Path
from typing import Annotated

import typer

from ..core.errors import Problem
from ..runs.building import Export, build_all
from .analysis import options_named
from .assignments import sizes_of
from .options import Quiet
from .screen import opened

_OPTIONS = ("sizes", "runtime", "platforms", "fmi", "folder")
"""Arguments of the library that are options of the command."""

_Names = Annotated[
    list[str] | None, typer.Argument(metavar="COMPONENT", help="All of them by default.")
]
_Sizes = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME=NUMBER", help="A size other than the default. May be repeated."),
]
_Runtime = Annotated[
    str | None,
    typer.Option(
        metavar="python|native|both",
        help="FMUs with Python inside, for x86-64 under Linux and Windows, or native ones, which "
        "need no Python. By default python, with --fmi 3 native.",
    ),
]
_Fmi = Annotated[
    int,
    typer.Option(metavar="2|3", help="Version of FMI. That of 3.0 is for native FMUs only."),
]
_Platforms = Annotated[
    list[str] | None,
    typer.Option(
        metavar="linux64|win64|darwin64|aarch64-linux|aarch64-darwin|all|wasm",
        help="Of native FMUs; by default this machine's. May be repeated. wasm, for hosts of "
        "WebAssembly, is for FMI 3 and needs the extra wasm.",
    ),
]
_Folder = Annotated[
    Path | None,
    typer.Option(help="The FMUs go into its folders python, native and native-fmi3."),
]


def command(
    components: _Names = None,
    size: _Sizes = None,
    runtime: _Runtime = None,
    fmi: _Fmi = 2,
    platform: _Platforms = None,
    output_dir: _Folder = None,
    quiet: Quiet = False,
) -> None:
    """Build FMUs of components, always anew."""
    problems: list[Problem] = []
    export = Export(runtime, platform or [], fmi)
    with opened(quiet) as screen, screen.busy("building"), options_named(_OPTIONS):
        sizes = sizes_of(size or [], problems)
        for file in build_all(components or [], sizes, output_dir, export, problems):
            screen.say(f"{file}  {file.stat().st_size / 1024:.0f} KiB")
