"""Statistics of a study: means, percentiles, exceedance and sensitivity, each with its interval."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...metrics.percentiles import CONFIDENCE, Percentile, borne, percentile
from ..frame import FloatArray
from .designs import FIRST, MIXED, SECOND
from .factors import Factor
from .records import StudyRecords, StudyRun, values_of

SHARES = (0.05, 0.5, 0.9, 0.95, 0.99)
"""Parts of the population whose percentiles are told where the sample bears them."""
FEWEST_FOR_BOOTSTRAP = 10
"""Values from which on the interval of a mean is that of the bootstrap; of fewer, Student's."""
FEWEST_FOR_RANKS = 10
"""Runs from which on rank correlations are told."""
FEWEST_FOR_SOBOL = 32
"""Samples from which on Sobol indices are told."""
_RESAMPLES = 999
_SEED = 1
"""Of the resampling: the same runs have the same intervals."""


@dataclass(frozen=True)
class Mean:
    """Mean of some values.

    Attributes
    ----------
    count : int
        Number of values.
    value, deviation : float
        Mean, and standard deviation; NaN of a single value.
    low, high : float
        Bounds of the interval of the mean; NaN of a single value.
    """

    count: int
    value: float
    deviation: float
    low: float
    high: float


def mean_of(values: FloatArray) -> Mean:
    """Return the mean of some values with its 95 % interval.

    The interval is that of the bootstrap (bias-corrected and accelerated, Efron 1987); of fewer
    than 10 values, for which it is too narrow, that of Student's t for normal values.

    Parameters
    ----------
    values : array of float, shape (n,)
        At least one.
    """
    from scipy import stats

    count = len(values)
    mean = float(values.mean())
    if count < 2:
        return Mean(count, mean, math.nan, math.nan, math.nan)
    deviation = float(values.std(ddof=1))
    if deviation <= 1e-12 * abs(mean):
        return Mean(count, mean, deviation, mean, mean)
    if count < FEWEST_FOR_BOOTSTRAP:
        half = float(stats.t.ppf(0.5 * (1.0 + CONFIDENCE), count - 1)) * deviation
        half /= math.sqrt(count)
        return Mean(count, mean, deviation, mean - half, mean + half)
    found = stats.bootstrap(
        (values,),
        np.mean,
        confidence_level=CONFIDENCE,
        n_resamples=_RESAMPLES,
        random_state=np.random.default_rng(_SEED),
    ).confidence_interval
    return Mean(count, mean, deviation, float(found.low), float(found.high))


# --- percentiles ---


def percentiles(values: FloatArray, shares: Sequence[float]) -> list[Percentile]:
    """Return percentiles of a sample with their 95 % intervals.

    Parameters
    ----------
    values : array of float, shape (n,)
        The sample.
    shares : sequence of float
        Parts of the population; those that the sample does not bear are left out.
    """
    ordered = np.sort(values)
    return [percentile(ordered, share) for share in borne(shares, len(values))]


@dataclass(frozen=True)
class Exceedance:
    """Probability with which a value is exceeded.

    Attributes
    ----------
    values : array of float, shape (n,)
        In ascending order.
    probability, low, high : array of float, shape (n,)
        That a value is exceeded, with the bounds of the pointwise 95 % interval.
    """

    values: FloatArray
    probability: FloatArray
    low: FloatArray
    high: FloatArray


def exceedance(values: FloatArray) -> Exceedance:
    """Return the curve of exceedance of a sample.

    The band is Greenwood's on the log-log scale, which stays between 0 and 1 (scipy.stats.ecdf); it
    has no bounds where all or none of the values are exceeded.

    Parameters
    ----------
    values : array of float, shape (n,)
        The sample.
    """
    from scipy import stats

    curve = stats.ecdf(values).sf
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # at the ends there is no interval
        band = curve.confidence_interval(CONFIDENCE, method="log-log")
    return Exceedance(
        curve.quantiles, curve.probabilities, band.low.probabilities, band.high.probabilities
    )


# --- sensitivity ---


@dataclass(frozen=True)
class FactorSpread:
    """Means of a metric over the groups of one factor.

    Attributes
    ----------
    factor : str
        Name of the factor.
    groups : sequence of str
        Its levels, or thirds of the sample.
    means : sequence of Mean
        Of each group.
    """

    factor: str
    groups: Sequence[str]
    means: Sequence[Mean]

    @property
    def low(self) -> float:
        """Smallest mean of a group."""
        return min(mean.value for mean in self.means)

    @property
    def high(self) -> float:
        """Largest mean of a group."""
        return max(mean.value for mean in self.means)


def spreads(records: StudyRecords, metric: str) -> list[FactorSpread]:
    """Return the spread of a metric over each factor, the largest first.

    Parameters
    ----------
    records : StudyRecords
        Of the study.
    metric : str
        Identifier.

    Returns
    -------
    list of FactorSpread
        Means over the levels of each factor, whatever the others are; of a factor without levels,
        over the thirds of the sample with its lowest, middle and highest values.
    """
    found = []
    for factor in records.factors:
        groups = [
            (name, mean_of(values))
            for name, runs in _groups(records, factor)
            if len(values := values_of(runs, metric))
        ]
        if len(groups) > 1:
            found.append(FactorSpread(factor.name, [g for g, _ in groups], [m for _, m in groups]))
    return sorted(found, key=lambda spread: spread.low - spread.high)


