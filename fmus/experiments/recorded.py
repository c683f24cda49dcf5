"""Results that were recorded, where no closed form is known, and states that were.

``python -m tests.fmu.record`` records them anew; what then differs is the effect of a change of a
kernel, and has to be meant.
"""

import csv
import lzma
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rockshed.platforms import PLATFORMS

from .declaration import SerializedState

DATA = Path(__file__).parent / "data"
STATE_SUFFIX = ".state.xz"
STATE_PLATFORM = PLATFORMS["x86_64-linux"]
"""Platform on which states are recorded."""
_OF_SAND = {"discs": 370, "elements": 24}
_SIZES = {name: _OF_SAND for name in ("driven-rock", "settled-sand", "rock-into-settled-sand")}
"""Sizes of the FMU that each record is of."""


def recorded_state(name: str, sizes: Mapping[str, int]) -> SerializedState | None:
    """Return a recorded state.

    Parameters
    ----------
    name : str
        Of the state.
    sizes : mapping of str to int
        Of the FMU.

    Returns
    -------
    SerializedState or None
        None for an FMU of other sizes.
    """
    if dict(sizes) != _SIZES[name]:
        return None
    return SerializedState(name, lzma.decompress((DATA / f"{name}{STATE_SUFFIX}").read_bytes()))


def recorded(name: str, sizes: Mapping[str, int]) -> dict[str, NDArray[np.float64]]:
    """Return the recorded values of an experiment.

    Parameters
    ----------
    name : str
        Of the experiment.
    sizes : mapping of str to int
        Of the FMU.

    Returns
    -------
    dict of str to ndarray
        Values by output; empty for an FMU of other sizes.
    """
    if dict(sizes) != _SIZES[name]:
        return {}
    with (DATA / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        lines = list(csv.reader(file))
    return {
        output: np.array([float(line[column]) for line in lines[1:]])
        for column, output in enumerate(lines[0])
    }
