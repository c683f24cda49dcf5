"""Infer the parameters of a slope from measured end points, and forecast another one."""

import time
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rockshed.components.catalogue import component

from ...campaigns.campaign import Campaign, campaign_of
from ...core.errors import InputRefused, Problem, all_causes
from ...input_files.csv_table import read_csv
from ...input_files.form import first
from ...runs.executors import number_of_workers
from ...runs.first_compilation import tell_first_compilation
from ...sites.rockfall.preparation import PreparedSlope, prepare
from ...sites.source import SiteLike
from ..asked import finished_trials, remembering
from ..frame import FloatArray, StageProgress, counter, no_progress
from ..kept_values import KeptValues
from .endpoints import Observed, read_endpoints
from .forecast import forecast_of
from .inferred import Inferred
from .likelihood import Likelihood
from .parameters import (
    GroundOfValues,
    Parameter,
    default_parameters,
    given_parameters,
    values_at,
)
from .result import BackAnalysisResult
from .sampling import sample

FEWEST_STEPS = 20
"""Least number of steps of a walker."""
_UNLIKELY = -1e3
"""Logarithm of the likelihood of a value where the component refuses the parameters."""


def calibrate_rockfall(
    site: SiteLike,
    endpoints: str | Path,
    *,
    fit: Mapping[str, tuple[float, float]] | None = None,
    forecast: SiteLike | None = None,
    scatter: float = 1.0,
    trials: int = 400,
    steps: int = 300,
    seed: int = 1,
    workers: int | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
) -> BackAnalysisResult:
    """Infer parameters of the ground from where rocks came to rest.

    Parameters
    ----------
    site : path, mapping or SlopeSite
        Slope on which the rocks were released.
    endpoints : path
        CSV file with a column ``x (m)``, see :func:`.endpoints.read_endpoints`.
    fit : mapping of str to (float, float), optional
        Ranges (SI) by name: ``soil.strength``, ``soil.roughness.mean``. By default strength or
        coefficients of restitution, roughness and undulation of every material.
    forecast : path, mapping or SlopeSite, optional
        Another slope, whose materials of the same names have the inferred values.
    scatter : float
        Standard deviation (m) by which end points may lie beside computed ones.
    trials : int
        For each evaluation of the likelihood.
    steps : int
        Of each walker of the sampler.
    seed : int
        Of the sampler; that of the trials is the site's.
    workers : int, optional
        Threads, by default one for each core. The result does not depend on it.
    folder : path, optional
        Where the results are saved; it appears as a whole or not at all. What has been computed is
        kept beside it until all has: a calibration that was killed or interrupted goes on.
    pictures : bool
        Whether figures are drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.

    Returns
    -------
    BackAnalysisResult
        Samples of the parameters, fit, cross-validation and forecast.

    Raises
    ------
    InputRefused
        Everything that is wrong with sites, file or arguments; nothing was computed.

    Examples
    --------
    >>> import rockshed
    >>> slope = {
    ...     "rock": {"radius": 0.4, "density": 2600},
    ...     "start": {"x": 1.0},
    ...     "limit_speed": {"mean": 12.0, "deviation": 2.0},
    ...     "profile": {"points": [[0, 40, "soil"], [30, 12, "soil"], [90, 5]]},
    ... }
    >>> with open("ends.csv", "w") as file:
    ...     print("x (m)", 41, 44, 45, 47, 52, sep=chr(10), file=file)
    >>> found = rockshed.calibrate_rockfall(
    ...     slope, "ends.csv", fit={"soil.roughness.mean": (0.05, 0.6)}, steps=20, trials=50
    ... )
    >>> list(found.parameters)
    ['soil.roughness.mean']
    """
    work = _checked(site, Path(endpoints), fit, forecast, scatter, (trials, steps, seed))
    asked = {
        "site": work.slope.source.plain(),
        "endpoints": Path(endpoints).absolute(),
        "fit": fit,
        "forecast": work.other[0].source.plain() if work.other else None,
        "scatter": scatter,
        "trials": trials,
        "steps": steps,
        "seed": seed,
        "workers": workers,
        "pictures": pictures,
    }
    files = [*work.slope.files, *(work.other[0].files if work.other else []), asked["endpoints"]]
    place = finished_trials(Path(folder)) if folder else None
    with (
        remembering(place, BackAnalysisResult.kind, asked, files),
        KeptValues(place) as kept,
        BackAnalysisResult.opened(folder) if folder else nullcontext() as inside,
    ):
        result = _carried_out(work, number_of_workers(workers), kept, progress or no_progress)
        if inside is not None:
            result.write(inside, pictures, progress or no_progress)
    result.folder = Path(folder) if folder else None
    return result


