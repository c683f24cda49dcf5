"""StudyRecords of the runs of a study."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...core.results.metric import identifier
from ...core.system.fields import Value
from ...runs.batch import COMPLETE, Outcome
from ..frame import FloatArray
from .designs import BASE, FIRST, SECOND
from .factors import Factor

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
_PEAK = "peak_"
"""Beginning of the identifiers of values that are largest by size, and keep their sign."""
_OF_THE_MACHINE = ("wall_time",)
"""Beginnings of the identifiers of metrics that tell of the computer, and not of the system."""


@dataclass(frozen=True)
class StudyRun:
    """A run of a study.

    Attributes
    ----------
    design : int
        Number of the point, counted from 1.
    role : str
        Of the point.
    seed : int or None
        Number of the packing; None where the system has none.
    inputs : mapping of str to Value
        By the name of the factor, in SI.
    status, error : str
        End of the run, and the reason of a failure.
    warnings : tuple of str
        Warnings of the run, and doubts about its metrics.
    metrics : mapping of str to float
        By identifier, in SI; empty of a run that is not complete.
    """

    design: int
    role: str
    seed: int | None
    inputs: Mapping[str, Value]
    status: str
    error: str = ""
    warnings: tuple[str, ...] = ()
    metrics: Mapping[str, float] = field(default_factory=dict)

    @property
    def is_complete(self) -> bool:
        """Whether the run came to its end and has metrics."""
        return self.status == COMPLETE


def metrics_by_identifier(outcome: Outcome) -> dict[str, float]:
    """Return the metrics of a run but those that tell of the computer."""
    found = {identifier(name): value for name, value in outcome.metrics.items()}
    return {key: value for key, value in found.items() if not key.startswith(_OF_THE_MACHINE)}


@dataclass(frozen=True)
class MetricName:
    """A metric that the runs of a study have.

    Attributes
    ----------
    words : str
        Name in words.
    unit : str
        SI unit, ``1`` where there is none.
    """

    words: str
    unit: str


@dataclass(frozen=True)
class StudyRecords:
    """All runs of a study, with the names of what varies and of what was found.

    Attributes
    ----------
    design : str
        Name of the design.
    factors : sequence of Factor
        That vary.
    runs : sequence of StudyRun
        In the order of the points, then of the packings.
    names : mapping of str to MetricName
        By identifier.
    """

    design: str
    factors: Sequence[Factor]
    runs: Sequence[StudyRun]
    names: Mapping[str, MetricName]

    @property
    def complete(self) -> list[StudyRun]:
        """Runs that came to their end and have metrics."""
        return [run for run in self.runs if run.is_complete]

    @property
    def sample(self) -> list[StudyRun]:
        """Complete runs of the sample; of a Sobol design without those that mix both samples."""
        return [run for run in self.complete if run.role in ("", BASE, FIRST, SECOND)]

    @property
    def points(self) -> Iterator[tuple[int, list[StudyRun]]]:
        """Number of each point with its runs."""
        found: dict[int, list[StudyRun]] = {}
        for run in self.runs:
            found.setdefault(run.design, []).append(run)
        yield from found.items()


def by_size(records: StudyRecords) -> StudyRecords:
    """Return records in which a peak whose sign differs from run to run is a size.

    At which end of a beam the largest shear force stands, and so its sign, is chance: a mean of
    both signs means nothing.
    """
    turning = {
        name
        for name in records.names
        if name.startswith(_PEAK)
        and (values := values_of(records.complete, name)).size
        and values.min() < 0.0 < values.max()
    }
    names = {
        name: MetricName(f"size of the {known.words}", known.unit) if name in turning else known
        for name, known in records.names.items()
    }
    runs = [
        replace(run, metrics={k: abs(v) if k in turning else v for k, v in run.metrics.items()})
        for run in records.runs
    ]
    return replace(records, runs=runs, names=names)


def values_of(runs: Sequence[StudyRun], metric: str) -> FloatArray:
    """Return the values of a metric of those runs that have it.

    Parameters
    ----------
    runs : sequence of StudyRun
        Complete ones.
    metric : str
        Identifier.
    """
    return np.array([run.metrics[metric] for run in runs if metric in run.metrics])


def common_reasons(runs: Sequence[StudyRun]) -> list[tuple[str, int]]:
    """Return the reasons for which runs have no result, and the number of each; commonest first.

    Reasons that differ in their numbers alone are one, which is told as the first run has it.
    """
    found: dict[str, list[str]] = {}
    for run in runs:
        if not run.is_complete:
            reason = run.error or run.status
            found.setdefault(_NUMBER.sub("#", reason), []).append(reason)
    counted = [(reasons[0], len(reasons)) for reasons in found.values()]
    return sorted(counted, key=lambda entry: -entry[1])


def plain_runs(records: StudyRecords) -> list[dict[str, Any]]:
    """Return each run as one flat row."""
    return [
        {
            "design": run.design,
            "role": run.role,
            "seed": run.seed,
            **{factor.name: run.inputs.get(factor.name) for factor in records.factors},
            "status": run.status,
            "error": run.error,
            "warnings": "\n".join(run.warnings),
            **{name: run.metrics.get(name) for name in records.names},
        }
        for run in records.runs
    ]
