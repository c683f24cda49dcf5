"""A campaign that has been saved, read from its folder to be looked at and drawn again."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.trajectory import OUTCOME, PASSAGE, PEAK

from ...campaigns.campaign import Campaign, TrialRecords, campaign_of
from ...campaigns.files import ALONG, AT_END, AT_PASSAGE, ENVELOPES, NUMBERS, TRIALS, Envelopes
from ...campaigns.passages import ENDS
from ...core.results.reading import undamaged
from ...metrics.percentiles import SHARES
from ...sites.rockfall.preparation import PreparedSlope, prepare
from ..frame import FloatArray
from .result import RockfallResult

_LATER = ("velocity.x", "velocity.y")
"""Values at a line that older results do not have; they are not known then."""


def read_campaign(folder: Path, content: Mapping[str, Any]) -> RockfallResult:
    """Read a campaign.

    Parameters
    ----------
    folder : Path
        Of its results.
    content : mapping
        Of ``run.json`` there.

    Returns
    -------
    RockfallResult
        For tables and figures: the largest values at the stations are there as envelopes only.

    Raises
    ------
    InputRefused
        The files are damaged, or do not belong together.
    """
    slope = stored_slope(folder, content)
    campaign = campaign_of(slope)
    with undamaged(folder / TRIALS):
        records = _records(campaign, _columns(folder / TRIALS))
    with undamaged(folder / ENVELOPES):
        along = _envelopes(campaign, _columns(folder / ENVELOPES))
    executor = {"workers": content.get("workers")}
    wall_time = float(content.get("wall_time", 0.0))
    return RockfallResult(slope, campaign, records, wall_time, executor, along)


def stored_slope(folder: Path, content: Mapping[str, Any]) -> PreparedSlope:
    """Return the slope of saved results, with the nodes that were made of its profile.

    Parameters
    ----------
    folder : Path
        Of the results.
    content : mapping
        Of ``run.json`` there, with name, site and nodes.

    Raises
    ------
    InputRefused
        It has no such slope.
    """
    with undamaged(folder):
        nodes = content["nodes"]
        site = {
            **content["site"],
            "name": content["name"],
            "ground": [],
            "profile": {
                "points": [[node["x"], node["y"], node["material"]] for node in nodes[:-1]]
                + [[nodes[-1]["x"], nodes[-1]["y"]]],
                "end": content["site"]["profile"]["end"],
            },
        }
    return prepare(site)


def _columns(path: Path) -> Any:
    import pyarrow.parquet

    with pyarrow.parquet.ParquetFile(path) as file:
        return file.read()


def _records(campaign: Campaign, table: Any) -> TrialRecords:
    """Return the records that a table of trials was made of; no rock came by at any station."""
    if table.num_rows != campaign.trials:
        raise ValueError(f"it has {table.num_rows} trials instead of {campaign.trials}")
    outcomes = np.zeros((campaign.trials, len(OUTCOME)))
    codes = {words: code for code, words in ENDS.items()}
    outcomes[:, OUTCOME.end] = [codes[words] for words in table["end"].to_pylist()]
    numbers = {name: number for number, name in enumerate(campaign.names)}
    stopping = table["barrier"].to_pylist()
    outcomes[:, OUTCOME.barrier] = [-1 if name is None else numbers[name] for name in stopping]
    for name, column, *_ in (*AT_END, *NUMBERS):
        outcomes[:, column] = _values(table, name)
    passages = np.zeros((campaign.trials, len(campaign.names), len(PASSAGE)))
    for i, line in enumerate(campaign.names):
        passages[:, i, PASSAGE.count] = _values(table, f"{line}.passages")
        for name, column, _ in AT_PASSAGE:
            title = f"{line}.{name}"
            is_older = name in _LATER and title not in table.column_names
            passages[:, i, column] = np.nan if is_older else _values(table, title)
    peaks = np.full((campaign.trials, 0, len(PEAK)), -1.0, np.float32)
    return TrialRecords(passages, peaks, outcomes)


def _values(table: Any, name: str) -> FloatArray:
    values: NDArray[np.float64] = table[name].to_numpy().astype(np.float64)
    return values


def _envelopes(campaign: Campaign, table: Any) -> Envelopes:
    if table.num_rows != len(campaign.stations):
        raise ValueError(f"it has {table.num_rows} stations instead of {len(campaign.stations)}")
    curves = ("max", *(f"p{100 * share:.0f}" for share in SHARES))
    return {
        name: {which: _values(table, f"{name}.{which}") for which in curves} for name, _, _ in ALONG
    }
