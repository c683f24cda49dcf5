"""Tables of a study for a person."""

import math
from collections.abc import Sequence

from ...core.system.fields import Value
from ...metrics.percentiles import Percentile
from ...tables import Table, digits
from .designs import HYPERCUBE, RANDOM, SAMPLED, SOBOL
from .headline import on_screen, titled
from .records import StudyRecords, StudyRun, values_of
from .statistics import (
    Mean,
    level_text,
    mean_of,
    percentiles,
    ranks,
    sobol_table,
    spreads,
)

_MOST_ROWS = 40
"""Rows of a table on screen; the files have all."""
_MOST_COLUMNS = 3
"""Metrics in the table of the designs on screen; the files have all."""


def all_tables(
    records: StudyRecords, metrics: Sequence[str], shares: Sequence[float]
) -> list[Table]:
    """Return the tables of a study that have rows.

    Parameters
    ----------
    records : StudyRecords
        Of the study.
    metrics : sequence of str
        Identifiers of those that are told.
    shares : sequence of float
        Parts of the population whose percentiles are told.
    """
    first = [] if records.design in SAMPLED else [design_table(records, metrics)]
    pooled = [percentile_table(records, metrics, shares)] if records.design in SAMPLED else []
    sensitivity = [spread_table(records, metrics), rank_table(records, metrics)]
    if records.design == SOBOL:
        sensitivity.append(sobol_index_table(records, metrics))
    return [
        table for table in (*first, *pooled, *sensitivity, failure_table(records)) if len(table)
    ]


def design_table(records: StudyRecords, metrics: Sequence[str]) -> Table:
    """Return each point with the means of its packings."""
    others = metrics[_MOST_COLUMNS:]
    metrics = metrics[:_MOST_COLUMNS]
    headings = [*(f.name for f in records.factors), *(titled(records, m) for m in metrics)]
    table = Table(["", *headings, "runs"], right=[*headings[len(records.factors) :], "runs"])
    table.title = "means of each design"
    points = list(records.points)
    for number, runs in points[:_MOST_ROWS]:
        done = [run for run in runs if run.is_complete]
        inputs = (input_text(records, runs[0], f.name) for f in records.factors)
        cells = (_mean_cell(records, done, metric) for metric in metrics)
        table.add(str(number), *inputs, *cells, _runs_text(done, runs))
    if len(points) > _MOST_ROWS:
        table.notes.append(f"and {len(points) - _MOST_ROWS} more designs in designs.csv")
    if others:
        table.notes.append(f"{', '.join(others)}: in designs.csv")
    return table


def _runs_text(done: Sequence[StudyRun], runs: Sequence[StudyRun]) -> str:
    return str(len(done)) if len(done) == len(runs) else f"{len(done)} of {len(runs)}"


def input_text(records: StudyRecords, run: StudyRun, factor: str) -> str:
    """Return a value of a run with its unit; empty where it is that of the system."""
    value: Value | None = run.inputs.get(factor)
    unit = next(f.unit for f in records.factors if f.name == factor)
    return "" if value is None else level_text(value, unit)


def _mean_cell(records: StudyRecords, runs: Sequence[StudyRun], metric: str) -> str:
    values = values_of(runs, metric)
    if not len(values):
        return ""
    return mean_text(mean_of(values), on_screen(records.names[metric].unit)[1])


def mean_text(mean: Mean, scale: float) -> str:
    """Write a mean with its interval in brackets, where there is one."""
    if math.isnan(mean.low):
        return digits(mean.value / scale)
    low, high = digits(mean.low / scale), digits(mean.high / scale)
    return f"{digits(mean.value / scale)} [{low}, {high}]"


