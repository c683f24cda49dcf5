"""The command ``rockshed bench``: speed and price of the coupling."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..bench.table import PARTS, BenchmarkRow
from ..core.errors import InputRefused, Problem
from ..tables import Table
from .bench_systems import bench_systems
from .options import RESULTS, Json, Quiet
from .screen import CHECK_FAILED, opened

SYSTEMS = "systems"
"""Part that has a table of its own."""

_MANY, _FEW = 7, 3
"""Rounds by default, and of the part systems."""

_Parts = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="discs|coupling|exchange|price|start|rockfall|cluster|residuals|systems",
        help="All of them by default, but systems, which is asked for alone.",
    ),
]
_Quick = Annotated[
    bool, typer.Option("--quick", help="Of systems: three of them, two exchange steps each.")
]
_Folder = Annotated[
    Path | None,
    typer.Option(
        "--output-dir", help="Of systems: folder of data and figure; else results/systems."
    ),
]
_Rounds = Annotated[
    int | None,
    typer.Option(
        min=3, help=f"Rounds in which everything takes its turn; {_MANY}, of systems {_FEW}."
    ),
]


def command(
    part: _Parts = None,
    rounds: _Rounds = None,
    quick: _Quick = False,
    output_dir: _Folder = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Measure speed and price of the coupling.

    Everything measured is a ratio within interleaved rounds. Takes some minutes. `systems` runs
    the impact systems in every master that is installed, and takes about eight minutes on two
    cores; ended before, the same command goes on where it was.
    """
    with opened(quiet, as_json) as screen:
        wanted = part or list(PARTS)
        _refuse(wanted, quick or output_dir is not None)
        if wanted == [SYSTEMS]:
            place = output_dir or RESULTS / SYSTEMS
            measured = bench_systems(place, quick, rounds or _FEW, screen)
            if as_json:
                screen.dump([asdict(row) for row in measured.rows])
            return
        rows: list[BenchmarkRow] = []
        for name in wanted:
            with screen.busy(f"measuring: {name}"):
                rows += PARTS[name](rounds or _MANY)
        if as_json:
            screen.dump([asdict(row) for row in rows])
        else:
            screen.show(_table(rows))
        if any(row.is_missed for row in rows):
            raise typer.Exit(CHECK_FAILED)


def _refuse(wanted: Sequence[str], has_options_of_systems: bool) -> None:
    """Refuse parts that do not exist, and options that do not go with them."""
    choice = f"choose of {', '.join((*PARTS, SYSTEMS))}"
    problems = [
        Problem(name, "is no part of the benchmark", choice)
        for name in wanted
        if name not in (*PARTS, SYSTEMS)
    ]
    if SYSTEMS in wanted and len(wanted) > 1:
        problems.append(Problem(SYSTEMS, "is measured alone", f"rockshed bench {SYSTEMS}"))
    if has_options_of_systems and SYSTEMS not in wanted:
        what = "belong to the part systems"
        problems.append(Problem("--quick, --output-dir", what, "leave them out"))
    if problems:
        raise InputRefused(problems)


def _table(rows: Sequence[BenchmarkRow]) -> Table:
    titles = ("quantity", "measured", "unit", "as a multiple of", "goal")
    table = Table(titles, right=("measured",))
    for row in rows:
        goal = "" if row.goal is None else f"at most {row.goal:.3g}"
        measured = "-" if row.value is None else f"{row.value:.3g}"
        table.add(row.name, measured, row.unit, row.compared_with, goal)
    return table
