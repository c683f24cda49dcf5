"""Files of a pile.

====================  ==========================================================================
run.json              name, status, site, versions, wall time
summary.json          list of {name, value, unit}, as of any run: values of each blow
traces.parquet        force, Z v, displacements at head, gauge and toe over time; as traces.csv
envelopes.parquet     largest stresses and residual force in each segment, blow by blow; as
                      envelopes.csv
bearing.parquet       a row for each ultimate resistance; as bearing.csv
drivability.parquet   a row for each penetration; as drivability.csv
rods.parquet          a row for each length of the rod of a penetration test; as rods.csv
figures/              pictures
====================  ==========================================================================
"""

import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from ...core.results.columns import result_column, result_table
from ...core.results.metric import Metric
from ...core.results.run_folder import RUN, SUMMARY
from ...files import write_json
from ...sites.pile.preparation import PreparedPile
from ...versions import versions
from .blows import TRACES, BearingPoint, Blow
from .drivability import Stage
from .rods import RodBlow
from .summary import BlowValue, blow_values, formula_values, rod_values, stage_values

_PACKAGES = ("numpy", "numba", "pyarrow")
_WORDS = {
    "head.contact_force": "force at the head, compression positive",
    "head.zv": "impedance times velocity of the head, downwards",
    "toe.contact_force": "force of the soil on the toe",
    "gauge.force": "force at the gauge",
    "gauge.zv": "impedance times velocity at the gauge",
    "head.position": "displacement of the head, downwards",
    "toe.position": "displacement of the toe, downwards",
    "toe.set": "part of it that stays",
}
"""Descriptions of the traces."""


def write_tables(tables: Mapping[str, Any], folder: Path) -> list[Path]:
    """Write tables as Parquet and as CSV.

    Parameters
    ----------
    tables : mapping of str to pyarrow.Table
        By the name of the file without its ending.
    folder : Path
        Exists.

    Returns
    -------
    list of Path
        Of the files.
    """
    import pyarrow.csv
    import pyarrow.parquet

    files = []
    for name, table in tables.items():
        files += [folder / f"{name}.parquet", folder / f"{name}.csv"]
        pyarrow.parquet.write_table(table, files[-2], compression="zstd")
        pyarrow.csv.write_csv(table, files[-1])
    return files


def write_facts(
    pile: PreparedPile, metrics: Sequence[Metric], wall_time: float, folder: Path
) -> list[Path]:
    """Write the summary and then ``run.json``, which marks the folder as complete.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    metrics : sequence of Metric
        Of the blows.
    wall_time : float
        That the blows took (s).
    folder : Path
        Exists.

    Returns
    -------
    list of Path
        Of the files.
    """
    write_json(folder / SUMMARY, [metric.as_entry() for metric in metrics])
    file = pile.source.file
    content = {
        "status": "complete",
        "kind": "pile",
        "name": pile.name,
        "ended": datetime.now(UTC).isoformat(timespec="seconds"),
        "site_file": str(file) if file else None,
        "site": (pile.given or pile.site).model_dump(mode="json", by_alias=True),
        "warnings": list(pile.warnings),
        "exchange_step": pile.step,
        "time": pile.time,
        "wall_time": wall_time,
        "platform": platform.platform(),
        "versions": versions(*_PACKAGES),
    }
    write_json(folder / RUN, content)
    return [folder / SUMMARY, folder / RUN]


def trace_table(blows: Sequence[Blow]) -> Any:
    """Return the traces of all blows, one after the other.

    Parameters
    ----------
    blows : sequence of Blow
        With traces.

    Returns
    -------
    pyarrow.Table
        Time (s) since the first stroke, number of the blow, forces (N) and displacements (m).
    """

    def joined(name: str) -> Any:
        return np.concatenate([blow.traces[name] for blow in blows])

    lengths = [len(blow.traces["time"]) for blow in blows]
    numbers = np.repeat(np.arange(len(blows)) + 1, lengths)
    columns = [
        result_column("time", joined("time"), "s", "time since the first stroke"),
        result_column("blow", numbers, "1", "number of the blow"),
    ]
    for name, unit in TRACES.items():
        columns.append(result_column(name, joined(name), unit, _WORDS[name]))
    return result_table(columns)


def envelope_table(pile: PreparedPile, blows: Sequence[Blow]) -> Any:
    """Return a row for each segment.

    Parameters
    ----------
    pile : PreparedPile
        With the depths.
    blows : sequence of Blow
        One after the other.

    Returns
    -------
    pyarrow.Table
        Depths (m), and of each blow the largest stresses (Pa) and the residual force (N).
    """
    columns = [
        result_column("top", pile.depths[:-1], "m", "depth of the segment's upper end"),
        result_column("bottom", pile.depths[1:], "m", "depth of its lower end"),
    ]
    for i, blow in enumerate(blows, 1):
        for name, values, unit, words in (
            ("compression", blow.compression, "Pa", "largest compressive stress"),
            ("tension", blow.tension, "Pa", "largest tensile stress, positive"),
            ("residual_force", blow.residual, "N", "force that is left, compression positive"),
        ):
            columns.append(result_column(f"blow.{i}.{name}", values, unit, words))
    return result_table(columns)


def bearing_table(pile: PreparedPile, graph: Sequence[BearingPoint]) -> Any:
    """Return a row for each ultimate resistance.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    graph : sequence of BearingPoint
        Of the bearing graph, one at least.

    Returns
    -------
    pyarrow.Table
        Resistance (N), and the values of the first blow; those of the last one as ``last.NAME``
        where there are several.
    """
    words = "ultimate resistance of shaft and toe"
    columns = [result_column("resistance", [point.first.resistance for point in graph], "N", words)]
    kinds = {"": [point.first for point in graph]}
    if graph[0].last is not graph[0].first:
        kinds["last."] = [point.last for point in graph]
    for prefix, blows in kinds.items():
        rows = [[*blow_values(pile, blow), *formula_values(pile, blow)] for blow in blows]
        columns += _columns(rows, prefix)
    return result_table(columns)


def drivability_table(stages: Sequence[Stage]) -> Any:
    """Return a row for each penetration.

    Parameters
    ----------
    stages : sequence of Stage
        Of the drivability analysis, one at least.

    Returns
    -------
    pyarrow.Table
        Penetration (m), resistances (N), blows, time (s), and the values of the blow.
    """
    return result_table(_columns([stage_values(stage) for stage in stages], ""))


def rods_table(rods: Sequence[RodBlow]) -> Any:
    """Return a row for each length of the rod of a penetration test.

    Parameters
    ----------
    rods : sequence of RodBlow
        One at least.

    Returns
    -------
    pyarrow.Table
        Length (m), energy ratios, set (m), N, N for 60 %, customary factor.
    """
    return result_table(_columns([rod_values(rod) for rod in rods], ""))


def _columns(rows: Sequence[Sequence[BlowValue]], prefix: str) -> list[Any]:
    """Return a column for each value, named with a prefix."""
    columns = []
    for entries in zip(*rows, strict=True):
        name = f"{prefix}{entries[0].name}"
        values = [entry.value for entry in entries]
        columns.append(result_column(name, values, entries[0].unit, name.replace("_", " ")))
    return columns