def _groups(records: StudyRecords, factor: Factor) -> list[tuple[str, list[StudyRun]]]:
    """Return the complete runs by the level of a factor, or by thirds of its values."""
    runs = [run for run in records.sample if factor.name in run.inputs]
    levels = list(dict.fromkeys(run.inputs[factor.name] for run in runs))
    if factor.levels() or len(levels) <= 3:
        named = {level: [r for r in runs if r.inputs[factor.name] == level] for level in levels}
        return [(level_text(level, factor.unit), listed) for level, listed in named.items()]
    runs.sort(key=lambda run: float(run.inputs[factor.name]))
    thirds = np.array_split(np.arange(len(runs)), 3)
    return [
        (f"{name} third", [runs[i] for i in places])
        for name, places in zip(("lowest", "middle", "highest"), thirds, strict=True)
    ]


def level_text(level: object, unit: str) -> str:
    """Write a level with its unit."""
    if isinstance(level, str) or unit == "1":
        return str(level)
    return f"{level:.4g} {unit}"


@dataclass(frozen=True)
class Rank:
    """Rank correlation of a factor with a metric.

    Attributes
    ----------
    factor : str
        Name of the factor.
    correlation : float
        Spearman's, from -1 to 1.
    low, high : float
        Bounds of its 95 % interval.
    """

    factor: str
    correlation: float
    low: float
    high: float

    @property
    def is_clear(self) -> bool:
        """Whether the interval does not hold 0."""
        return self.low > 0.0 or self.high < 0.0


def ranks(records: StudyRecords, metric: str) -> list[Rank]:
    """Return Spearman's rank correlation of each factor with a metric, the strongest first.

    The interval is Fisher's, with the variance (1 + r^2 / 2) / (n - 3) of Bonett and Wright 2000,
    Psychometrika 65, 23-28.

    Parameters
    ----------
    records : StudyRecords
        Of the study.
    metric : str
        Identifier.

    Returns
    -------
    list of Rank
        Empty of fewer than 10 runs; factors with words have no ranks.
    """
    found = []
    for factor in records.factors:
        runs = [r for r in records.sample if metric in r.metrics and factor.name in r.inputs]
        inputs = [run.inputs[factor.name] for run in runs]
        if len(runs) < FEWEST_FOR_RANKS or any(isinstance(value, str) for value in inputs):
            continue
        rank = _rank(factor.name, np.array(inputs, float), values_of(runs, metric))
        found += [rank] if rank else []
    return sorted(found, key=lambda rank: -abs(rank.correlation))


def _rank(name: str, inputs: FloatArray, values: FloatArray) -> Rank | None:
    """Return the rank correlation of two columns; None where one of them does not vary."""
    from scipy import stats

    if not np.ptp(inputs) or not np.ptp(values):
        return None
    correlation = float(stats.spearmanr(inputs, values).statistic)
    inside = max(-1.0 + 1e-12, min(1.0 - 1e-12, correlation))
    error = math.sqrt((1.0 + 0.5 * correlation**2) / (len(values) - 3))
    half = float(stats.norm.ppf(0.5 * (1.0 + CONFIDENCE))) * error
    centre = math.atanh(inside)
    return Rank(name, correlation, math.tanh(centre - half), math.tanh(centre + half))


@dataclass(frozen=True)
class SobolIndex:
    """Share of the variance of a metric that a factor makes.

    Attributes
    ----------
    factor : str
        Name of the factor.
    first, total : float
        Alone, and with all that it does together with others.
    first_low, first_high, total_low, total_high : float
        Bounds of their 95 % intervals.
    """

    factor: str
    first: float
    first_low: float
    first_high: float
    total: float
    total_low: float
    total_high: float


def sobol_table(records: StudyRecords, metric: str) -> list[SobolIndex]:
    """Return the Sobol indices of a metric, the largest total one first.

    Source: Saltelli et al. 2010, by scipy.stats.sobol_indices; intervals by its bootstrap. Over
    several packings, the metric is its mean.

    Parameters
    ----------
    records : StudyRecords
        Of a Sobol design.
    metric : str
        Identifier.

    Returns
    -------
    list of SobolIndex
        Empty where the sample is too small, a run has no result, or the metric does not vary.
    """
    from scipy import stats

    means = {
        number: float(values_of([run for run in runs if run.is_complete], metric).mean())
        for number, runs in records.points
        if all(metric in run.metrics for run in runs)
    }
    roles = {number: runs[0].role for number, runs in records.points}
    columns = {
        role: np.array([means[n] for n, its in roles.items() if its == role and n in means])
        for role in (FIRST, SECOND, *(f"{MIXED}{i}" for i in range(len(records.factors))))
    }
    count = sum(role == FIRST for role in roles.values())
    whole = all(len(column) == count for column in columns.values())
    if count < FEWEST_FOR_SOBOL or not whole or not np.ptp(columns[FIRST]):
        return []
    mixed = np.stack([columns[f"{MIXED}{i}"] for i in range(len(records.factors))])
    found = stats.sobol_indices(
        func={
            "f_A": columns[FIRST][np.newaxis],
            "f_B": columns[SECOND][np.newaxis],
            "f_AB": mixed[:, np.newaxis],
        },
        n=count,
        random_state=np.random.default_rng(_SEED),
    )
    return _indices(records.factors, found)


def _indices(factors: Sequence[Factor], found: object) -> list[SobolIndex]:
    """Return the indices of scipy with their intervals, in order."""
    boot = found.bootstrap(confidence_level=CONFIDENCE, n_resamples=_RESAMPLES)  # type: ignore[attr-defined]
    parts = []
    for which in ("first_order", "total_order"):
        interval = getattr(boot, which).confidence_interval
        columns = (getattr(found, which), interval.low, interval.high)
        parts.append([np.atleast_1d(np.squeeze(column)) for column in columns])
    rows = [
        SobolIndex(factor.name, *(float(column[i]) for part in parts for column in part))
        for i, factor in enumerate(factors)
    ]
    return sorted(rows, key=lambda index: -index.total)