class _BackAnalysis(NamedTuple):
    """A back-analysis to be carried out.

    ``effort`` has the trials of each evaluation, the steps of each walker and the sampler's seed;
    ``other`` the slope of the forecast.
    """

    slope: PreparedSlope
    campaign: Campaign
    observed: list[Observed]
    parameters: list[Parameter]
    other: tuple[PreparedSlope, Campaign] | None
    effort: tuple[int, int, int]


def _checked(
    site: SiteLike,
    endpoints: Path,
    fit: Mapping[str, tuple[float, float]] | None,
    forecast: SiteLike | None,
    scatter: float,
    effort: tuple[int, int, int],
) -> _BackAnalysis:
    """Read sites and file; everything that is wrong with them or the numbers is refused at once."""
    trials, steps, _ = effort
    other_look = None if forecast is None else partial(prepare, forecast, trials)
    with all_causes(partial(prepare, site, trials), partial(read_csv, endpoints), other_look):
        _check_numbers({"trials": (trials, 50), "steps": (steps, FEWEST_STEPS)}, scatter)
        slope = prepare(site, trials)
        campaign = _bare(campaign_of(slope))
        observed = read_endpoints(endpoints, campaign, scatter)
        parameters = given_parameters(fit, slope) if fit else default_parameters(slope)
        other = _other(forecast, slope, trials)
    return _BackAnalysis(slope, campaign, observed, parameters, other, effort)


def _carried_out(
    work: _BackAnalysis, threads: int, kept: KeptValues, show: StageProgress
) -> BackAnalysisResult:
    """Sample the posterior, and compute the slopes with it."""
    tell_first_compilation([component("SlopeRockfall")])
    began = time.perf_counter()
    inferred = _inferred(work, threads, kept, show)
    fitted = forecast_of(work.slope, work.campaign, inferred, threads, kept)
    foreseen = forecast_of(*work.other, inferred, threads, kept) if work.other else None
    wall_time = time.perf_counter() - began
    return BackAnalysisResult(work.slope, inferred, fitted, foreseen, wall_time)


def _check_numbers(least: Mapping[str, tuple[int, int]], scatter: float) -> None:
    problems = [
        Problem(name, f"{value} are too few", f"give {low} or more")
        for name, (value, low) in least.items()
        if value < low
    ]
    if not scatter > 0.0:
        problems.append(Problem("scatter", f"{scatter:g} m is not positive", "give 1 m or so"))
    if problems:
        raise InputRefused(problems)


def _bare(campaign: Campaign) -> Campaign:
    """Return a campaign without envelopes, which a likelihood does not need."""
    return replace(campaign, stations=campaign.stations[[0, -1]])


def _other(
    forecast: SiteLike | None, slope: PreparedSlope, trials: int
) -> tuple[PreparedSlope, Campaign] | None:
    """Return the slope of the forecast, which has materials of the same names."""
    if forecast is None:
        return None
    other = prepare(forecast, trials)
    problems = [
        Problem(f"forecast {other.name}", f"{name} is no material of {slope.name}", "name it alike")
        for name in other.materials
        if name not in slope.materials
    ]
    if len(problems) == len(other.materials):
        raise InputRefused(first(problems))
    return other, _bare(campaign_of(other))


def _inferred(work: _BackAnalysis, threads: int, kept: KeptValues, show: StageProgress) -> Inferred:
    """Sample the posterior of the parameters."""
    trials, steps, seed = work.effort
    parameters, observed = work.parameters, work.observed
    names = [parameter.name for parameter in parameters]
    ground = GroundOfValues(work.slope, work.campaign, names)
    likelihood = Likelihood(observed, trials)
    count = sum(len(entry.values) for entry in observed)

    def pointwise(places: FloatArray) -> FloatArray:
        tried = ground.with_values(values_at(parameters, places))
        return np.full(count, _UNLIKELY) if tried is None else likelihood.pointwise(tried)

    remembered = kept.of(pointwise, "likelihood", ground.about, likelihood, parameters)
    walkers = max(16, 4 * len(parameters))
    progress = counter(show, "steps of the sampler")
    found = sample(remembered, len(parameters), walkers, steps, seed, threads, progress)
    return Inferred(parameters, observed, found, seed, trials)
