"""A pile from beginning to end: blows, bearing graph, files, pictures, in a folder that appears as a whole or not at all."""

import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from ...core.results.metric import Metric
from ...core.results.run_folder import RunFolder
from .blows import Blow, Done, bearing_graph, drive
from .preparation import Prepared
from .results import write

FIGURES = "figures"


@dataclass(frozen=True)
class Finished:
    """What came of it. figures: the summary. pictures: files."""

    folder: Path
    blows: Sequence[Blow]
    graph: Sequence[Blow]
    wall_time: float
    figures: Sequence[Metric]
    pictures: Sequence[Path]


def carry_out(
    made: Prepared,
    folder: Path,
    counting: Callable[[str], AbstractContextManager[Done]],
    with_pictures: bool = True,
) -> Finished:
    """Compute everything and write it into ``folder``. counting: opens a progress bar with this text.

    Raises:
        InputRefused: the folder cannot be written or holds something else.
    """
    with RunFolder(folder) as place:
        began = time.perf_counter()
        with counting("blows") as done:
            blows = drive(made, done)
        graph: list[Blow] = []
        if made.site.bearing:
            with counting("bearing graph, blows") as done:
                graph = bearing_graph(made, done)
        wall_time = time.perf_counter() - began
        figures = write(made, blows, graph, place.running, wall_time)
        pictures: list[Path] = []
        if with_pictures:
            from .pictures import draw_all

            with counting("drawing"):
                pictures = draw_all(made, blows, graph, place.running / FIGURES)
        place.swap()
    return Finished(
        folder,
        blows,
        graph,
        wall_time,
        figures,
        [folder / file.relative_to(place.running) for file in pictures],
    )
