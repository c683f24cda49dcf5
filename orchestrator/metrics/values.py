"""Extreme and integral of an output over the run, and metrics of several components."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from .names import of_component

Samples = NDArray[np.float64]
"""Values of a variable over time, shape (rows,)."""


def extreme(run: StoredRun, column: str) -> tuple[float, float]:
    """Return the largest value of an output and its time.

    Parameters
    ----------
    run : StoredRun
        The run.
    column : str
        ``component.output``.

    Returns
    -------
    value : float
        Over all exchanges if the run watched the output and has ended, else over the rows.
    time : float
        In s.
    """
    value, at_time = _watched(run, f"{column} maximum"), _watched(run, f"{column} maximum at")
    if value is not None and at_time is not None:
        return value, at_time
    at = int(run.series[column].argmax())
    return float(run.series[column][at]), float(run.series["time"][at])


def least(run: StoredRun, column: str) -> float:
    """Return the smallest value of an output.

    Parameters
    ----------
    run : StoredRun
        The run.
    column : str
        ``component.output``.

    Returns
    -------
    float
        Over all exchanges if the run watched the output and has ended, else over the rows.
    """
    known = _watched(run, f"{column} minimum")
    return float(run.series[column].min()) if known is None else known


def integral(run: StoredRun, column: str) -> float:
    """Return the integral of an output over the time.

    Parameters
    ----------
    run : StoredRun
        The run.
    column : str
        ``component.output``.

    Returns
    -------
    float
        Over all exchanges if the run watched the output and has ended, else over the rows.
    """
    known = _watched(run, f"{column} integral")
    if known is not None:
        return known
    values, time = run.series[column], run.series["time"]
    return float((0.5 * (values[1:] + values[:-1]) * (time[1:] - time[:-1])).sum())


def _watched(run: StoredRun, name: str) -> float | None:
    """Return what the run itself has found; None if it did not watch, or has not ended."""
    values = (metric.value for metric in run.metrics.values() if metric.name == name)
    return next((float(value) for value in values if not isinstance(value, str)), None)


def of_each(
    run: StoredRun, components: Sequence[str], measure: Callable[[StoredRun, str], Iterable[Metric]]
) -> Iterator[Metric]:
    """Yield the metrics of each component; among several, each under the name of its component.

    Parameters
    ----------
    run : StoredRun
        The run.
    components : sequence of str
        Names of the components in the system.
    measure : callable
        Gives the metrics of one component of the run.
    """
    for component in components:
        for metric in measure(run, component):
            several = len(components) > 1
            name = of_component(component, metric.name) if several else metric.name
            yield replace(metric, name=name)
