"""Results of a run in memory, for programs that carry out many runs and keep a few numbers each."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .metric import Metric, Metrics
from .reading import StoredRun
from .run_folder import Column

NOWHERE = Path("in memory")
"""In the place of the folder of a run that lies in none."""


class MemoryResults:
    """Results of one run as :class:`~rockshed.core.results.run_folder.RunFolder` takes them.

    Serialized states are passed over.

    Attributes
    ----------
    folder : Path
        Names the run in messages.
    running : None
        There is no folder in which the run writes.
    provenance : dict
        What ``run.json`` would hold.
    """

    folder = NOWHERE
    running: Path | None = None

    def __init__(self) -> None:
        self.provenance: dict[str, Any] = {}
        self._columns: list[Column] = []
        self._blocks: list[NDArray[np.float64]] = []
        self._metrics = Metrics()

    def begin(self, columns: Sequence[Column], provenance: Mapping[str, Any]) -> None:
        """Take the columns without the time, and the facts about the run."""
        self._columns = [Column("time", "s", "simulated time"), *columns]
        self.provenance = {"status": "running", **provenance}

    def rows(self, times: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        """Append the values (n, columns) of all columns at times (n,) in s."""
        self._blocks.append(np.column_stack((times, values)))

    def frame(self, component: str, at: float, state: bytes) -> None:
        """Pass over the serialized state of a component at a time (s)."""

    def finish(self, status: str, metrics: Sequence[Metric], **facts: Any) -> None:
        """Take the status, the metrics and the last facts."""
        self._metrics = Metrics(metrics)
        self.provenance = {**self.provenance, "status": status, **facts}

    def give_up(self, error: str, **facts: Any) -> None:
        """Take the reason for which the run has failed, and the last facts."""
        self.provenance = {**self.provenance, "status": "failed", "error": error, **facts}

    def amend(self, **facts: Any) -> None:
        """Take facts that are known after the end."""
        self.provenance = {**self.provenance, **facts}

    def run(self) -> StoredRun:
        """Return the run with all of its rows."""
        width = len(self._columns)
        table = np.concatenate(self._blocks) if self._blocks else np.empty((0, width))
        values = np.ascontiguousarray(table.T)
        series = {column.name: values[i] for i, column in enumerate(self._columns)}
        return StoredRun(self.folder, self.provenance, self._metrics, self._columns, series)
