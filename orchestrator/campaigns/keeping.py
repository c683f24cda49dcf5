"""A campaign of a shed, kept beside the run: the files of `rockshed rockfall`, and the roof.

===============  ===============================================================================
as a campaign    what ``campaigns.files`` writes; ``rockshed plot`` draws it
roof.parquet     a row for each trial: what it does at the roof, and where and how it strikes
===============  ===============================================================================
"""

import os
import time
from pathlib import Path
from typing import Any

import numpy as np

from rockshed.components.slope_rockfall.records import ARRIVAL

from ..core.results.columns import ArrowColumn, result_column, result_table
from .campaign import run
from .chosen_rock import ChosenRock
from .files import envelope_table, envelopes, trial_table, write_facts, write_tables
from .passages import line_passages
from .summary import metrics_of

ROOF = "roof.parquet"
_AT_STRIKE = (
    ("x", "m", "place of the centre as it strikes, to the right, in the frame of the profile"),
    ("velocity_x", "m/s", "velocity at the cushion's surface, to the right"),
    ("velocity_y", "m/s", "the same, downwards"),
    ("omega", "rad/s", "angular velocity there, counter-clockwise"),
    ("energy", "J", "kinetic energy there, of rotation too"),
)
"""Attribute of the strikes, unit and description of the values of a rock that strikes."""


def keep(chosen: ChosenRock, folder: Path) -> None:
    """Compute the records of a shed's campaign, and write its files.

    Parameters
    ----------
    chosen : ChosenRock
        With the campaign.
    folder : Path
        Is made.
    """
    import pyarrow.parquet

    campaign = chosen.campaign
    workers = os.cpu_count() or 1
    began = time.perf_counter()
    records = run(campaign, workers)
    facts = {"wall_time": time.perf_counter() - began, "workers": workers}
    rocks = None if campaign.rocks is None else campaign.rocks.sample(0, campaign.trials)
    along = envelope_table(chosen.slope, campaign, records, envelopes(records))
    metrics = list(metrics_of(campaign, records, line_passages(campaign, records)))
    folder.mkdir()
    write_tables(trial_table(campaign, records, rocks), along, folder)
    pyarrow.parquet.write_table(roof_table(chosen), folder / ROOF, compression="zstd")
    write_facts(chosen.slope, metrics, facts, folder)


def roof_table(chosen: ChosenRock) -> Any:
    """Return a row for each trial of a shed's campaign, null where it does not strike.

    Parameters
    ----------
    chosen : ChosenRock
        With the campaign.

    Returns
    -------
    pyarrow.Table
    """
    strikes = chosen.strikes
    trials = np.arange(strikes.trials)
    columns: list[ArrowColumn] = [
        result_column("trial", trials, "1", "number of the trial: it replays by itself"),
        result_column("comes", chosen.arrived[:, ARRIVAL.arrived] > 0.0, "1", "to the roof"),
        result_column("strikes", np.isin(trials, strikes.number), "1", "the cushion"),
    ]
    for name, unit, words in _AT_STRIKE:
        values = np.full(strikes.trials, np.nan)
        values[strikes.number] = getattr(strikes, name)
        columns.append(result_column(name, values, unit, words))
    return result_table(columns)
