"""The command ``rockshed rockfall``: a campaign of trials on a slope."""

import re
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ..analyses.rockfall.run import rockfall
from ..animations.formats import animation_format, can_write_mp4
from ..core.errors import InputRefused, Problem, all_causes
from ..core.system.names import nearest
from ..runs.building import is_cold
from ..sites.source import site_source
from .analysis import kept_if_ended, options_named, show, stages
from .cluster_options import Authority, Certificate, PrivateKey, Scheduler, certificates_of
from .options import Json, NoFigures, Quiet
from .results_place import folder_of_site, look_at_folder
from .screen import COLD_START, Screen, opened
from .streams import tell_leftovers

PRESETS = {"paper": 200}
"""Numbers of trials by name. The paper's is N = 10 / alpha with alpha = 0.05."""
_OPTIONS = (
    "trials",
    "seed",
    "replay",
    "trajectories",
    "animation",
    "workers",
    "scheduler",
    "certificates",
    "folder",
)
"""Arguments of the analysis that are options of the command."""

_Site = Annotated[
    Path,
    typer.Argument(metavar="PROFILE.toml", help="Rock, profile, ground, search lines, barriers."),
]
_Trials = Annotated[
    int | None, typer.Option(min=1, help="Number of trials; default: the file's, or 10,000.")
]
_Preset = Annotated[str | None, typer.Option(metavar="paper", help="paper: 200 trials.")]
_Seed = Annotated[int | None, typer.Option(min=0, help="Another sample.")]
_Replay = Annotated[
    list[int] | None, typer.Option(metavar="TRIAL", help="Animate this trial. May be repeated.")
]
_Trajectories = Annotated[
    str | None,
    typer.Option(
        metavar="N|all",
        help="Save the trajectories of the first N trials as data, trajectories.parquet.",
    ),
]
_Animation = Annotated[
    str | None, typer.Option(metavar="mp4|gif", help="Default: mp4 if it can be written.")
]
_Folder = Annotated[Path | None, typer.Option(help="Folder of the results; default results/NAME.")]
_Threads = Annotated[
    int | None,
    typer.Option(
        min=1, help="Threads, or processes of --scheduler local; default: one for each core."
    ),
]


def command(
    site: _Site,
    trials: _Trials = None,
    preset: _Preset = None,
    seed: _Seed = None,
    replay: _Replay = None,
    trajectories: _Trajectories = None,
    animation: _Animation = None,
    output_dir: _Folder = None,
    workers: _Threads = None,
    scheduler: Scheduler = None,
    tls_ca: Authority = None,
    tls_cert: Certificate = None,
    tls_key: PrivateKey = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Monte Carlo of rockfall on a slope: envelopes, percentiles, end points, replays.

    Percentiles have confidence intervals.
    """
    looks = (
        *(partial(site_source, site), partial(_count, trials, preset)),
        *(partial(animation_format, animation), look_at_folder(output_dir)),
    )
    with opened(quiet, as_json) as screen, options_named(_OPTIONS), all_causes(*looks):
        folder = _begun(site, output_dir, bool(replay) and animation is None, screen)
        with kept_if_ended(screen, folder), stages(screen) as progress:
            result = rockfall(
                site,
                trials=_count(trials, preset),
                seed=seed,
                workers=workers,
                scheduler=scheduler,
                certificates=certificates_of(tls_ca, tls_cert, tls_key),
                replay=replay or [],
                trajectories=_number_or_word(trajectories),
                animation=animation,
                folder=folder,
                pictures=not no_figures,
                progress=progress,
            )
        show(screen, result)


def _begun(site: Path, folder: Path | None, animates: bool, screen: Screen) -> Path:
    """Return the folder of the results; note what is slow at first, and how animations come."""
    folder = folder or folder_of_site(site, "rockfall", screen)
    tell_leftovers(folder, screen)
    if is_cold(["SlopeRockfall"]):
        screen.note(COLD_START)
    if animates and not can_write_mp4():
        screen.note('animations become GIF files; pip install "rockshed[movie]" for MP4')
    return folder


def _number_or_word(text: str | None) -> Any:
    """Return a number where a text is one; the analysis refuses other words than ``all``."""
    if text is None:
        return 0
    return int(text) if re.fullmatch("[0-9]{1,12}", text) else text


def _count(trials: int | None, preset: str | None) -> int | None:
    """Return the number of trials, of a preset too; None for that of the file."""
    if preset is None:
        return trials
    if preset not in PRESETS:
        remedy = nearest(preset, PRESETS)
        raise InputRefused([Problem("--preset", f"{preset!r} is unknown", remedy)])
    if trials is not None:
        text = "and --trials are two numbers of trials"
        raise InputRefused([Problem("--preset", text, "give one of them")])
    return PRESETS[preset]
