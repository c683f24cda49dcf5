"""Options that several commands have."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..core.system.clock import seconds_in

RESULTS = Path("results")
"""Folder of the results that name no other."""

Json = Annotated[bool, typer.Option("--json", help="Print the results as JSON.")]
Quiet = Annotated[
    bool,
    typer.Option(
        "--quiet", "-q", help="No progress and no notes: results, warnings and errors only."
    ),
]
Assignments = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="Another value of component.parameter, of a shared value or of a field of a project, "
        "in SI or with a unit: cushion.thickness=1.5m. May be repeated.",
    ),
]
CaseSizes = Annotated[
    list[str] | None,
    typer.Option(
        "--size",
        metavar="COMPONENT.SIZE=NUMBER",
        help="Build a component in another size. May be repeated.",
    ),
]
CouplingScheme = Annotated[
    str | None,
    typer.Option(
        "--coupling",
        metavar="paper|impulse|jacobi|implicit",
        help="Scheme of exchange of a case, by default its first; waves or plain for spt.",
    ),
]
ModelName = Annotated[
    str | None,
    typer.Option(
        "--model",
        metavar="calibrated|literal|one-law",
        help="Model of the sand of a case; default calibrated, on girders one-law.",
    ),
]
Target = Annotated[
    str,
    typer.Argument(
        metavar="CASE|FILE.toml",
        help="A case of `rockshed list`, a project of `rockshed init`, or a system file.",
    ),
]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Draw nothing.")]
Strict = Annotated[
    bool, typer.Option("--strict", help="End with exit code 3 if the run has any warning.")
]
Workers = Annotated[
    int | None,
    typer.Option(min=1, help="Processes at a time; default: one for each core."),
]


def _duration(text: str | float) -> float:
    """Read a time (s), ``2ms``, ``2e-3`` or ``1/60``; the default of an option is a number."""
    if isinstance(text, float):
        return text
    if text.strip().lstrip("+-").lower() in ("nan", "inf", "infinity"):
        raise typer.BadParameter(f"must be a finite number (given: {text})")
    try:
        return seconds_in(text)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


def simulated_time(help_: str) -> Any:
    """Return an option that takes a time with a unit, or in s."""
    return typer.Option(metavar="TIME", parser=_duration, help=help_)
