"""Files and figures of a campaign.

====================  ==================================================================================================
run.json              name, status, site, materials with their sources, seed, versions, wall time
summary.json          list of {name, value, unit}, as of any run
trials.parquet        a row for each trial; unit and description in the metadata of each field
envelopes.parquet     largest values and percentiles along the profile; the same as envelopes.csv
figures/              pictures
====================  ==================================================================================================
"""

import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.trajectory import (
    BELOW,
    OUTCOME,
    PASSAGE,
    PASSED_LEFT,
    PASSED_RIGHT,
    PEAK,
    RESTED,
    STOPPED,
    UNFINISHED,
)

from ...core.results.columns import result_column, result_table
from ...core.results.metric import Metric
from ...core.results.run_folder import RUN, SUMMARY
from ...files import write_json
from ...sites.rockfall.materials import described
from ...sites.rockfall.profile import surface
from ...versions import versions
from .campaign import Campaign, Records
from .preparation import Prepared
from .statistics import CONFIDENCE, SHARES, Percentile, envelope, percentile, proportion

TRIALS, ENVELOPES, ENVELOPES_CSV = "trials.parquet", "envelopes.parquet", "envelopes.csv"
ENDS = {
    RESTED: "at rest",
    PASSED_RIGHT: "beyond the right end",
    PASSED_LEFT: "beyond the left end",
    UNFINISHED: "unfinished",
    BELOW: "started below the surface",
    STOPPED: "stopped by a barrier",
}
"""How a trial ends, in words."""
_PACKAGES = ("numpy", "numba", "scipy", "pyarrow")


@dataclass(frozen=True)
class Quantity:
    """What is kept of a passage: its column, name, unit, and the unit in which a person reads it with its size."""

    column: int
    name: str
    unit: str
    shown: str
    scale: float


QUANTITIES = (
    Quantity(PASSAGE.kinetic, "energy", "J", "kJ", 1e3),
    Quantity(PASSAGE.height, "height", "m", "m", 1.0),
    Quantity(PASSAGE.speed, "speed", "m/s", "m/s", 1.0),
    Quantity(PASSAGE.omega, "angular_speed", "rad/s", "rad/s", 1.0),
)
"""In the order of the reports. height: of the rock above the cell below it, along its normal. The angular speed has no sign."""
ALONG = (("height", PEAK.height, "m"), ("speed", PEAK.speed, "m/s"), ("energy", PEAK.kinetic, "J"))
"""Quantities that have an envelope."""


@dataclass(frozen=True)
class Passing:
    """The rocks that pass a search line or barrier, each at its first passage.

    values: by name of the quantity, of the rocks that pass, in ascending order. share, low, high: part of all trials, with its
    interval. barrier: None for a search line; else how many were stopped, and passed below its reach or above it.
    """

    name: str
    count: int
    share: float
    low: float
    high: float
    values: dict[str, NDArray[np.float64]]
    barrier: dict[str, int] | None = None

    def percentiles(self, quantity: str) -> list[Percentile]:
        """Of the rocks that pass; empty if none does."""
        return [percentile(self.values[quantity], share) for share in SHARES] if self.count else []


def passings(given: Campaign, records: Records) -> list[Passing]:
    """Every search line and barrier, in their order."""
    return [_passing(given, records, i) for i in range(len(given.lines))]


def _passing(given: Campaign, records: Records, i: int) -> Passing:
    passed = records.passages[:, i, PASSAGE.count] > 0.0
    rows, count = records.passages[passed, i], int(passed.sum())
    low, high = proportion(count, given.trials)
    barrier = _barrier(given, records, i, passed) if given.barriers[i, 0] >= 0.0 else None
    values = {q.name: np.sort(np.abs(rows[:, q.column])) for q in QUANTITIES}
    return Passing(given.names[i], count, count / given.trials, low, high, values, barrier)


