"""Files of a study.

====================  ==========================================================================
run.json              name, status, target, factors, design, counts, versions
summary.json          list of {id, name, value, unit}: means and percentiles of the metrics
runs.parquet          a row for each run: inputs, status, metrics; the same as runs.csv
designs.csv           a row for each point and metric: mean, deviation, interval
percentiles.csv       a row for each metric and percentile over the sample, with its interval
exceedance.csv        a row for each metric and value: probability that it is exceeded, interval
sensitivity.csv       a row for each metric and factor: spread, rank correlation, Sobol indices
====================  ==========================================================================
"""

import csv
import platform
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...core.results.columns import ArrowColumn, result_column, result_table
from ...core.results.own_files import FILES
from ...core.results.run_folder import RUN, SUMMARY
from ...files import whole_file, write_json
from ...versions import versions
from .designs import SAMPLED
from .records import StudyRecords, plain_runs, values_of
from .statistics import exceedance, mean_of, percentiles, ranks, sobol_table, spreads

if TYPE_CHECKING:
    from .result import StudyResult

RUNS, RUNS_CSV = "runs.parquet", "runs.csv"
_TABLES = ("designs.csv", "percentiles.csv", "exceedance.csv", "sensitivity.csv")
PICTURES = ("tornado.png", "effects.png", "exceedance.png")
NAMES = (RUN, SUMMARY, RUNS, RUNS_CSV, *_TABLES, *PICTURES)
"""All files of a study, the pictures included."""
_PACKAGES = ("numpy", "numba", "scipy", "pyarrow", "fmpy")

Rows = Iterable[Mapping[str, Any]]


def run_table(records: StudyRecords) -> Any:
    """Return a row for each run.

    Parameters
    ----------
    records : StudyRecords
        Of the study.

    Returns
    -------
    pyarrow.Table
        DesignPoint, packing, inputs, status, and all metrics in SI; null where there is none.
    """
    return result_table(list(_columns(records)))


def _columns(records: StudyRecords) -> Iterator[ArrowColumn]:
    rows = plain_runs(records)
    words = {
        "design": "number of the point",
        "role": "role of the point in the design",
        "seed": "number of the packing",
        "status": "end of the run",
        "error": "reason of a failure",
        "warnings": "warnings and doubts, a line each",
    }
    units = {factor.name: factor.unit for factor in records.factors}
    for name in ("design", "role", "seed", *units, "status", "error", "warnings"):
        values = _of_one_kind([row[name] for row in rows])
        yield result_column(name, values, units.get(name, "1"), words.get(name, "varied"))
    for name, metric in records.names.items():
        values = [row[name] for row in rows]
        yield result_column(name, values, metric.unit, metric.words)


def _of_one_kind(values: list[Any]) -> list[Any]:
    """Return values as texts where some are words, as floats where some are no whole numbers."""
    there = [value for value in values if value is not None]
    if all(isinstance(value, int | float) for value in there):
        if any(isinstance(value, float) for value in there):
            return [None if value is None else float(value) for value in values]
        return values
    return [None if value is None else str(value) for value in values]


def write_files(result: "StudyResult", folder: Path) -> list[Path]:
    """Write all tables, and ``run.json`` last.

    Parameters
    ----------
    result : StudyResult
        The study.
    folder : Path
        Exists.

    Returns
    -------
    list of Path
        Of the files.
    """
    import pyarrow.csv
    import pyarrow.parquet

    table = result.to_arrow()
    with whole_file(folder / RUNS) as place:
        pyarrow.parquet.write_table(table, place, compression="zstd")
    with whole_file(folder / RUNS_CSV) as place:
        pyarrow.csv.write_csv(table, place)
    records, metrics = result.records, result.metric_names
    made = (
        _design_rows(records, metrics),
        _percentile_rows(records, metrics, result.shares),
        _exceedance_rows(records, metrics),
        _sensitivity_rows(records, metrics),
    )
    for name, rows in zip(_TABLES, made, strict=True):
        _write_rows(folder / name, list(rows))
    write_json(folder / SUMMARY, [metric.as_entry() for metric in result.metric_list()])
    write_json(folder / RUN, _facts(result))
    return [folder / name for name in (RUN, SUMMARY, RUNS, RUNS_CSV, *_TABLES)]


