"""Files and figures of a pile.

====================  ==================================================================================================
run.json              name, status, site, versions, wall time
summary.json          list of {name, value, unit}, as of any run: figures of each blow
traces.parquet        force, Z v, displacements at head, gauge and toe over time; the same as traces.csv
envelopes.parquet     largest stresses and residual force in each segment, blow by blow; the same as envelopes.csv
bearing.parquet       a row for each ultimate resistance; the same as bearing.csv
figures/              pictures
====================  ==================================================================================================
"""

import platform
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from ...core.results.columns import Column, result_column, result_table
from ...core.results.metric import Metric
from ...core.results.run_folder import RUN, SUMMARY
from ...files import write_json
from ...versions import versions
from .blows import TRACES, Blow, blow_figures
from .preparation import Prepared

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


def figures(made: Prepared, blows: Sequence[Blow], graph: Sequence[Blow]) -> list[Metric]:
    """The summary: every blow, and the whole."""
    found = [
        Metric("blows", len(blows)),
        Metric("rated_energy", made.rated_energy, "J"),
        Metric("impact_energy", blows[0].impact_energy, "J"),
        Metric("resistance", made.resistance, "N"),
        Metric("travel_time", made.travel_time, "s"),
        Metric("penetration", sum(blow.set for blow in blows), "m"),
    ]
    for number, blow in enumerate(blows):
        found += _figures(f"blow.{number + 1}", made, blow)
    for blow in graph:
        found += _figures(f"bearing.{blow.resistance:g}", made, blow)
    return found


def _figures(prefix: str, made: Prepared, blow: Blow) -> Iterator[Metric]:
    for name, value, unit in blow_figures(made, blow):
        if value is not None:
            yield Metric(f"{prefix}.{name}", value, unit)


def write(
    made: Prepared, blows: Sequence[Blow], graph: Sequence[Blow], folder: Path, wall_time: float
) -> list[Metric]:
    """All files except the pictures; ``run.json`` comes last. Returns the summary."""
    import pyarrow.csv
    import pyarrow.parquet

    tables = {"traces": _traces(blows), "envelopes": _envelopes(made, blows)}
    if graph:
        tables["bearing"] = _bearing(made, graph)
    for name, content in tables.items():
        pyarrow.parquet.write_table(content, folder / f"{name}.parquet", compression="zstd")
        pyarrow.csv.write_csv(content, folder / f"{name}.csv")
    found = figures(made, blows, graph)
    write_json(folder / SUMMARY, [figure.as_entry() for figure in found])
    write_json(
        folder / RUN,
        {
            "status": "complete",
            "kind": "pile",
            "name": made.name,
            "ended": datetime.now(UTC).isoformat(timespec="seconds"),
            "site_file": str(made.file),
            "site": made.site.model_dump(mode="json", by_alias=True),
            "exchange_step": made.step,
            "time": made.time,
            "wall_time": wall_time,
            "platform": platform.platform(),
            "versions": versions(*_PACKAGES),
        },
    )
    return found


def _traces(blows: Sequence[Blow]) -> Any:
    def joined(name: str) -> Any:
        return np.concatenate([blow.traces[name] for blow in blows])

    numbers = np.repeat(np.arange(len(blows)) + 1, [len(blow.traces["time"]) for blow in blows])
    columns = [
        result_column("time", joined("time"), "s", "time since the first stroke"),
        result_column("blow", numbers, "1", "number of the blow"),
    ]
    return result_table(
        columns
        + [result_column(name, joined(name), unit, _WORDS[name]) for name, unit in TRACES.items()]
    )


def _envelopes(made: Prepared, blows: Sequence[Blow]) -> Any:
    columns = [
        result_column("top", made.depths[:-1], "m", "depth of the segment's upper end"),
        result_column("bottom", made.depths[1:], "m", "depth of its lower end"),
    ]
    for i, blow in enumerate(blows, 1):
        columns += [
            result_column(
                f"blow.{i}.compression", blow.compression, "Pa", "largest compressive stress"
            ),
            result_column(
                f"blow.{i}.tension", blow.tension, "Pa", "largest tensile stress, positive"
            ),
            result_column(
                f"blow.{i}.residual_force",
                blow.residual,
                "N",
                "force that is left, compression positive",
            ),
        ]
    return result_table(columns)


def _bearing(made: Prepared, graph: Sequence[Blow]) -> Any:
    listed = [dict((name, value) for name, value, _ in blow_figures(made, blow)) for blow in graph]
    units = {name: unit for name, _, unit in blow_figures(made, graph[0])}
    columns: list[Column] = [
        result_column(
            "resistance",
            [blow.resistance for blow in graph],
            "N",
            "ultimate resistance of shaft and toe",
        )
    ]
    columns += [
        result_column(name, [row[name] for row in listed], unit, name.replace("_", " "))
        for name, unit in units.items()
    ]
    return result_table(columns)
