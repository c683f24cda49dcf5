"""The command ``rockshed rockfall``."""

from collections.abc import Sequence
from pathlib import Path

from ..analyses.rockfall.animation_format import can_write_mp4
from ..analyses.rockfall.run import rockfall
from ..core.errors import InputRefused, Problem
from ..core.system.names import nearest
from ..runs.building import is_cold
from ..sites.source import site_source
from .analysis import options_named, show, stages
from .screen import COLD_START, Screen

PRESETS = {"paper": 200}
"""Numbers of trials by name. The paper's is N = 10 / alpha with alpha = 0.05."""


def show_rockfall(
    screen: Screen,
    results: Path,
    site: Path,
    *,
    trials: int | None,
    preset: str | None,
    seed: int | None,
    replays: Sequence[int],
    animation: str | None,
    output_dir: Path | None,
    workers: int | None,
    scheduler: str | None,
    pictures: bool,
) -> None:
    """Compute a campaign and show its tables or JSON.

    Parameters
    ----------
    screen : Screen
        Of the command.
    results : Path
        Folder of the results that name no other.
    site, trials, preset, seed, replays, animation, output_dir, workers, scheduler, pictures
        Options of the command.

    Raises
    ------
    InputRefused
        Everything that is wrong with the options or the site.
    CampaignFailed
        The workers of a scheduler could not go on.
    """
    count = _count(trials, preset)
    folder = output_dir or results / site_source(site).name
    if is_cold(["SlopeRockfall"]):
        screen.note(COLD_START)
    if replays and animation is None and not can_write_mp4():
        screen.note('animations become GIF files; pip install "rockshed[movie]" for MP4')
    options = ("replay", "animation", "workers", "scheduler")
    with options_named(options), stages(screen) as progress:
        result = rockfall(
            site,
            trials=count,
            seed=seed,
            workers=workers,
            scheduler=scheduler,
            replay=replays,
            animation=animation,
            folder=folder,
            pictures=pictures,
            progress=progress,
        )
    show(screen, result)


def _count(trials: int | None, preset: str | None) -> int | None:
    if preset is None:
        return trials
    if preset not in PRESETS:
        remedy = nearest(preset, PRESETS)
        raise InputRefused([Problem("--preset", f"{preset!r} is unknown", remedy)])
    if trials is not None:
        text = "and --trials are two numbers of trials"
        raise InputRefused([Problem("--preset", text, "give one of them")])
    return PRESETS[preset]
