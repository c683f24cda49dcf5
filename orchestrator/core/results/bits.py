"""Comparison of two runs, bit by bit."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

import numpy as np

from .reading import StoredRun

_OF_THE_CLOCK = "wall time"
"""In the name of a metric that follows from the clock and not from the system."""


@dataclass(frozen=True)
class Difference:
    """The first thing in which two runs differ.

    Attributes
    ----------
    what : str
        Name of a column, ``state of COMPONENT``, or the name of a metric.
    time : float or None
        Simulated time (s); None of a metric.
    value, again : object
        In the first run and in the second one.
    """

    what: str
    time: float | None
    value: Any
    again: Any

    def __str__(self) -> str:
        at = "" if self.time is None else f" at t = {self.time!r} s"
        return f"{self.what}{at} is {self.value}, and is {self.again} when it is run again"


def first_difference(run: StoredRun, again: StoredRun) -> Difference | None:
    """Compare rows, recorded states and texts, and metrics of two runs.

    Parameters
    ----------
    run, again : StoredRun
        Of the same system.

    Returns
    -------
    Difference or None
        The earliest difference between the rows; where there is none, the first one between the
        states, then recorded texts, then the metrics. None where every bit is the same.
    """
    return (
        _of_rows(run, again)
        or next(_of_states(run, again), None)
        or next(_of_texts(run, again), None)
        or _of_metrics(run, again)
    )


def _of_rows(run: StoredRun, again: StoredRun) -> Difference | None:
    names = [[column.name for column in each.columns] for each in (run, again)]
    if names[0] != names[1]:
        return Difference("columns", None, f"{len(names[0])} names", f"{len(names[1])} others")
    common = min(run.time.size, again.time.size)
    found = []
    for place, name in enumerate(names[0]):
        bits = [np.asarray(each.series[name][:common]).view(np.uint64) for each in (run, again)]
        rows = np.flatnonzero(bits[0] != bits[1])
        if rows.size:
            found.append((int(rows[0]), place))
    if found:
        row, place = min(found)
        name = names[0][place]
        values = [float(each.series[name][row]) for each in (run, again)]
        return Difference(name, float(run.time[row]), *map(repr, values))
    if run.time.size != again.time.size:
        return Difference("number of rows", None, run.time.size, again.time.size)
    return None


def _of_states(run: StoredRun, again: StoredRun) -> Iterator[Difference]:
    for component in run.provenance.get("components") or {}:
        both = zip_longest(run.states(component), again.states(component))
        for one, other in both:
            if one != other:
                time = (one or other)[0]
                sizes = [f"{len(each[1])} bytes" if each else "none" for each in (one, other)]
                what = f"state of {component}"
                yield Difference(what, time, sizes[0], f"{sizes[1]} with other content")


def _of_texts(run: StoredRun, again: StoredRun) -> Iterator[Difference]:
    for name in {**run.texts, **again.texts}:
        both = zip_longest(run.texts.get(name, ()), again.texts.get(name, ()))
        for one, other in both:
            if one != other:
                time = (one or other)[0]
                yield Difference(name, time, one and repr(one[1]), other and repr(other[1]))


def _of_metrics(run: StoredRun, again: StoredRun) -> Difference | None:
    """Compare the metrics that the second run has; the first one may have been given more."""
    known = {metric.name: metric.value for metric in run.metrics.values()}
    for metric in again.metrics.values():
        if _OF_THE_CLOCK not in metric.name and repr(known.get(metric.name)) != repr(metric.value):
            return Difference(metric.name, None, known.get(metric.name), metric.value)
    return None
