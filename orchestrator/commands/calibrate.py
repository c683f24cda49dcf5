"""The command ``rockshed calibrate``."""

from pathlib import Path
from typing import Annotated

import typer

from ..analyses.calibration.report import as_data, asked_for, find, notes, table, write
from ..core.errors import InputRefused, Problem, RunFailed
from .assignments import values_of
from .options import RESULTS, Assignments, Json, Quiet, Workers
from .screen import RUN_FAILED, opened

_Curve = Annotated[
    str | None,
    typer.Argument(
        metavar="[CURVE.csv|sonoda1993]",
        show_default=False,
        help="Measured load-penetration curve, columns `penetration (cm)` and `load (kgf)` or "
        "other units; or table 4 of the paper.",
    ),
]
_Stiffness = Annotated[
    str | None,
    typer.Option(
        metavar="'NUMBER UNIT'",
        help="Measured secant spring constant at 4 cm instead: '39.1 kgf/cm', '38.3 kN/m'.",
    ),
]
_Rotation = Annotated[
    str,
    typer.Option(
        metavar="locked|free|fit",
        help="Rotation model of the sand; fit: the one that has the curve.",
    ),
]
_Seeds = Annotated[int, typer.Option(min=2, help="Samples of the sand for each E_bar.")]
_Folder = Annotated[
    Path | None, typer.Option(help="Folder of the results; default results/calibration.")
]


def command(
    target: _Curve = None,
    stiffness: _Stiffness = None,
    rotation: _Rotation = "locked",
    set_: Assignments = None,
    seeds: _Seeds = 5,
    output_dir: _Folder = None,
    workers: Workers = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find E_bar of a sand from a spring constant or a load-penetration curve.

    The static test is computed until it has what was measured.
    """
    problems: list[Problem] = []
    folder = output_dir or RESULTS / "calibration"
    with opened(quiet, as_json) as screen:
        values = values_of("--set", set_ or [], problems)
        if problems:
            raise InputRefused(problems)
        asked = asked_for(target, stiffness, rotation, values)
        try:
            with screen.counting("static tests") as done:
                found = find(asked, seeds, workers, screen.note, done)
        except RunFailed as failure:
            screen.fail(str(failure))
            raise typer.Exit(RUN_FAILED) from None
        files = write(found, folder)
        if as_json:
            screen.dump({"status": "complete", **as_data(found), "files": [str(f) for f in files]})
            return
        screen.show(table(found), "")
        for text in notes(found):
            screen.say(text)
        screen.say(f"results in {folder}: " + ", ".join(file.name for file in files))
