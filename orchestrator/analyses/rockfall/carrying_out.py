"""A campaign from beginning to end: trials, statistics, files, pictures, in a folder that appears as a whole or not at all."""

import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from ...core.results.metric import Metric
from ...core.results.run_folder import RunFolder
from .campaign import Crew, Done
from .preparation import Prepared
from .replay import check
from .results import Passing, envelopes, passings, write

FIGURES = "figures"


@dataclass(frozen=True)
class Finished:
    """What came of a campaign. figures: the summary. pictures: files, animations included."""

    folder: Path
    trials: int
    wall_time: float
    figures: Sequence[Metric]
    passings: Sequence[Passing]
    pictures: Sequence[Path]


def carry_out(
    made: Prepared,
    folder: Path,
    crew: AbstractContextManager[Crew],
    counting: Callable[[str], AbstractContextManager[Done]],
    with_pictures: bool = True,
    replays: Sequence[int] = (),
    animation: str = "gif",
) -> Finished:
    """Compute all trials and write everything into ``folder``.

    crew: who computes the trials; it is there as long as that takes. counting: opens a progress bar with this text. replays: trials
    that become animations of this kind.

    Raises:
        InputRefused: the folder cannot be written or holds something else, there is no such trial to replay, or nobody to compute.
    """
    for number in replays:
        check(made, number)
    with RunFolder(folder) as place:
        with counting("trials") as done, crew as working:
            began = time.perf_counter()
            records = working.run(made.campaign, done)
            wall_time = time.perf_counter() - began
        along = envelopes(made.campaign, records)
        passed = passings(made.campaign, records)
        figures = write(made, records, passed, along, place.running, wall_time, working.facts)
        pictures: list[Path] = []
        if with_pictures:
            from .pictures import draw_all

            with counting("drawing"):
                pictures += draw_all(made, records, passed, along, place.running / FIGURES)
        for number in replays:
            from .pictures import animate

            (place.running / FIGURES).mkdir(exist_ok=True)
            pictures.append(place.running / FIGURES / f"trial-{number}.{animation}")
            with counting(f"replay of trial {number}, frames") as done:
                animate(made, number, pictures[-1], done)
        place.swap()
    inside = [folder / file.relative_to(place.running) for file in pictures]
    return Finished(folder, made.campaign.trials, wall_time, figures, passed, inside)
