"""Files of a rockfall campaign.

====================  ==========================================================================
run.json              name, status, site, materials with their sources, versions, wall time
summary.json          list of {name, value, unit}, as of any run: ends, lines, barriers
trials.parquet        a row for each trial: end, largest values, first passage of each line
envelopes.parquet     largest values and percentiles along the profile; the same as envelopes.csv
trajectories.parquet  on request: a row for each event of a trial, with the accelerations after it
figures/              pictures
====================  ==========================================================================
"""

import platform
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.records import KNOT, OUTCOME, PASSAGE, PEAK, ROCK

from ..core.results.columns import ArrowColumn, result_column, result_table
from ..core.results.metric import Metric
from ..core.results.run_folder import RUN, SUMMARY
from ..files import write_json
from ..metrics.percentiles import CONFIDENCE
from ..sites.rockfall.materials import described
from ..sites.rockfall.preparation import PreparedSlope
from ..sites.rockfall.profile import surface
from ..versions import versions
from .campaign import Campaign, TrialRecords
from .passages import ENDS
from .statistics import envelope

TRIALS, ENVELOPES, ENVELOPES_CSV = "trials.parquet", "envelopes.parquet", "envelopes.csv"
ALONG = (("height", PEAK.height, "m"), ("speed", PEAK.speed, "m/s"), ("energy", PEAK.kinetic, "J"))
"""Name, column and unit of the quantities that have an envelope."""
_PACKAGES = ("numpy", "numba", "scipy", "pyarrow")

Envelopes = Mapping[str, Mapping[str, NDArray[np.float64]]]
"""Curves (stations,) by quantity, and by ``max``, ``p50``, ..."""


def envelopes(records: TrialRecords) -> Envelopes:
    """Return the largest values and percentiles at the stations, over the rocks that come by."""
    return {name: envelope(records.peaks[:, :, column]) for name, column, _ in ALONG}


def write_tables(trials: Any, along: Any, folder: Path) -> list[Path]:
    """Write the tables of a campaign.

    Parameters
    ----------
    trials, along : pyarrow.Table
        Of the trials and of the envelopes.
    folder : Path
        Exists.

    Returns
    -------
    list of Path
        Of the files.
    """
    import pyarrow.csv
    import pyarrow.parquet

    words = ["end", "barrier"]  # nearly all numbers of the other columns are different
    pyarrow.parquet.write_table(trials, folder / TRIALS, compression="zstd", use_dictionary=words)
    pyarrow.parquet.write_table(along, folder / ENVELOPES, compression="zstd")
    pyarrow.csv.write_csv(along, folder / ENVELOPES_CSV)
    return [folder / name for name in (TRIALS, ENVELOPES, ENVELOPES_CSV)]


def write_facts(
    slope: PreparedSlope, metrics: Sequence[Metric], facts: Mapping[str, Any], folder: Path
) -> list[Path]:
    """Write the summary and then ``run.json``, which marks the folder as complete.

    Parameters
    ----------
    slope : PreparedSlope
        That was computed.
    metrics : sequence of Metric
        Of the campaign.
    facts : mapping of str to Any
        Further entries of ``run.json``.
    folder : Path
        Exists.

    Returns
    -------
    list of Path
        Of the files.
    """
    write_json(folder / SUMMARY, [metric.as_entry() for metric in metrics])
    file = slope.source.file
    nodes = [{"x": node.x, "y": node.y, "material": node.material} for node in slope.nodes]
    content = {
        "status": "complete",
        "kind": "rockfall",
        "name": slope.name,
        "ended": datetime.now(UTC).isoformat(timespec="seconds"),
        "site_file": str(file) if file else None,
        "site": slope.site.model_dump(mode="json", by_alias=True),
        "warnings": list(slope.warnings),
        "materials": {name: described(material) for name, material in slope.materials.items()},
        "nodes": nodes,
        "confidence": CONFIDENCE,
        **facts,
        "platform": platform.platform(),
        "versions": versions(*_PACKAGES),
    }
    write_json(folder / RUN, content)
    return [folder / SUMMARY, folder / RUN]


# --- the table of the trials ---

