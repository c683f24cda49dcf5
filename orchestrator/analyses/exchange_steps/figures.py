"""Figures that are followed from step to step: metrics of the runs, and variables over time."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from ...core.results.metric import identifier
from ...metrics import names
from ...metrics.energy import largest
from ...runs.batch import metrics_of
from ...runs.outcome import Outcome, digests_of
from ...runs.run import Run
from ..frame import FloatArray
from ..study.headline import FIRST, MOST_OTHERS, UTILISATION, is_main
from .orders import Convergence, converged, halvings_for

_ASIDE = ("coupling_", "wall_time")
"""Begin the identifiers of energies of interfaces, which stand beside the steps, and of what a run
takes."""
_MARGIN = 0.1
"""Part of the accuracy within which values lie that come together in no order, and not around one
value either, to count as that near."""


@dataclass(frozen=True)
class Level:
    """A run with one exchange step.

    Attributes
    ----------
    step : float
        Exchange step (s).
    component_steps : mapping of str to float
        Steps (s) of the components that have their own.
    exchanges : int
        Their number.
    residual, coupling : float or None
        Energy (J) that the system, and that its couplings together, have made, where its amount is
        largest; None where it is not accounted for.
    values : mapping of str to (str, float, str)
        Metrics: name, value and unit (SI) by identifier.
    curves : mapping of str to array of float, shape (rows,)
        Variables that are watched.
    units : mapping of str to str
        Of these.
    wall_time : float
        Seconds.
    warnings : tuple of str
        Of the run.
    """

    step: float
    component_steps: Mapping[str, float]
    exchanges: int
    residual: float | None
    coupling: float | None
    values: Mapping[str, tuple[str, float, str]]
    curves: Mapping[str, FloatArray]
    units: Mapping[str, str]
    wall_time: float
    warnings: tuple[str, ...] = ()


def outcome_of(run: Run, watch: Sequence[str], wall_time: float) -> Outcome:
    """Return what is kept of a run.

    Parameters
    ----------
    run : Run
        Complete.
    watch : sequence of str
        Recorded variables.
    wall_time : float
        Of the run (s).
    """
    numbers = metrics_of(run)
    facts = {
        "length": float(run.time[-1] - run.time[0]),
        "residual": numbers.get(names.RESIDUAL),
        "coupling": _made_by_couplings(run),
        "curve_units": {name: run[name].unit for name in watch},
    }
    return Outcome(
        "",  # one of its kind in its file
        run.status,
        metrics=numbers,
        series={name: np.array(run.series[name], dtype=np.float64) for name in watch},
        options=facts,
        fmus=digests_of(run),
        wall_time=wall_time,
        units={metric.name: metric.unit for metric in run.metrics.values()},
        warnings=tuple(run.warnings),
    )


def level_of(outcome: Outcome, steps: Mapping[str, float]) -> Level:
    """Return the level of the ladder that a run is.

    Parameters
    ----------
    outcome : Outcome
        From :func:`outcome_of`.
    steps : mapping of str to float
        Its exchange step under ``""``, and the steps (s) of components that have their own.
    """
    values = {
        identifier(name): (name, value, outcome.units.get(name, "1"))
        for name, value in outcome.metrics.items()
    }
    return Level(
        steps[""],
        {name: step for name, step in steps.items() if name},
        round(outcome.options["length"] / steps[""]),
        outcome.options["residual"],
        outcome.options["coupling"],
        values,
        outcome.series,
        outcome.options["curve_units"],
        outcome.wall_time,
        outcome.warnings,
    )


def _made_by_couplings(run: Run) -> float | None:
    """Return the largest energy (J) that all couplings together have made."""
    parts: list[Any] = [
        values
        for name, values in run.series.items()
        if name.startswith("coupling.") and name.endswith(".energy")
    ]
    return largest(np.sum(parts, axis=0)) if parts else None


@dataclass(frozen=True)
class Figure:
    """A figure over the steps.

    Attributes
    ----------
    name : str
        In words.
    unit : str
        SI.
    differences : tuple of float
        From each step to the next finer one.
    scale : float
        Size of which errors are a part.
    values : tuple of float
        At each step; empty of a distance between curves.
    """

    name: str
    unit: str
    differences: tuple[float, ...]
    scale: float
    values: tuple[float, ...] = ()

    @cached_property
    def found(self) -> Convergence:
        """Order of convergence, and error at each step."""
        return converged(self.differences, self.scale)

    @property
    def limit(self) -> float | None:
        """Richardson's estimate for the step 0; None without an order, or of distances."""
        if not self.values or not self.found.is_known:
            return None
        return self.values[-1] - self.found.errors[-1]

    @property
    def spread(self) -> float:
        """Largest difference of the last three steps, as a part of the size."""
        return self._width(len(self.differences) - 2) / self.scale if self.scale else math.nan

    def share(self, level: int) -> float | None:
        """Return the estimated error at a step, as a part of the size; None if unknown."""
        if not self.found.is_known:
            return None
        return self.found.errors[level] / self.scale if self.scale else 0.0

    def halvings(self, accuracy: float) -> int | None:
        """Return the halvings of the coarsest step that an accuracy takes, if that is known.

        Values without an order have it as far as can be seen where they scatter by less than the
        accuracy, or change on and on by less than a tenth of it.
        """
        most = accuracy * self.scale
        if not self.found.reason:
            return halvings_for(self.found, most)
        return self._last_within(most if self.found.scatters else _MARGIN * most)

    def _last_within(self, most: float) -> int | None:
        """Return the first of the last steps, three at least, whose values are so near."""
        near = (self._width(level) <= most for level in range(len(self.differences) - 1))
        return next((level for level, is_near in enumerate(near) if is_near), None)

    def _width(self, level: int) -> float:
        """Return how far the values from a step on lie apart."""
        tail = self.values[level:]
        return max(tail) - min(tail) if tail else sum(self.differences[level:])


