"""Rows of a failed run up to the moment from which on its computation ran away."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rockshed.components.common.roles import Role
from rockshed.components.common.units import ms

from ..core.results.metric import Metrics
from ..core.results.reading import StoredRun
from .energy import impact_energy
from .roles import recorded

RUNAWAY = 2.0
"""Kinetic and elastic energy of a run / what it had at the start, from which on it runs away."""
_FEWEST = 2
"""Rows that a picture shows at least."""


@dataclass(frozen=True, eq=False, repr=False)
class ClippedRun(StoredRun):
    """The first rows and states of a run.

    Attributes
    ----------
    note : str
        Why the others are left out.
    """

    note: str = ""

    def states(self, component: str) -> Iterator[tuple[float, bytes]]:
        """Yield times (s) and recorded states of a component, none later than the last row."""
        for at, state in super().states(component):
            if at <= self.time[-1]:
                yield at, state


def until_divergence(run: StoredRun) -> StoredRun:
    """Return a failed run without the rows in which it has run away, whose values rule every axis.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    StoredRun
        The run itself where it has not failed, or nothing has run away.
    """
    rows = _rows_before(run)
    if rows is None:
        return run
    series = {name: values[:rows] for name, values in run.series.items()}
    note = (
        f"drawn until t = {series['time'][-1] / ms:.4g} ms: from there on the run diverges, "
        f"with {RUNAWAY:g} times the energy that there was at the start, and fails at "
        f"{run.time[-1] / ms:.4g} ms"
    )
    nothing_watched = Metrics()  # largest values of all exchanges are those of the runaway
    return ClippedRun(run.folder, run.provenance, nothing_watched, run.columns, series, note)


def note_of(run: StoredRun) -> list[str]:
    """Return why rows of a run are left out; empty where none are.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return [run.note] if isinstance(run, ClippedRun) else []


def _rows_before(run: StoredRun) -> int | None:
    """Return the number of rows before a run runs away; None where it does not."""
    if run.status != "failed" or run.time.size <= _FEWEST or not impact_energy(run):
        return None
    members = {m.column for role in (Role.KINETIC, Role.ELASTIC) for m in recorded(run, role)}
    total = np.sum([run.series[name] for name in members], axis=0)
    beyond = np.flatnonzero(~(total <= RUNAWAY * total[0]))
    return max(int(beyond[0]), _FEWEST) if beyond.size else None
