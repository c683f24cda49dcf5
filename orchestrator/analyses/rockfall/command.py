"""``rockshed rockfall``: what the command asks for, carried out and shown."""

import os
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING

from ...commands.screen import COLD_START, Screen
from ...core.errors import InputRefused, Problem
from ...core.system.names import nearest
from ...runs.building import is_cold

if TYPE_CHECKING:
    from .campaign import Crew

PRESETS = {"paper": 200}
"""Numbers of trials by name. The paper's is N = 10 / alpha with alpha = 0.05."""


def rockfall(
    screen: Screen,
    results: Path,
    file: Path,
    trials: int | None,
    preset: str | None,
    seed: int | None,
    replays: Sequence[int],
    animation: str | None,
    folder: Path | None,
    workers: int | None,
    scheduler: str | None,
    with_pictures: bool,
) -> None:
    """Carry out a campaign and show its table or JSON. results: folder of the runs that name no other.

    Raises:
        InputRefused: everything that is wrong with the options or the site.
    """
    count = _count(trials, preset)
    if is_cold(["SlopeRockfall"]):
        screen.note(COLD_START)
    from .carrying_out import carry_out
    from .preparation import prepare
    from .report import lines, tables

    kind = _kind(screen, animation) if replays else "gif"
    crew = _crew(scheduler, workers)
    made = prepare(file, count, seed)
    done = carry_out(
        made, folder or results / made.name, crew, screen.counting, with_pictures, replays, kind
    )
    if screen.as_json:
        screen.dump(
            {
                "status": "complete",
                "folder": str(done.folder),
                "figures": [figure.as_entry() for figure in done.figures],
                "pictures": [str(file) for file in done.pictures],
            }
        )
        return
    screen.show(*tables(done), "")
    for text in lines(made, done):
        screen.say(text)
    screen.say(
        f"results in {done.folder}"
        + (f", pictures in {done.pictures[0].parent}" if done.pictures else "")
    )


def _count(trials: int | None, preset: str | None) -> int | None:
    if preset is None:
        return trials
    if preset not in PRESETS:
        raise InputRefused(
            [Problem("--preset", f"{preset!r} is unknown", nearest(preset, PRESETS))]
        )
    if trials is not None:
        raise InputRefused(
            [Problem("--preset", "and --trials are two numbers of trials", "give one of them")]
        )
    return PRESETS[preset]


def _crew(scheduler: str | None, workers: int | None) -> "AbstractContextManager[Crew]":
    """Threads of this process, or workers of a Dask scheduler."""
    if scheduler is None:
        from .campaign import threads

        return threads(workers or os.cpu_count() or 1)
    from .cluster import dask_workers

    return dask_workers(scheduler, workers)


def _kind(screen: Screen, wanted: str | None) -> str:
    from .animation import kind_of

    return kind_of(wanted, screen.note)
