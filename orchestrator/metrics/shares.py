"""Where the energy of an impact is at the end of a run, as shares of the impact energy."""

from collections.abc import Iterator

from rockshed.components.common.roles import Role

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .energy import carried_work, impact_energy
from .roles import recorded

_SHARES = (
    (names.GRAVITY_SHARE, Role.GRAVITY_ENERGY, -1.0, 1.0),
    (names.DISSIPATED_SHARE, Role.DISSIPATED, 1.0, -1.0),
    (names.REBOUND_SHARE, Role.STRIKING, 1.0, 0.0),
)
"""Name, role of the energies, and the factors of those at the end and at the start."""


def of_energies(run: StoredRun) -> Iterator[Metric]:
    """Yield what gravity has given, what is dissipated and what the body still has, at the end.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    impact = impact_energy(run)
    if not impact:
        return
    for name, role, at_end, at_start in _SHARES:
        columns = [
            run.series[member.column]
            for member in recorded(run, role)
            if not Role.LEFT_BEHIND.includes(member.role)
        ]
        if columns:
            total = sum(float(at_end * each[-1] + at_start * each[0]) for each in columns)
            if role is Role.GRAVITY_ENERGY:
                carried = carried_work(run)
                total += 0.0 if carried is None else float(carried[-1] - carried[0])
            yield Metric(name, total / impact)
