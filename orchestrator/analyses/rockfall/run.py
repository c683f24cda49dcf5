"""Carry out a rockfall campaign."""

import time
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Literal

from rockshed.components.catalogue import component

from ...animations.formats import animation_format
from ...campaigns.campaign import Campaign, campaign_of
from ...campaigns.executors import Executor, threads
from ...campaigns.kept import KeptTrials
from ...campaigns.replay import check
from ...core.errors import InputRefused, Problem
from ...runs.executors import number_of_workers
from ...runs.first_compilation import tell_first_compilation
from ...sites.rockfall.preparation import PreparedSlope, prepare
from ...sites.source import SiteLike
from ..asked import finished_trials, remembering
from ..frame import StageProgress, counter, no_progress
from .arguments import CampaignArguments
from .cluster import Certificates, dask_workers
from .result import RockfallResult


def rockfall(
    site: SiteLike,
    *,
    trials: int | None = None,
    seed: int | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    certificates: Certificates | None = None,
    replay: Sequence[int] = (),
    trajectories: int | Literal["all"] = 0,
    animation: str | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
) -> RockfallResult:
    """Compute the trials of rockfall on a slope.

    Parameters
    ----------
    site : path, mapping or SlopeSite
        Rock, profile, ground, search lines and barriers: a site file (TOML), or its content.
    trials, seed : int, optional
        Number of the trials, and seed of their random numbers, in the place of the site's.
    workers : int, optional
        Threads, or processes of ``scheduler="local"``; by default one for each core.
    scheduler : str, optional
        ``local`` for processes of this computer, or the address of a running Dask scheduler. The
        results are the same to the bit.
    certificates : Certificates, optional
        Of a running scheduler that knows its users by them (``tls://HOST:PORT``).
    replay : sequence of int
        Trials of which animations are written.
    trajectories : int or "all"
        Number of trials, from the first on, whose trajectories are saved as data.
    animation : str, optional
        ``mp4`` or ``gif``; by default MP4 where it can be written.
    folder : path, optional
        Where the results are saved; it appears as a whole or not at all. Trials that have ended are
        kept beside it until all have: a campaign that was killed or interrupted goes on.
    pictures : bool
        Whether figures are drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.

    Returns
    -------
    RockfallResult
        Records of all trials, tables, metrics and figures.

    Raises
    ------
    InputRefused
        Everything that is wrong with the site or the arguments; nothing was computed.
    CampaignFailed
        The workers of a scheduler could not go on.

    Examples
    --------
    >>> import rockshed
    >>> slope = {
    ...     "rock": {"radius": 0.5, "density": 2600},
    ...     "start": {"x": 1.0},
    ...     "limit_speed": {"mean": 12.0, "deviation": 2.0},
    ...     "profile": {"points": [[0, 40, "rock"], [30, 10, "soil"], [60, 5]]},
    ...     "line": [{"name": "road", "x": 40.0}],
    ... }
    >>> result = rockshed.rockfall(slope, trials=100)
    >>> result.metrics["trials"].value
    100
    >>> result.metrics["line_road_energy_p95"].unit
    'J'
    >>> result.to_arrow().num_rows
    100
    """
    asked = CampaignArguments(
        site,
        trials,
        seed,
        workers,
        scheduler,
        certificates,
        replay,
        trajectories,
        animation,
        pictures,
    )
    return carry_out_campaign(asked, Path(folder) if folder else None, progress or no_progress)


def carry_out_campaign(
    asked: CampaignArguments, folder: Path | None, show: StageProgress
) -> RockfallResult:
    """Carry out a campaign; with a folder, it can go on in another process when this one is ended.

    Parameters
    ----------
    asked : CampaignArguments
        Everything that it follows from.
    folder, show
        As :func:`rockfall` has them.

    Raises
    ------
    InputRefused, CampaignFailed
        As :func:`rockfall` does.
    """
    slope = prepare(asked.site, asked.trials, asked.seed)
    campaign = campaign_of(slope)
    check(campaign, asked.replay)
    paths = _path_count(campaign, asked.trajectories)
    place = finished_trials(folder) if folder else None
    kept = KeptTrials(place) if place else None
    with remembering(place, RockfallResult.kind, asked.as_data(slope), slope.files):
        with RockfallResult.opened(folder) if folder else nullcontext() as inside:
            result = _result(asked, slope, campaign, kept, show)
            result.trajectories = paths
            if inside is not None:
                result.write(inside, asked.pictures, show)
        if kept is not None:
            kept.clear()
    result.folder = folder
    return result


def _result(
    asked: CampaignArguments,
    slope: PreparedSlope,
    campaign: Campaign,
    kept: KeptTrials | None,
    show: StageProgress,
) -> RockfallResult:
    """Compute the trials of a campaign that are not kept."""
    form = animation_format(asked.animation) if asked.replay else "gif"
    show("trials", 0, campaign.trials)
    tell_first_compilation([component("SlopeRockfall")])
    with _executor(asked.scheduler, asked.workers, asked.certificates, kept) as executor:
        began = time.perf_counter()
        records = executor.run(campaign, counter(show, "trials"))
        wall_time = time.perf_counter() - began
    facts = {**executor.facts, **({"resumed": kept.found} if kept and kept.found else {})}
    result = RockfallResult(slope, campaign, records, wall_time, facts)
    result.animate(asked.replay, form)
    return result


def _path_count(campaign: Campaign, trajectories: int | str) -> int:
    """Return the number of trials whose trajectories are saved."""
    if trajectories == "all":
        return campaign.trials
    if isinstance(trajectories, str) or not 0 <= trajectories <= campaign.trials:
        text = f"{trajectories} is neither all nor a number of trials"
        remedy = f"give all, or a number up to {campaign.trials}"
        raise InputRefused([Problem("trajectories", text, remedy)])
    return trajectories


def _executor(
    scheduler: str | None,
    workers: int | None,
    certificates: Certificates | None,
    kept: KeptTrials | None,
) -> AbstractContextManager[Executor]:
    """Open threads of this process, or the workers of a Dask scheduler."""
    if scheduler is None:
        if certificates is not None:
            text = "are for a running scheduler"
            raise InputRefused([Problem("certificates", text, "name it with scheduler=...")])
        return threads(number_of_workers(workers), kept)
    return dask_workers(scheduler, workers, certificates, kept)