AT_END = (
    ("x", OUTCOME.x, "m", "place of the centre at the end, to the right"),
    ("y", OUTCOME.y, "m", "the same, upwards"),
    ("time", OUTCOME.time, "s", "time at the end"),
    ("largest.height", OUTCOME.height, "m", "height above the slope, normal to it"),
    ("largest.speed", OUTCOME.speed, "m/s", "speed"),
    ("largest.energy", OUTCOME.kinetic, "J", "kinetic energy"),
    ("limit_speed", OUTCOME.limit_speed, "m/s", "V_lim of the trial"),
)
"""Name, column of the outcomes, unit and description of the values of a whole trial."""
NUMBERS = (
    ("impacts", OUTCOME.impacts, "number of impacts"),
    ("events", OUTCOME.events, "number of impacts and changes of motion"),
)
"""Name, column of the outcomes and description of the numbers of a whole trial."""
AT_PASSAGE = (
    ("time", PASSAGE.time, "s"),
    ("x", PASSAGE.x, "m"),
    ("y", PASSAGE.y, "m"),
    ("height", PASSAGE.height, "m"),
    ("speed", PASSAGE.speed, "m/s"),
    ("velocity.x", PASSAGE.vx, "m/s"),
    ("velocity.y", PASSAGE.vy, "m/s"),
    ("angular_velocity", PASSAGE.omega, "rad/s"),
    ("energy", PASSAGE.kinetic, "J"),
)
"""Name, column of the passages and unit of the values at a line."""


OF_THE_ROCK = (
    ("rock.mass", ROCK.mass, "kg"),
    ("rock.radius", ROCK.radius, "m"),
    ("rock.elongation", ROCK.elongation, "1"),
    ("start.x", ROCK.x, "m"),
    ("start.y", ROCK.y, "m"),
    ("start.velocity.x", ROCK.vx, "m/s"),
    ("start.velocity.y", ROCK.vy, "m/s"),
    ("start.angular_velocity", ROCK.omega, "rad/s"),
    ("start.angle", ROCK.angle, "rad"),
)
"""Name, column of the rocks and unit of the values that differ from trial to trial."""


def trial_table(
    campaign: Campaign, records: TrialRecords, rocks: NDArray[np.float64] | None = None
) -> Any:
    """Return a row for each trial.

    Parameters
    ----------
    campaign : Campaign
        With the names of the lines.
    records : TrialRecords
        Of all its trials.
    rocks : array of float, shape (trials, len(ROCK)), optional
        Rock of each trial, where they differ.

    Returns
    -------
    pyarrow.Table
        A value that a trial does not have, as of a line that is not passed, is null.
    """
    outcomes = records.outcomes
    columns = [*_end_columns(campaign, outcomes)]
    for name, column, unit, words in AT_END:
        columns.append(result_column(name, outcomes[:, column], unit, words))
    for name, column, words in NUMBERS:
        columns.append(result_column(name, outcomes[:, column].astype(np.int64), "1", words))
    if rocks is not None:
        columns += _rock_columns(rocks)
    for i, name in enumerate(campaign.names):
        columns += _passage_columns(name, records.passages[:, i])
    return result_table(columns)


def _rock_columns(rocks: NDArray[np.float64]) -> Iterator[ArrowColumn]:
    for name, column, unit in OF_THE_ROCK:
        words = name.replace(".", " ").replace("_", " ")
        yield result_column(name, rocks[:, column], unit, f"{words} of this trial")


def _end_columns(campaign: Campaign, outcomes: NDArray[np.float64]) -> Iterator[ArrowColumn]:
    import pyarrow as pa

    numbers = np.searchsorted(list(ENDS), outcomes[:, OUTCOME.end]).astype(np.int32)
    ends = pa.DictionaryArray.from_arrays(numbers, list(ENDS.values()))
    by = outcomes[:, OUTCOME.barrier].astype(np.int32)
    names = pa.array(list(campaign.names), pa.string())
    barriers = pa.DictionaryArray.from_arrays(pa.array(by, mask=by < 0), names)
    words = "number of the trial: it replays by itself"
    yield result_column("trial", np.arange(campaign.trials), "1", words)
    yield result_column("end", ends, "1", "how the trial ended")
    yield result_column("barrier", barriers, "1", "the barrier that stopped it")


