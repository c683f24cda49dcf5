"""Energy accounts of the power bonds: work on the taker, work on the giver, and their sum.

Every mechanical interface passes energy from one component to the other. Both sides count it, each
with the force and the motion that it knows; an exact exchange makes the sum zero. What remains is
the energy that the coupling itself has made (positive) or lost, because values are held between
exchanges.
"""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..errors import RunFailed
from ..fmu.slave import WARNING, Slave
from ..results.metric import Metric
from ..results.run_folder import Column
from ..system.plan import End
from .buses import Buses

_DESCRIPTIONS = {
    "work.taker": "work that the bond has done on the component that takes the force",
    "work.giver": "work that the bond has done on the component that gives the force",
    "energy": "sum of both works: energy that the coupling has made",
}
"""Columns of a bond, and their descriptions."""


class Accounts:
    """Work and coupling energy of each bond since the start (J).

    Parameters
    ----------
    slaves : mapping of str to Slave
        Initialised.
    buses : Buses
        With the values after the initialisation.

    Attributes
    ----------
    warnings : list of str
        One for each bond whose coupling energy has exceeded its limit.

    Raises
    ------
    RunFailed
        A slave does not give the energy that the accounts begin with.
    """

    def __init__(self, slaves: Mapping[str, Slave], buses: Buses) -> None:
        self.plan = buses.plan
        self._slaves = slaves
        self._snapshots = buses.snapshots
        ends = np.cumsum([0, *(bond.force.size for bond in self.plan.bonds)])
        self._channels = [slice(a, b) for a, b in pairwise(ends)]
        self._at_start = [self._read(bond.work) for bond in self.plan.bonds]
        reference = self.plan.reference
        self._reference = self._read(reference) if isinstance(reference, End) else reference
        self._alarmed: set[str] = set()
        self.warnings: list[str] = []
        self._newest = np.zeros(self.columns)

    @property
    def columns(self) -> int:
        """Number of values that :meth:`values` gives."""
        return len(_DESCRIPTIONS) * len(self.plan.bonds)

    @property
    def described(self) -> list[Column]:
        """Columns that :meth:`values` fills, in order."""
        return [
            Column(f"coupling.{bond.name}.{name}", "J", description)
            for bond in self.plan.bonds
            for name, description in _DESCRIPTIONS.items()
        ]

    def values(self, rows: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return works and coupling energy of all bonds.

        Parameters
        ----------
        rows : array of float, shape (n, values)
            Snapshots.
        times : array of float, shape (n,)
            Their times (s), for warnings.

        Returns
        -------
        array of float, shape (n, columns)
            In J.
        """
        found = np.zeros((len(rows), self.columns))
        for i, (bond, channels) in enumerate(zip(self.plan.bonds, self._channels)):
            taken = bond.sign * _sums(rows[:, self._snapshots.taken][:, channels])
            if bond.work is None:
                given_back = bond.sign * _sums(rows[:, self._snapshots.given_back][:, channels])
            else:
                given_back = rows[:, self._snapshots.place[bond.work.name]] - self._at_start[i]
            found[:, 3 * i : 3 * i + 3] = np.stack((taken, given_back, taken + given_back), axis=1)
            self._watch(bond.name, taken + given_back, times)
        self._newest = found[-1]
        return found

    def metrics(self) -> list[Metric]:
        """Return the newest values, for the summary."""
        return [
            Metric(column.name, float(value), column.unit)
            for column, value in zip(self.described, self._newest)
        ]

    def _watch(self, bond: str, energies: NDArray[np.float64], times: NDArray[np.float64]) -> None:
        alarm = self.plan.system.energy_alarm
        if alarm is None or not self._reference or bond in self._alarmed:
            return
        for i in np.flatnonzero(np.abs(energies) > alarm.share * abs(self._reference))[:1]:
            self._alarmed.add(bond)
            self.warnings.append(
                f"bond {bond}: the coupling energy {energies[i]:.6g} J exceeds {alarm.share:.3g} "
                f"of the reference {self._reference:.6g} J at t = {times[i]:.9g} s: reduce the "
                "exchange step"
            )

    def _read(self, end: End | None) -> float:
        """Return a value at the start; 0 without a port."""
        if end is None:
            return 0.0
        value = np.zeros(1)
        reference = np.array([end.port.reference], np.uint32)
        status = self._slaves[end.component].get(reference, value, end.port.kind)
        if status > WARNING:
            at = self.plan.timing.seconds(0)
            raise RunFailed(end.component, at, f"does not give {end.port.name}")
        return float(value[0])


def _sums(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sum of each row, added up from left to right.

    The bits are then the same however many rows there are.
    """
    return np.add.accumulate(rows, axis=1)[:, -1]
