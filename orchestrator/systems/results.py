"""Orders, errors at equal cost and tables of the measurements of impact systems."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..tables import Table
from .bench import REFERENCE
from .catalogue import impact_system
from .jobs import NATIVE
from .masters.table import MASTERS
from .measured import MasterRun, SuiteRuns

_SMALLEST, _LARGEST = 1e-10, 0.3
"""Errors outside of these say nothing about an order: rounding, and runs that have lost the way."""
_EQUAL = 1e-12
"""Deviation (share of the largest true value) up to which values are told as the same but for
rounding."""


@dataclass(frozen=True)
class Summary:
    """One master on one system.

    Attributes
    ----------
    system, master : str
        Their names.
    stated : MasterRun
        The run with the exchange step at which the tolerance is stated.
    order : float or None
        Slope of the error over the exchange step, both logarithmic; None where there is none.
    at_equal_cost : float or None
        Error for the processor time of :func:`budget`, as :func:`error_at` tells it.
    """

    system: str
    master: str
    stated: MasterRun
    order: float | None
    at_equal_cost: float | None


def summaries(measured: SuiteRuns) -> list[Summary]:
    """Return a summary of each master on each system, from native FMUs of FMI 2.0."""
    rows = [row for row in measured.rows if row.variant == NATIVE.name]
    found = []
    for system in dict.fromkeys(row.system for row in rows):
        spent = budget(rows, system)
        for master in MASTERS:
            own = [row for row in rows if (row.system, row.master) == (system, master.name)]
            stated = [row for row in own if row.step == impact_system(system).step]
            if stated:
                entry = (order(own), error_at(own, spent))
                found.append(Summary(system, master.name, stated[0], *entry))
    return found


def order(rows: Iterable[MasterRun]) -> float | None:
    """Return the slope of the error over the mean exchange step, both logarithmic."""
    points = [
        (math.log(mean_step(row)), math.log(row.error))
        for row in rows
        if row.error is not None and _SMALLEST < row.error < _LARGEST
    ]
    if len(points) < 2:
        return None
    steps, errors = zip(*points, strict=True)
    return float(np.polyfit(steps, errors, 1)[0])


def mean_step(row: MasterRun) -> float:
    """Return the mean exchange step (s) of a run: that of an adaptive one is shorter than told."""
    return impact_system(row.system).stop_time / row.exchanges


def budget(rows: Iterable[MasterRun], system: str) -> float | None:
    """Return the processor time (s) of a system at which errors are compared.

    The median over the masters of what the run with the stated exchange step costs.
    """
    step = impact_system(system).step
    costs = [row.cost for row in rows if (row.system, row.step) == (system, step) and row.cost]
    return float(np.median(costs)) if costs else None


def error_at(rows: Sequence[MasterRun], cost: float | None) -> float | None:
    """Return the error at a processor time (s), on lines between the logarithms of the runs.

    A run that costs less than one with a longer step counts as that one: short times are noisy.
    Where all runs cost less, the error of the one with the shortest step, which more time would
    make smaller; None where all cost more.
    """
    points = [
        (math.log(row.cost), math.log(row.error))
        for row in sorted(rows, key=lambda row: -row.step)
        if row.cost and row.error and row.error < 1.0
    ]
    if cost is None or len(points) < 2:
        return None
    costs, errors = (np.array(each) for each in zip(*points, strict=True))
    costs = np.maximum.accumulate(costs)
    if math.log(cost) < costs[0]:
        return None
    last = np.append(costs[1:] > costs[:-1], True)  # of runs that count as equally expensive
    return math.exp(float(np.interp(math.log(cost), costs[last], errors[last])))


def overview(measured: SuiteRuns) -> Table:
    """Return all masters on all systems as one table."""
    titles = ("system", "master", "step, ms", "error", "order", "energy made", "us / exchange")
    table = Table((*titles, "error at equal cost", "why not"), right=titles[2:])
    for summary in summaries(measured):
        row = summary.stated
        table.add(
            summary.system,
            summary.master,
            f"{1e3 * row.step:g}",
            number(row.error),
            "-" if summary.order is None else f"{summary.order:.2f}",
            number(row.energy),
            "-" if row.cost is None else f"{1e6 * row.cost / row.exchanges:.3g}",
            number(summary.at_equal_cost),
            row.reason,
        )
    return table


def compatibility(measured: SuiteRuns) -> Table:
    """Return what runs where: each master with each kind of FMUs on each system."""
    table = Table(("tool", "version", "FMUs", "system", "result"))
    versions = {master.name: measured.versions[master.package] or "-" for master in MASTERS}
    steps = {row.system: impact_system(row.system).step for row in measured.rows}
    for row in measured.rows:
        if row.step == steps[row.system]:
            table.add(row.master, versions[row.master], row.variant, row.system, verdict(row))
    return table


def verdict(row: MasterRun) -> str:
    """Return in words how a run compares with the reference master, and with the truth."""
    if row.reason:
        return row.reason
    if row.error is None or row.error > 1.0:
        return f"runs, and is wrong: {number(row.error)}"
    if row.master == REFERENCE:
        return f"runs, error {number(row.error)}"
    if row.deviation == 0.0:
        return "equal bits"
    if row.deviation is not None and row.deviation <= _EQUAL:
        return f"equal to {row.deviation:.0e}"
    return f"runs, error {number(row.error)}"


def number(value: float | None) -> str:
    """Return a number with two digits, a dash where there is none."""
    if value is None:
        return "-"
    return "0" if value == 0.0 else f"{value:.2g}"
