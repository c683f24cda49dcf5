"""A study that has been saved, read from its folder to be looked at and drawn again."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...core.results.reading import undamaged
from ...core.results.run_folder import RUN
from .factors import factor_from
from .files import RUNS
from .records import MetricName, StudyRecords, StudyRun
from .result import StudyResult

_ORIGIN = (
    *("case", "project_file", "system_file", "request"),
    *("draw", "samples", "seeds", "values", "options"),
)
_EFFORT = ("wall_time", "workers", "scheduler")


def read_study(folder: Path, content: Mapping[str, Any]) -> StudyResult:
    """Read a study.

    Parameters
    ----------
    folder : Path
        Of its results.
    content : mapping
        Of ``run.json`` there.

    Returns
    -------
    StudyResult
        As it was saved.

    Raises
    ------
    InputRefused
        The files are damaged, or do not belong together.
    """
    with undamaged(folder / RUN):
        factors = [factor_from(entry) for entry in content["factors"]]
        names = {key: MetricName(*map(str, name)) for key, name in content["names"].items()}
        told = [str(name) for name in content["metrics"]]
        shares = [float(share) for share in content["percentiles"]]
        design = str(content["design"])
        if not set(told) <= names.keys():
            raise ValueError("it tells a metric that no run has")
    with undamaged(folder / RUNS):
        inputs = [factor.name for factor in factors]
        runs = [_run(row, inputs, names) for row in _rows(folder / RUNS)]
    result = StudyResult(
        str(content["name"]),
        StudyRecords(design, factors, runs, names),
        told,
        shares,
        {key: content[key] for key in _ORIGIN if key in content},
        {key: content[key] for key in _EFFORT if key in content},
    )
    result.folder = folder
    return result


def _rows(path: Path) -> list[dict[str, Any]]:
    import pyarrow.parquet

    with pyarrow.parquet.ParquetFile(path) as file:
        rows: list[dict[str, Any]] = file.read().to_pylist()
    return rows


def _run(row: Mapping[str, Any], inputs: list[str], names: Mapping[str, MetricName]) -> StudyRun:
    return StudyRun(
        int(row["design"]),
        str(row["role"]),
        None if row["seed"] is None else int(row["seed"]),
        {name: row[name] for name in inputs if row[name] is not None},
        str(row["status"]),
        str(row["error"]),
        tuple(filter(None, str(row["warnings"]).split("\n"))),
        {name: float(row[name]) for name in names if row[name] is not None},
    )