def percentile_table(
    records: StudyRecords, metrics: Sequence[str], shares: Sequence[float]
) -> Table:
    """Return mean, deviation and percentiles of each metric over the sample."""
    titles = [f"{100 * share:.3g} %" for share in shares]
    headings = ["mean", "±", *titles]
    table = Table(["", *headings], right=headings, title="over the sample")
    for metric in metrics:
        values = values_of(records.sample, metric)
        if not len(values):
            continue
        scale = on_screen(records.names[metric].unit)[1]
        mean = mean_of(values)
        found = {entry.share: entry for entry in percentiles(values, shares)}
        cells = [_percentile_text(found.get(share), scale) for share in shares]
        deviation = "" if math.isnan(mean.deviation) else digits(mean.deviation / scale)
        table.add(titled(records, metric), mean_text(mean, scale), deviation, *cells)
    return table


def _percentile_text(found: Percentile | None, scale: float) -> str:
    if found is None:
        return "-"
    value, low, high = (digits(x / scale) for x in (found.value, found.low, found.high))
    return f"{value} [{low}, {high}]"


def spread_table(records: StudyRecords, metrics: Sequence[str]) -> Table:
    """Return the spread of each metric over each factor, the largest first."""
    columns = ("metric", "factor", "from", "to", "spread")
    table = Table(columns, right=columns[2:], title="spread of the means over one factor")
    for metric in metrics:
        scale = on_screen(records.names[metric].unit)[1]
        for spread in spreads(records, metric):
            low, high = digits(spread.low / scale), digits(spread.high / scale)
            width = digits((spread.high - spread.low) / scale)
            table.add(titled(records, metric), spread.factor, low, high, width)
    return table


def rank_table(records: StudyRecords, metrics: Sequence[str]) -> Table:
    """Return the rank correlations, metric by metric."""
    columns = ("metric", "factor", "rank correlation")
    table = Table(columns, right=columns[2:], title="Spearman's rank correlation")
    for metric in metrics:
        for rank in ranks(records, metric):
            text = f"{rank.correlation:+.2f} [{rank.low:+.2f}, {rank.high:+.2f}]"
            table.add(records.names[metric].words, rank.factor, text)
    return table


def sobol_index_table(records: StudyRecords, metrics: Sequence[str]) -> Table:
    """Return the Sobol indices, metric by metric."""
    columns = ("metric", "factor", "first order", "total")
    table = Table(columns, right=columns[2:], title="Sobol indices: shares of the variance")
    for metric in metrics:
        for index in sobol_table(records, metric):
            first = f"{index.first:.2f} [{index.first_low:.2f}, {index.first_high:.2f}]"
            total = f"{index.total:.2f} [{index.total_low:.2f}, {index.total_high:.2f}]"
            table.add(records.names[metric].words, index.factor, first, total)
    return table


def failure_table(records: StudyRecords) -> Table:
    """Return the runs without a result, each with its reason."""
    names = [factor.name for factor in records.factors]
    table = Table(["design", *names, "packing", "reason"], title="runs without a result")
    failed = [run for run in records.runs if not run.is_complete]
    for run in failed[:_MOST_ROWS]:
        inputs = [input_text(records, run, name) for name in names]
        seed = "" if run.seed is None else str(run.seed)
        table.add(str(run.design), *inputs, seed, run.error or run.status)
    if len(failed) > _MOST_ROWS:
        table.notes.append(f"and {len(failed) - _MOST_ROWS} more in runs.csv")
    return table


def notes(records: StudyRecords, shares: Sequence[float]) -> list[str]:
    """Return the meaning of the numbers, a sentence each."""
    found = [
        "[low, high]: 95 % interval; of a mean by the bootstrap, of fewer than 10 values by "
        "Student's t"
    ]
    if records.design in SAMPLED and shares:
        found.append(
            "percentiles and their intervals are those of the order statistics, without an assumed "
            "distribution"
        )
    if records.design in (HYPERCUBE, SOBOL):
        found.append(
            "the intervals are those of independent samples; this design is usually more precise"
        )
    if records.design in SAMPLED:
        found.append("a spread is that of the means of the lowest, middle and highest third")
    packings = {run.seed for run in records.runs}
    if records.design == RANDOM and len(packings) > 1:
        found.append(f"each sample has one of {len(packings)} packings of the sand")
    return found