def _barrier(
    given: Campaign, records: Records, i: int, passed: NDArray[np.bool_]
) -> dict[str, int]:
    """Stopped, and of those that were not, at their first passage: overtopped, or below with too much energy."""
    stopped = records.outcomes[:, OUTCOME.barrier] == i
    away = np.hypot(
        records.passages[:, i, PASSAGE.x] - given.lines[i, 0],
        records.passages[:, i, PASSAGE.y] - given.lines[i, 1],
    )
    above = passed & ~stopped & (away > given.barriers[i, 0])
    broken = passed & ~stopped & ~above
    return {
        "stopped": int(stopped.sum()),
        "overtopped": int(above.sum()),
        "broken_through": int(broken.sum()),
    }


# --- figures ---


def figures(given: Campaign, records: Records, passed: Sequence[Passing]) -> list[Metric]:
    """The summary: how trials end, and every line and barrier with percentiles and their intervals."""
    ends = records.outcomes[:, OUTCOME.end].astype(int)
    found = [
        Metric("trials", given.trials),
        *(
            Metric(f"end.{words.replace(' ', '_')}", int((ends == code).sum()))
            for code, words in ENDS.items()
        ),
        Metric("events", int(records.outcomes[:, OUTCOME.events].sum())),
    ]
    found += [
        Metric(f"largest.{name}", float(records.outcomes[:, column].max()), unit)
        for name, column, unit in (
            ("height", OUTCOME.height, "m"),
            ("speed", OUTCOME.speed, "m/s"),
            ("energy", OUTCOME.kinetic, "J"),
        )
    ]
    for passing in passed:
        found += _figures_of(passing)
    return found


def _figures_of(passing: Passing) -> Iterator[Metric]:
    prefix = f"{'line' if passing.barrier is None else 'barrier'}.{passing.name}"
    yield Metric(f"{prefix}.passing", passing.count)
    yield from (
        Metric(f"{prefix}.share{end}", value)
        for end, value in (("", passing.share), (".low", passing.low), (".high", passing.high))
    )
    yield from (
        Metric(f"{prefix}.{name}", number) for name, number in (passing.barrier or {}).items()
    )
    for quantity in QUANTITIES:
        values = passing.values[quantity.name]
        if not len(values):
            continue
        yield Metric(f"{prefix}.{quantity.name}.mean", float(values.mean()), quantity.unit)
        if len(values) > 1:
            yield Metric(
                f"{prefix}.{quantity.name}.deviation", float(values.std(ddof=1)), quantity.unit
            )
        for found in passing.percentiles(quantity.name):
            name = f"{prefix}.{quantity.name}.p{100 * found.share:.0f}"
            yield from (
                Metric(f"{name}{end}", value, quantity.unit)
                for end, value in (("", found.value), (".low", found.low), (".high", found.high))
                if value is not None
            )


def envelopes(given: Campaign, records: Records) -> dict[str, dict[str, NDArray[np.float64]]]:
    """Largest values and percentiles at the stations by quantity and name, over the rocks that come by."""
    return {name: envelope(records.peaks[:, :, column]) for name, column, _ in ALONG}


# --- files ---


def write(
    made: Prepared,
    records: Records,
    passed: Sequence[Passing],
    along: dict[str, dict[str, NDArray[np.float64]]],
    folder: Path,
    wall_time: float,
    crew: Mapping[str, Any],
) -> list[Metric]:
    """All files except the pictures; ``run.json`` comes last, with the facts of the crew. Returns the summary."""
    import pyarrow.csv
    import pyarrow.parquet

    found = figures(made.campaign, records, passed)
    pyarrow.parquet.write_table(
        _trials(made.campaign, records),
        folder / TRIALS,
        compression="zstd",
        use_dictionary=["end", "barrier"],
    )  # nearly all numbers of the others are different
    table = _envelopes(made, records, along)
    pyarrow.parquet.write_table(table, folder / ENVELOPES, compression="zstd")
    pyarrow.csv.write_csv(table, folder / ENVELOPES_CSV)
    write_json(folder / SUMMARY, [figure.as_entry() for figure in found])
    write_json(folder / RUN, _facts(made, wall_time, crew))
    return found


