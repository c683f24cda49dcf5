"""The command ``rockshed report``: a page that a reviewer can check, and a PDF."""

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..reports.writing import report
from .analysis import options_named
from .options import Quiet
from .screen import opened

_ARGUMENTS = ("file", "check")
"""Arguments of the library that are options of the command."""
_Result = Annotated[
    Path,
    typer.Argument(
        metavar="RUN",
        help="Folder of a run, finished or not, or of `study`, `rockfall` or `pile`.",
    ),
]
_Output = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="The page, .html, or a PDF alone, .pdf; default RUN/report.html."
    ),
]
_Pdf = Annotated[bool, typer.Option("--pdf", help="Write a PDF of the same name as well.")]
_Check = Annotated[
    bool | None,
    typer.Option(
        "--check/--no-check",
        help="Run once more with half of the steps, and compare; by default a run of less than "
        "10 s is.",
    ),
]


def command(
    run: _Result,
    output: _Output = None,
    pdf: _Pdf = False,
    check: _Check = None,
    quiet: Quiet = False,
) -> None:
    """Write a report that a reviewer can check: HTML page and PDF."""
    with opened(quiet) as screen, options_named(_ARGUMENTS):
        with screen.progress("writing the report") as progress:
            files = report(
                run,
                output,
                pdf=pdf,
                check=check,
                repeat=repeating,
                progress=progress,
                note=screen.note,
            )
        for file in files:
            screen.say(str(file))


def repeating(request: Mapping[str, Any]) -> str:
    """Return the command that repeats a run.

    Parameters
    ----------
    request : mapping
        That of the run's provenance.

    Returns
    -------
    str
        One line for a shell; empty if the run is made of a project that stands in no file.
    """
    if request.get("project"):
        return ""
    words = ["rockshed", "run", str(request.get("target", ""))]
    for option in ("model", "coupling", "load_cell"):
        if request.get(option) is not None:
            words += [f"--{option.replace('_', '-')}", str(request[option])]
    for option, key in (("--set", "values"), ("--size", "sizes")):
        for name, value in dict(request.get(key) or {}).items():
            words += [option, f"{name}={value}"]
    for name, value in dict(request.get("options") or {}).items():
        words += [f"--{name.replace('_', '-')}", str(value)]
    if request.get("runtime", "auto") != "auto":
        words += ["--runtime", str(request["runtime"])]
    words += ["--in-process"] if request.get("in_process") else []
    return shlex.join(words)
