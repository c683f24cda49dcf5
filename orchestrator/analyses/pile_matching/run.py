"""Carry out the matching of a measured blow."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from ...core.errors import InputRefused, Problem
from ...sites.pile.preparation import PreparedPile, prepare
from ...sites.source import SiteLike
from ..asked import finished_trials, remembering
from ..frame import FloatArray, StageProgress, counter, no_progress
from ..kept_values import Function, KeptValues
from .measured import MeasuredBlow, read_blow
from .model import MOST_FACTOR, WaveModel
from .result import PileMatch, SoilEstimate

STARTS = (1.0, 0.4, 2.5)
"""Factors on all resistances of the file from which the search begins."""
_TRAVELS = 3.0
"""Travel times of a wave to the toe that a measurement has at least."""
_DIFFERENCE = 1e-3
"""Change of the logarithm of a parameter by which its influence is found."""


def match_pile(
    measured: str | Path,
    site: SiteLike,
    *,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
) -> PileMatch:
    """Find soil resistance, quakes and damping from force and velocity at the head of a pile.

    Parameters
    ----------
    measured : path
        CSV file with time, force and velocity of a blow.
    site : path, mapping or PileSite
        The pile below the gauge, with layers ``shaft`` and ``toe``: where the search begins.
    folder : path, optional
        Where the results are saved; it appears as a whole or not at all. What has been computed is
        kept beside it until all has: a matching that was killed or interrupted goes on.
    pictures : bool
        Whether figures are drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.

    Returns
    -------
    PileMatch
        Parameters with their uncertainty, curves, tables and figures.

    Raises
    ------
    InputRefused
        Everything that is wrong with measurement and site; nothing was computed.

    Examples
    --------
    >>> import numpy as np
    >>> import rockshed
    >>> site = {
    ...     "segments": 12,
    ...     "time": 0.04,
    ...     "gravity": 0.0,
    ...     "hammer": {"mass": 4000.0, "drop": 1.2},
    ...     "cushion": {"stiffness": 8e8},
    ...     "rod": [{"length": 18.0, "width": 0.4, "modulus": 3.6e10, "density": 2450.0}],
    ...     "shaft": [{"from": 4.0, "to": 18.0, "resistance": 900e3}],
    ...     "toe": {"resistance": 900e3},
    ... }
    >>> blow = rockshed.pile(site).blows[0].traces  # in the place of a measurement
    >>> velocity = blow["head.zv"] / (0.16 * (3.6e10 * 2450.0) ** 0.5)
    >>> rows = np.c_[blow["time"], blow["head.contact_force"], velocity]
    >>> title = "time (s),force (N),velocity (m/s)"
    >>> np.savetxt("blow.csv", rows, delimiter=",", header=title, comments="")
    >>> match = rockshed.match_pile("blow.csv", {**site, "toe": {"resistance": 500e3}})
    >>> print(f"{match.metrics['resistance'].value / 1e6:.1f} MN")
    1.8 MN
    """
    show = progress or no_progress
    blow, pile = _read(Path(measured), site)
    file = Path(measured).absolute()
    asked = {"measured": file, "site": pile.source.plain(), "pictures": pictures}
    files = [file, *([pile.source.file.absolute()] if pile.source.file else [])]
    place = finished_trials(Path(folder)) if folder else None
    with (
        remembering(place, PileMatch.kind, asked, files),
        KeptValues(place) as kept,
        PileMatch.opened(folder) if folder else nullcontext() as inside,
    ):
        match = _matched(WaveModel(pile, blow), blow, kept, show)
        if inside is not None:
            match.write(inside, pictures, show)
    match.folder = Path(folder) if folder else None
    return match


def _matched(
    model: WaveModel, blow: MeasuredBlow, kept: KeptValues, show: StageProgress
) -> PileMatch:
    """Fit the soil from every start, and take the best fit."""
    wave = kept.of(model.wave, "wave", model.about)
    count = counter(show, "wave matching, starts")
    results = []
    count(0, len(STARTS))
    for number, start in enumerate(STARTS, 1):
        results.append(_fit(model, wave, start))
        count(number, len(STARTS))
    best = min(results, key=lambda fit: float(fit.cost))
    return PileMatch(model, blow, _estimates(model, best), wave(np.exp(best.x)))


def _read(measured: Path, site: SiteLike) -> tuple[MeasuredBlow, PreparedPile]:
    """Return measurement and pile, or refuse both at once."""
    problems: list[Problem] = []
    blow, pile = None, None
    try:
        blow = read_blow(measured)
    except InputRefused as refusal:
        problems += refusal.problems
    try:
        pile = prepare(site)
    except InputRefused as refusal:
        problems += refusal.problems
    if pile is not None and not pile.site.shaft:
        text = "the soil along the shaft is not given in layers"
        remedy = "give [[shaft]] with a start for the resistance of each layer, and [toe]"
        problems.append(Problem(pile.source.places.of(("shaft",)), text, remedy))
    if blow is not None and pile is not None:
        lasts = blow.time[-1] - blow.time[0]
        least = _TRAVELS * pile.travel_time
        if lasts < least:
            text = (
                f"lasts {lasts:.3g} s, and a wave is back from the toe after {2 * least / 3:.3g} s"
            )
            problems.append(Problem(str(measured), text, f"give {least:.2g} s at least"))
    if problems or blow is None or pile is None:
        raise InputRefused(problems)
    return blow, pile


def _fit(model: WaveModel, wave: Function, start: float) -> Any:
    """Return the fit of least squares from a factor on the resistances on."""
    from scipy.optimize import least_squares

    scale = float(np.abs(model.down).max())

    def residuals(logarithms: FloatArray) -> FloatArray:
        return (wave(np.exp(logarithms)) - model.up) / scale

    begin = np.array([np.log(start) if "resistance" in one.name else 0.0 for one in model.sought])
    bound = np.log(MOST_FACTOR)
    return least_squares(
        residuals,
        begin,
        bounds=(-bound, bound),
        diff_step=_DIFFERENCE,
        xtol=1e-6,
        ftol=1e-9,
        max_nfev=40,
    )


def _estimates(model: WaveModel, fit: Any) -> list[SoilEstimate]:
    """Return the parameters with the standard errors of their logarithms.

    Covariance s^2 (J^T J)^-1, s^2 the variance of what is left, times the integrated
    autocorrelation time of it: rows that follow one another are not independent.
    """
    left = fit.fun
    freedom = max(1, left.size - fit.x.size)
    spread = float(left @ left) / freedom * _correlation_time(left)
    covariance = spread * np.linalg.pinv(fit.jac.T @ fit.jac)
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    bound = np.log(MOST_FACTOR)
    made = [
        SoilEstimate(
            one.name,
            one.unit,
            one.start * float(np.exp(value)),
            float(error),
            bool(abs(value) > 0.99 * bound),
        )
        for one, value, error in zip(model.sought, fit.x, errors, strict=True)
    ]
    return [*made, _total(made, covariance)]


def _total(made: list[SoilEstimate], covariance: FloatArray) -> SoilEstimate:
    """Return the resistance of shaft and toe together."""
    shares = np.array([one.value if "resistance" in one.name else 0.0 for one in made])
    total = float(shares.sum())
    error = float(np.sqrt(max(0.0, shares @ covariance @ shares))) / total
    return SoilEstimate("resistance", "N", total, error, False)


def _correlation_time(left: FloatArray) -> float:
    """Return the integrated autocorrelation time of residuals in steps, 1 or more.

    Summed until the first lag without correlation.
    """
    around = left - left.mean()
    power = np.correlate(around, around, "full")[left.size - 1 :]
    if power[0] == 0.0:
        return 1.0
    relative = power / power[0]
    end = int(np.argmax(relative <= 0.0)) or relative.size
    return float(max(1.0, 1.0 + 2.0 * relative[1:end].sum()))