def _facts(result: "StudyResult") -> dict[str, Any]:
    records = result.records
    return {
        "status": result.status,
        "kind": result.kind,
        "name": result.name,
        "ended": datetime.now(UTC).isoformat(timespec="seconds"),
        **result.origin,
        "design": records.design,
        "factors": [factor.as_data() for factor in records.factors],
        "metrics": list(result.metric_names),
        "percentiles": list(result.asked),
        "names": {key: [name.words, name.unit] for key, name in records.names.items()},
        "warnings": result.warnings,
        **result.effort,
        "platform": platform.platform(),
        "versions": versions(*_PACKAGES),
        FILES: NAMES,
    }


def _write_rows(file: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write rows as CSV, the names of the columns in the first line; none for no row."""
    with whole_file(file) as place, place.open("w", newline="", encoding="utf-8") as text:
        names = list(rows[0]) if rows else ["empty"]
        writer = csv.DictWriter(text, names)
        writer.writeheader()
        writer.writerows(rows)


def _design_rows(records: StudyRecords, metrics: Sequence[str]) -> Iterator[dict[str, Any]]:
    for number, runs in records.points:
        done = [run for run in runs if run.is_complete]
        inputs = {factor.name: runs[0].inputs.get(factor.name) for factor in records.factors}
        for metric in metrics:
            values = values_of(done, metric)
            found = vars(mean_of(values)) if len(values) else {}
            yield {
                "design": number,
                **inputs,
                "runs": len(runs),
                "failed": len(runs) - len(done),
                "metric": metric,
                "unit": records.names[metric].unit,
                "mean": found.get("value"),
                "mean_low": found.get("low"),
                "mean_high": found.get("high"),
                "deviation": found.get("deviation"),
            }


def _percentile_rows(
    records: StudyRecords, metrics: Sequence[str], shares: Sequence[float]
) -> Iterator[dict[str, Any]]:
    if records.design not in SAMPLED:
        return
    for metric in metrics:
        values = values_of(records.sample, metric)
        for found in percentiles(values, shares):
            row = {"metric": metric, "unit": records.names[metric].unit, "runs": len(values)}
            yield {**row, **vars(found)}


def _exceedance_rows(records: StudyRecords, metrics: Sequence[str]) -> Iterator[dict[str, Any]]:
    if records.design not in SAMPLED:
        return
    for metric in metrics:
        values = values_of(records.sample, metric)
        if len(values) < 2:
            continue
        curve = exceedance(values)
        for place, value in enumerate(curve.values):
            yield {
                "metric": metric,
                "unit": records.names[metric].unit,
                "value": value,
                "probability": curve.probability[place],
                "low": curve.low[place],
                "high": curve.high[place],
            }


def _sensitivity_rows(records: StudyRecords, metrics: Sequence[str]) -> Iterator[dict[str, Any]]:
    for metric in metrics:
        correlations = {rank.factor: rank for rank in ranks(records, metric)}
        indices = {index.factor: index for index in sobol_table(records, metric)}
        for spread in spreads(records, metric):
            rank, index = correlations.get(spread.factor), indices.get(spread.factor)
            row = {"metric": metric, "unit": records.names[metric].unit, "factor": spread.factor}
            yield {
                **row,
                "low": spread.low,
                "high": spread.high,
                **_prefixed("rank", rank, ("correlation", "low", "high")),
                **_prefixed("sobol_first", index, ("first", "first_low", "first_high")),
                **_prefixed("sobol_total", index, ("total", "total_low", "total_high")),
            }


def _prefixed(prefix: str, entry: object, names: Sequence[str]) -> dict[str, Any]:
    """Return value, low and high of an entry that may be missing."""
    ends = ("", "_low", "_high")
    return {f"{prefix}{end}": getattr(entry, name, None) for end, name in zip(ends, names)}
