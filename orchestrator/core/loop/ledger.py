"""Energy accounts of the power bonds: what the taker got, what the giver got, and what does not cancel.

Every mechanical interface passes energy from one component to the other. Both sides count it, each with the force and the motion
that it knows; an exact exchange makes the sum zero. What remains is the energy that the coupling itself has made (positive) or
lost, because values are held between exchanges.
"""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..errors import RunFailed
from ..fmu.slave import WARNING, Slave
from ..results.metric import Metric
from ..results.run_folder import Column
from ..system.plan import End, Plan
from .exchange import State


class Accounts:
    """Work and coupling energy of each bond since the start (J)."""

    def __init__(self, plan: Plan, slaves: Mapping[str, Slave], state: State) -> None:
        self._plan, self._slaves, self._snapshots = plan, slaves, state.snapshots
        ends = np.cumsum([0, *(bond.force.size for bond in plan.bonds)])
        self._channels = [slice(a, b) for a, b in pairwise(ends)]
        self._at_start = [self._own_work(bond.work, plan.timing.seconds(0)) for bond in plan.bonds]
        self._reference = (
            self._read(plan.reference, plan.timing.seconds(0))
            if isinstance(plan.reference, End)
            else plan.reference
        )
        self._alarmed: set[str] = set()
        self.warnings: list[str] = []
        self._newest = np.zeros(self.columns)

    @property
    def columns(self) -> int:
        """Number of values that :meth:`values` gives."""
        return 3 * len(self._plan.bonds)

    @property
    def described(self) -> list[Column]:
        """The columns that :meth:`values` fills."""
        return [
            column
            for bond in self._plan.bonds
            for column in (
                Column(
                    f"coupling.{bond.name}.work.taker",
                    "J",
                    "work that the bond has done on the component that takes the force",
                ),
                Column(
                    f"coupling.{bond.name}.work.giver",
                    "J",
                    "work that the bond has done on the component that gives the force",
                ),
                Column(
                    f"coupling.{bond.name}.energy",
                    "J",
                    "sum of both works: energy that the coupling has made",
                ),
            )
        ]

    def values(self, rows: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Works and coupling energy of all bonds in rows of snapshots; the times (s) are needed for messages only."""
        found = np.zeros((len(rows), self.columns))
        for i, (bond, channels) in enumerate(zip(self._plan.bonds, self._channels)):
            taken = bond.sign * _sums(rows[:, self._snapshots.taken][:, channels])
            given_back = (
                bond.sign * _sums(rows[:, self._snapshots.given_back][:, channels])
                if bond.work is None
                else rows[:, self._snapshots.place[bond.work.name]] - self._at_start[i]
            )
            found[:, 3 * i : 3 * i + 3] = np.stack((taken, given_back, taken + given_back), axis=1)
            self._watch(bond.name, taken + given_back, times)
        self._newest = found[-1]
        return found

    def figures(self) -> list[Metric]:
        """The newest values, for the summary."""
        return [
            Metric(column.name, float(value), column.unit)
            for column, value in zip(self.described, self._newest)
        ]

    def _watch(self, bond: str, energies: NDArray[np.float64], times: NDArray[np.float64]) -> None:
        alarm = self._plan.system.energy_alarm
        if alarm is None or not self._reference or bond in self._alarmed:
            return
        for i in np.flatnonzero(np.abs(energies) > alarm.share * abs(self._reference))[:1]:
            self._alarmed.add(bond)
            self.warnings.append(
                f"bond {bond}: the coupling energy {energies[i]:.6g} J exceeds {alarm.share:.3g} of the reference "
                f"{self._reference:.6g} J at t = {times[i]:.9g} s: reduce the exchange step"
            )

    def _own_work(self, end: End | None, at: float) -> float:
        return 0.0 if end is None else self._read(end, at)

    def _read(self, end: End, at: float) -> float:
        value = np.zeros(1)
        if (
            self._slaves[end.component].get(
                np.array([end.port.reference], np.uint32), value, end.port.kind
            )
            > WARNING
        ):
            raise RunFailed(end.component, at, f"does not give {end.port.name}")
        return float(value[0])


def _sums(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """The sum of each row, added up from left to right: the same bits however many rows there are."""
    return np.add.accumulate(rows, axis=1)[:, -1]
