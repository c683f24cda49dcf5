"""The command ``rockshed bench``: speed and price of the coupling."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated

import typer

from ..bench.table import PARTS, BenchmarkRow
from ..core.errors import InputRefused, Problem
from ..tables import Table
from .options import Json, Quiet
from .screen import CHECK_FAILED, opened

_Parts = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="discs|coupling|exchange|start|rockfall|cluster", help="All of them by default."
    ),
]
_Rounds = Annotated[int, typer.Option(min=3, help="Rounds in which everything takes its turn.")]


def command(
    part: _Parts = None, rounds: _Rounds = 7, as_json: Json = False, quiet: Quiet = False
) -> None:
    """Measure speed and price of the coupling.

    Everything measured is a ratio within interleaved rounds. Takes some minutes.
    """
    with opened(quiet, as_json) as screen:
        wanted = part or list(PARTS)
        choice = f"choose of {', '.join(PARTS)}"
        problems = [
            Problem(name, "is no part of the benchmark", choice)
            for name in wanted
            if name not in PARTS
        ]
        if problems:
            raise InputRefused(problems)
        rows: list[BenchmarkRow] = []
        for name in wanted:
            with screen.busy(f"measuring: {name}"):
                rows += PARTS[name](rounds)
        if as_json:
            screen.dump([asdict(row) for row in rows])
        else:
            screen.show(_table(rows))
        if any(row.is_missed for row in rows):
            raise typer.Exit(CHECK_FAILED)


def _table(rows: Sequence[BenchmarkRow]) -> Table:
    titles = ("quantity", "measured", "unit", "as a multiple of", "goal")
    table = Table(titles, right=("measured",))
    for row in rows:
        goal = "" if row.goal is None else f"at most {row.goal:.3g}"
        measured = "-" if row.value is None else f"{row.value:.3g}"
        table.add(row.name, measured, row.unit, row.compared_with, goal)
    return table
