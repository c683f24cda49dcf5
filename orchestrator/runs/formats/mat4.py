"""Time series and parameters as MAT 4, in the six arrays of Dymola's and OpenModelica's results.

``data_1`` has what is constant, two columns for first and last time; ``data_2`` the time series,
both with a row for each variable. ``dataInfo`` has a column for each name: block (0 for the time),
row in the block, no interpolation given, and no values outside of the time.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...core.results.reading import StoredRun

_CONSTANT, _VARYING = 1, 2
_SIGNS = str.maketrans({"²": "2", "³": "3", "⁴": "4", "·": ".", "°": "deg", "±": "+-", "×": "x"})
"""Signs that the format does not have, as it can write them; any other becomes a question mark."""


def write_mat4(run: StoredRun, file: Path) -> None:
    """Write a run as DyMat and OMEdit read it.

    Parameters
    ----------
    run : StoredRun
        The run.
    file : Path
        New file.
    """
    from scipy.io import savemat  # takes a quarter of a second

    constants = list(_constants(run))
    varying = [column for column in run.columns if column.name != "time"]
    time = run.time
    names = ["time", *(name for name, _ in constants), *(column.name for column in varying)]
    told = ["Time [s]", *("Parameter" for _ in constants)]
    told += [f"{c.description} [{c.unit}]" if c.unit != "1" else c.description for c in varying]
    first = np.array([[value, value] for value in (0.0, *(value for _, value in constants))])
    first[0] = time[0], time[-1]
    content = {
        "Aclass": np.array(["Atrajectory", "1.1", "", "binTrans"]),
        "name": _upright(names),
        "description": _upright(told),
        "dataInfo": _places(len(constants), len(varying)),
        "data_1": first,
        "data_2": np.array([time, *(run.series[column.name] for column in varying)]),
    }
    with file.open("wb") as stream:
        savemat(stream, content, format="4")


def _constants(run: StoredRun) -> Iterator[tuple[str, float]]:
    """Yield the parameters that are numbers and no variables of the results."""
    for component, facts in run.provenance.get("components", {}).items():
        for name, parameter in facts.get("parameters", {}).items():
            value: Any = parameter["value"]
            full = f"{component}.{name}"
            if isinstance(value, (bool, int, float)) and full not in run.series:
                yield full, float(value)


def _places(constants: int, varying: int) -> np.ndarray:
    """Return block, row in it, interpolation and extrapolation of each name, shape (4, names)."""
    columns = [(0, 1, 0, -1)]
    columns += [(_CONSTANT, row, 0, 0) for row in range(2, constants + 2)]
    columns += [(_VARYING, row, 0, -1) for row in range(2, varying + 2)]
    return np.array(columns, np.int32).T


def _upright(texts: Sequence[str]) -> np.ndarray:
    """Return texts as the rows of an array of letters in which each text is a column."""
    plain = [_ascii(text) for text in texts]
    longest = max(map(len, plain))
    padded = [text.ljust(longest) for text in plain]
    return np.array(["".join(letters) for letters in zip(*padded, strict=True)])


def _ascii(text: str) -> str:
    return text.translate(_SIGNS).encode("ascii", "replace").decode("ascii") or " "