def figures(levels: Sequence[Level], watch: Sequence[str], metrics: Sequence[str]) -> list[Figure]:
    """Return everything that is followed.

    Parameters
    ----------
    levels : sequence of Level
        From coarse to fine.
    watch : sequence of str
        Variables over time.
    metrics : sequence of str
        Identifiers of metrics.
    """
    of_metrics = (_of_metric(levels, name) for name in metrics)
    return [*of_metrics, *(figure for name in watch for figure in _of_curve(levels, name))]


def told_first(levels: Sequence[Level]) -> list[str]:
    """Return the identifiers of the metrics that are followed where none are named.

    What a designer asks for first; of another system, the first metrics that vary.

    Parameters
    ----------
    levels : sequence of Level
        From coarse to fine.
    """
    known = levels[-1].values
    found = [name for name in FIRST if name in known]
    found += [name for name in known if name.startswith(UTILISATION)]
    if found:
        return found
    varying = [
        name
        for name, (_, value, _) in known.items()
        if is_main(name)
        and not name.startswith(_ASIDE)
        and any(level.values.get(name, ("", value))[1] != value for level in levels)
    ]
    return varying[:MOST_OTHERS]


def _of_metric(levels: Sequence[Level], name: str) -> Figure:
    words, _, unit = next(level.values[name] for level in levels if name in level.values)
    missing = ("", math.nan, "")
    values = tuple(float(level.values.get(name, missing)[1]) for level in levels)
    scale = max(map(abs, values)) if all(map(math.isfinite, values)) else math.nan
    return Figure(words, unit, _steps_down(values), scale, values)


def _of_curve(levels: Sequence[Level], name: str) -> Iterator[Figure]:
    """Yield the largest difference of a variable over time, and its last value."""
    curves = [level.curves[name] for level in levels]
    unit = levels[-1].units[name]
    scale = float(np.abs(curves[-1]).max())
    apart = [float(np.abs(a - b).max()) for a, b in pairwise(curves)]
    yield Figure(f"{name}, largest difference", unit, tuple(apart), scale)
    values = tuple(float(curve[-1]) for curve in curves)
    yield Figure(f"{name}, last value", unit, _steps_down(values), scale, values)


def _steps_down(values: Sequence[float]) -> tuple[float, ...]:
    return tuple(coarse - fine for coarse, fine in pairwise(values))