def _facts(made: Prepared, wall_time: float, crew: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "status": "complete",
        "kind": "rockfall",
        "name": made.name,
        "ended": datetime.now(UTC).isoformat(timespec="seconds"),
        "site_file": str(made.file),
        "site": made.site.model_dump(mode="json", by_alias=True),
        "materials": {name: described(material) for name, material in made.materials.items()},
        "nodes": [{"x": node.x, "y": node.y, "material": node.material} for node in made.nodes],
        "confidence": CONFIDENCE,
        "wall_time": wall_time,
        **crew,
        "platform": platform.platform(),
        "versions": versions(*_PACKAGES),
    }


def _trials(given: Campaign, records: Records) -> Any:
    """A row for each trial; what has no value (a line that is not passed) is null."""
    import pyarrow as pa

    outcomes = records.outcomes
    ends = np.searchsorted(list(ENDS), outcomes[:, OUTCOME.end]).astype(np.int32)
    by = outcomes[:, OUTCOME.barrier].astype(np.int32)
    barriers = pa.DictionaryArray.from_arrays(
        pa.array(by, mask=by < 0), pa.array(list(given.names), pa.string())
    )
    columns = [
        result_column(
            "trial", np.arange(given.trials), "1", "number of the trial: it replays by itself"
        ),
        result_column(
            "end",
            pa.DictionaryArray.from_arrays(ends, list(ENDS.values())),
            "1",
            "how the trial ended",
        ),
        result_column("barrier", barriers, "1", "the barrier that stopped it"),
    ]
    for name, column, unit, words in (
        ("x", OUTCOME.x, "m", "place of the centre at the end, to the right"),
        ("y", OUTCOME.y, "m", "the same, upwards"),
        ("time", OUTCOME.time, "s", "time at the end"),
        ("largest.height", OUTCOME.height, "m", "height above the slope, normal to it"),
        ("largest.speed", OUTCOME.speed, "m/s", "speed"),
        ("largest.energy", OUTCOME.kinetic, "J", "kinetic energy"),
        ("limit_speed", OUTCOME.limit_speed, "m/s", "V_lim of the trial"),
    ):
        columns.append(result_column(name, outcomes[:, column], unit, words))
    columns += [
        result_column(name, outcomes[:, column].astype(np.int64), "1", words)
        for name, column, words in (
            ("impacts", OUTCOME.impacts, "number of impacts"),
            ("events", OUTCOME.events, "number of impacts and changes of motion"),
        )
    ]
    for i, name in enumerate(given.names):
        columns += _passage_columns(name, records.passages[:, i])
    return result_table(columns)


def _passage_columns(name: str, rows: NDArray[np.float64]) -> Iterator[tuple[Any, Any]]:
    count = rows[:, PASSAGE.count].astype(np.int64)
    yield result_column(f"{name}.passages", count, "1", f"passages of {name}")
    for column, what, unit in (
        (PASSAGE.time, "time", "s"),
        (PASSAGE.x, "x", "m"),
        (PASSAGE.y, "y", "m"),
        (PASSAGE.height, "height", "m"),
        (PASSAGE.speed, "speed", "m/s"),
        (PASSAGE.omega, "angular_velocity", "rad/s"),
        (PASSAGE.kinetic, "energy", "J"),
    ):
        values = np.where(count > 0, rows[:, column], np.nan)
        yield result_column(
            f"{name}.{what}", values, unit, f"{what} at the first passage of {name}"
        )


def _envelopes(
    made: Prepared, records: Records, along: dict[str, dict[str, NDArray[np.float64]]]
) -> Any:
    stations = made.campaign.stations
    columns = [
        result_column("x", stations, "m", "place of the station"),
        result_column(
            "surface",
            [surface(list(made.nodes), x) for x in stations],
            "m",
            "height of the profile there",
        ),
        result_column(
            "passing",
            (records.peaks[:, :, 0] >= 0.0).sum(axis=0),
            "1",
            "trials whose rock comes by",
        ),
    ]
    for name, _, unit in ALONG:
        words = {which: "largest" if which == "max" else f"{which[1:]} %" for which in along[name]}
        columns += [
            result_column(
                f"{name}.{which}", values, unit, f"{name}: {words[which]} of the rocks that come by"
            )
            for which, values in along[name].items()
        ]
    return result_table(columns)
