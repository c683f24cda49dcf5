"""Results that were recorded, where no closed form is known.

``python -m rockshed.fmus.experiments.recorded`` records them anew; what then differs is the effect
of a change of a kernel, and has to be meant.
"""

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

DATA = Path(__file__).parent / "data"
_SIZES = {"driven-rock": {"discs": 370, "elements": 24}}
"""Sizes of the FMU that each record is of."""


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