def _passage_columns(line: str, rows: NDArray[np.float64]) -> Iterator[ArrowColumn]:
    count = rows[:, PASSAGE.count].astype(np.int64)
    yield result_column(f"{line}.passages", count, "1", f"passages of {line}")
    for name, column, unit in AT_PASSAGE:
        values = np.where(count > 0, rows[:, column], np.nan)
        words = f"{name} at the first passage of {line}"
        yield result_column(f"{line}.{name}", values, unit, words)


# --- the table of the envelopes ---


def envelope_table(
    slope: PreparedSlope, campaign: Campaign, records: TrialRecords, along: Envelopes
) -> Any:
    """Return a row for each station along the profile.

    Parameters
    ----------
    slope : PreparedSlope
        With the profile.
    campaign : Campaign
        With the stations.
    records : TrialRecords
        Of all its trials.
    along : Envelopes
        Of these records.

    Returns
    -------
    pyarrow.Table
        Height of the profile, number of rocks that come by, and the curves.
    """
    stations = campaign.stations
    heights = [surface(slope.nodes, x) for x in stations]
    passing = (records.peaks[:, :, 0] >= 0.0).sum(axis=0)
    columns = [
        result_column("x", stations, "m", "place of the station"),
        result_column("surface", heights, "m", "height of the profile there"),
        result_column("passing", passing, "1", "trials whose rock comes by"),
    ]
    for name, _, unit in ALONG:
        for which, values in along[name].items():
            part = "largest" if which == "max" else f"{which[1:]} %"
            words = f"{name}: {part} of the rocks that come by"
            columns.append(result_column(f"{name}.{which}", values, unit, words))
    return result_table(columns)


# --- the table of the trajectories ---

TRAJECTORIES = "trajectories.parquet"
AT_EVENT = (
    ("time", KNOT.time, "s", "time of the event"),
    ("position.x", KNOT.x, "m", "place of the centre, to the right"),
    ("position.y", KNOT.y, "m", "the same, upwards"),
    ("angle", KNOT.angle, "rad", "angle, counter-clockwise"),
    ("velocity.x", KNOT.vx, "m/s", "velocity just after the event, to the right"),
    ("velocity.y", KNOT.vy, "m/s", "the same, upwards"),
    ("angular_velocity", KNOT.omega, "rad/s", "angular velocity, counter-clockwise"),
    ("acceleration.x", KNOT.ax, "m/s2", "acceleration until the next event, to the right"),
    ("acceleration.y", KNOT.ay, "m/s2", "the same, upwards"),
    ("angular_acceleration", KNOT.alpha, "rad/s2", "angular acceleration until the next event"),
)
"""Name, column, unit and description of the values of an event."""


def trajectory_table(knots: Sequence[NDArray[np.float64]], modes: Sequence[str]) -> Any:
    """Return a row for each event of trials 0, 1, ...

    Parameters
    ----------
    knots : sequence of array of float, shape (n, len(KNOT))
        Events of each trial.
    modes : sequence of str
        Modes of motion in words.

    Returns
    -------
    pyarrow.Table
        Between two rows the accelerations are constant: x(t) = x + v t + a t^2 / 2.
    """
    import pyarrow as pa

    every = np.concatenate(knots)
    numbers = np.repeat(np.arange(len(knots)), [len(rows) for rows in knots])
    kinds = pa.DictionaryArray.from_arrays(
        pa.array(every[:, KNOT.mode].astype(np.int32) - 1), list(modes)
    )
    columns = [result_column("trial", numbers, "1", "number of the trial")]
    for name, column, unit, words in AT_EVENT:
        columns.append(result_column(name, every[:, column], unit, words))
    columns.append(result_column("mode", kinds, "1", "motion until the next event"))
    cells = every[:, KNOT.cell].astype(np.int64)
    columns.append(result_column("cell", cells, "1", "number of the cell below, from 1"))
    return result_table(columns)


def write_trajectories(table: Any, folder: Path) -> Path:
    """Write the table of the trajectories into a folder that exists, and return the file."""
    import pyarrow.parquet

    pyarrow.parquet.write_table(table, folder / TRAJECTORIES, compression="zstd")
    return folder / TRAJECTORIES
