"""The outcome of a run of a batch."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..core.results.reading import StoredRun


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
    units : mapping of str to str
        FMI units by the names of the metrics.
    warnings : tuple of str
        Warnings of the run, and doubts about its metrics.
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
    units: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def digests_of(run: "StoredRun") -> dict[str, str]:
    """Return the SHA-256 of the FMUs that have run, by component, without those in the process.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    components = run.provenance["components"]
    return {name: facts["sha256"] for name, facts in components.items() if "sha256" in facts}
