"""Runs of a batch that were finished before it was ended: they are not made again.

A file holds one run. Its name is a hash of all that the run follows from, the FMUs by their
content; nothing in it is executed when it is read.
"""

import hashlib
import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

from ..core.system.system import SystemSpec
from ..files import whole_file
from ..versions import versions

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

COMPLETE = "complete"
_PACKAGES = ("numpy", "numba", "fmpy", "pythonfmu")


@dataclass(frozen=True)
class Outcome:
    """Result of a task. A run that failed has the series until then, and no metrics.

    Attributes
    ----------
    key : str
        Key of the task.
    status : str
        ``complete``, ``failed`` or ``interrupted``.
    error : str
        Reason of a failure.
    failed_at : float, optional
        Time (s) of a failure in the run.
    metrics : mapping of str to float
        Values (SI) by the names of the metrics.
    series : mapping of str to array, shape (rows,)
        Columns of the results by name.
    options : mapping
        Parameters of sand and beam that make up the model.
    fmus : mapping of str to str
        SHA-256 by component.
    wall_time : float
        Seconds.
    """

    key: str
    status: str
    error: str = ""
    failed_at: float | None = None
    metrics: Mapping[str, float] = field(default_factory=dict)
    series: "Mapping[str, NDArray[np.float64]]" = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    fmus: Mapping[str, str] = field(default_factory=dict)
    wall_time: float = 0.0


@dataclass(frozen=True)
class Order:
    """Run as it is sent to a process.

    Attributes
    ----------
    key : str
        Of the task.
    system : SystemSpec
        With its values.
    allow_unstable : bool
        Whether a step may be longer than the stable one.
    """

    key: str
    system: SystemSpec
    allow_unstable: bool


class KeptRuns:
    """A folder of finished runs.

    Parameters
    ----------
    folder : Path
        Made when the first run is written.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def read(self, order: Order) -> Outcome | None:
        """Return the outcome of a run that was finished, or None.

        Parameters
        ----------
        order : Order
            The run.

        Returns
        -------
        Outcome or None
            None too where its file cannot be read.
        """
        import numpy as np

        try:
            with np.load(self._file(order), allow_pickle=False) as content:
                facts = json.loads(content["facts"].tobytes())
                names = facts.pop("columns")
                series = {name: content[f"column{i}"] for i, name in enumerate(names)}
            return replace(Outcome(**facts), series=series)
        except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile):
            return None

    def write(self, order: Order, outcome: Outcome) -> None:
        """Keep the outcome of a run, if the run is complete."""
        import numpy as np

        if outcome.status != COMPLETE:
            return
        facts = asdict(replace(outcome, series={})) | {"columns": list(outcome.series)}
        del facts["series"]
        text = np.frombuffer(json.dumps(facts).encode(), np.uint8)
        columns: dict[str, Any] = {
            f"column{i}": values for i, values in enumerate(outcome.series.values())
        }
        self._folder.mkdir(parents=True, exist_ok=True)
        with whole_file(self._file(order)) as temporary:
            np.savez(temporary, facts=text, **columns)

    def remove(self) -> None:
        """Remove all: the batch is complete."""
        shutil.rmtree(self._folder, ignore_errors=True)

    def _file(self, order: Order) -> Path:
        system = order.system
        hashes = {name: _hash(Path(spec.fmu)) for name, spec in system.components.items()}
        specs = {
            name: spec.model_copy(update={"fmu": hashes[name]})
            for name, spec in system.components.items()
        }
        text = system.model_copy(update={"components": specs}).model_dump_json()
        content = repr((order.key, order.allow_unstable, text, versions(*_PACKAGES)))
        return self._folder / f"{hashlib.sha256(content.encode()).hexdigest()[:32]}.npz"


@cache
def _hash(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()
