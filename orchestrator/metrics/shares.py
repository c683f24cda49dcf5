"""Where the energy of an impact is at the end of a run, as shares of the impact energy."""

from collections.abc import Iterator

from rockshed.components.common.roles import Role

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .energy import impact_energy
from .roles import recorded

_SHARES = (
    (names.DISSIPATED_SHARE, Role.DISSIPATED, True),
    (names.REBOUND_SHARE, Role.STRIKING, False),
)
"""Name, role of the energies, and whether what they had at the start is taken off."""


def of_energies(run: StoredRun) -> Iterator[Metric]:
    """Yield what is dissipated, and what the striking body still has, at the end of an impact.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    impact = impact_energy(run)
    if not impact:
        return
    for name, role, added in _SHARES:
        columns = [
            run.series[member.column]
            for member in recorded(run, role)
            if not Role.LEFT_BEHIND.includes(member.role)
        ]
        if columns:
            total = sum(float(energy[-1] - (energy[0] if added else 0.0)) for energy in columns)
            yield Metric(name, total / impact)
