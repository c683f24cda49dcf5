"""Energy accounts of the power bonds: work on the taker, work on the giver, and their sum.

Every mechanical interface passes energy from one component to the other. Both sides count it, each
with the force and the motion that it knows; an exact exchange makes the sum zero. What remains is
the energy that the coupling itself has made (positive) or lost, because values are held between
exchanges.

Where both sides count the same force along the same way, as with a force that is held over an
exchange, the interface shows nothing: the error then stands in the balance of the component whose
force has changed on the way. So the balances of the components are watched too.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..errors import RunFailed
from ..fmu.access import read_values
from ..fmu.slave import WARNING, Slave
from ..results.columns import WORK_OF_SCENARIO
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
_OF_SCENARIO = Column(
    WORK_OF_SCENARIO,
    "J",
    "work that the forces and motions which a scenario imposes have done on the components",
)
Advice = Callable[[float, str], str]
"""Says what may be done about values that run away at a time (s); the text is that of a run in
which nothing was set on the way."""
RUNAWAY = 10.0
"""Share of E0 beyond which an error of energy ends the run: nothing after it means anything."""


@dataclass
class Watched:
    """An energy that an exact computation keeps at zero.

    Attributes
    ----------
    owner, what, remedy : str
        Bond or component, what is watched of it, and what makes that smaller.
    largest, at : float
        The largest value so far (J), and its time (s).
    ran_away_at : float, optional
        First time (s) at which it was more than the energy of the whole system.
    """

    owner: str
    what: str
    remedy: str
    largest: float = 0.0
    at: float = 0.0
    ran_away_at: float | None = None

    def look(self, energies: NDArray[np.float64], times: NDArray[np.float64], most: float) -> None:
        """Keep the largest of more values (J) and its time (s); ``most`` is a runaway (J)."""
        sizes = np.abs(energies)
        i = int(np.argmax(sizes))
        if sizes[i] > abs(self.largest):
            self.largest, self.at = float(energies[i]), float(times[i])
        if self.ran_away_at is None and sizes[i] > most:
            self.ran_away_at = float(times[int(np.argmax(sizes > most))])

    def warning(self, share: float, reference: float, advice: Advice) -> str:
        """Return the sentence that warns of it; the share and E0 (J) are those of the alarm."""
        percent = 100.0 * self.largest / reference
        return (
            f"{self.owner}: {self.what} reaches {self.largest:.6g} J at t = {self.at:.9g} s, "
            f"{percent:+.3g} % of E0 = {reference:.6g} J, and {100.0 * share:g} % are tolerated: "
            f"{advice(self.at, self.remedy)}"
        )


class Accounts:
    """Work and coupling energy of each bond since the start (J).

    Parameters
    ----------
    slaves : mapping of str to Slave
        Initialised.
    buses : Buses
        With the values after the initialisation.
    advice : Advice
        Says what may be done about an error of energy.

    Raises
    ------
    RunFailed
        A slave does not give the energy that the accounts begin with.
    """

    def __init__(
        self,
        slaves: Mapping[str, Slave],
        buses: Buses,
        advice: Advice = lambda at, otherwise: otherwise,
    ) -> None:
        self.plan = buses.plan
        self._advice = advice
        self._slaves = slaves
        self._snapshots = buses.snapshots
        ends = np.cumsum([0, *(bond.force.size for bond in self.plan.channels)])
        self._channels = [slice(a, b) for a, b in pairwise(ends)]
        self._at_start = [self._read(bond.work) for bond in self.plan.bonds]
        self._balances_at_start = [self._read(end) for end in self.plan.balances]
        self._kinetic_at_start = sum(self._read(end) for end in self.plan.kinetic)
        given = self.plan.reference
        self._reference = self._read(given) if isinstance(given, End) else given
        self._largest_work = 0.0
        self._bonds = [
            Watched(f"bond {bond.name}", "the coupling energy", "reduce the exchange step")
            for bond in self.plan.bonds
        ]
        self._balances = [
            Watched(
                end.component,
                f"the error of its balance of energy ({end.name})",
                f"reduce the internal step of {end.component}, and the exchange step over which "
                "its partners are held",
            )
            for end in self.plan.balances
        ]
        self._newest = np.zeros(self.columns)

    @property
    def columns(self) -> int:
        """Number of values that :meth:`values` gives."""
        return len(_DESCRIPTIONS) * len(self.plan.bonds) + (self.plan.imposed is not None)

    @property
    def described(self) -> list[Column]:
        """Columns that :meth:`values` fills, in order."""
        return [
            Column(f"coupling.{bond.name}.{name}", "J", description)
            for bond in self.plan.bonds
            for name, description in _DESCRIPTIONS.items()
        ] + ([] if self.plan.imposed is None else [_OF_SCENARIO])

    def values(self, rows: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return works and coupling energy of all bonds, and the work of a scenario.

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
        most = RUNAWAY * (abs(self._reference or 0.0) or np.inf)  # others are known at the end
        for i, (bond, channels) in enumerate(zip(self.plan.bonds, self._channels)):
            taken = bond.sign * _sums(rows[:, self._snapshots.taken][:, channels])
            if bond.work is None:
                given_back = bond.sign * _sums(rows[:, self._snapshots.given_back][:, channels])
            else:
                given_back = rows[:, self._snapshots.place[bond.work.name]] - self._at_start[i]
            found[:, 3 * i : 3 * i + 3] = np.stack((taken, given_back, taken + given_back), axis=1)
            self._bonds[i].look(taken + given_back, times, most)
            self._largest_work = max(self._largest_work, float(np.abs(taken).max()))
        for end, watched, start in zip(
            self.plan.balances, self._balances, self._balances_at_start, strict=True
        ):
            watched.look(rows[:, self._snapshots.place[end.name]] - start, times, most)
        if self.plan.imposed is not None:
            found[:, -1] = self._of_scenario(rows)
            self._largest_work = max(self._largest_work, float(np.abs(found[:, -1]).max()))
        self._newest = found[-1]
        return found

    def _of_scenario(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the work of the forces and motions that a scenario imposes."""
        channels = self._channels[-1]
        taken = rows[:, self._snapshots.taken][:, channels]
        return _sums(taken + rows[:, self._snapshots.given_back][:, channels])

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Return what has been found since the start, by name."""
        watched = self._bonds + self._balances
        never = np.nan
        found = [
            (w.largest, w.at, never if w.ran_away_at is None else w.ran_away_at) for w in watched
        ]
        return {
            "energies": np.array(found, np.float64).reshape(-1, 3),
            "largest_work": np.array([self._largest_work]),
            "works": self._newest.copy(),
        }

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Go on from what an earlier process has found, as :meth:`memory` gives it."""
        for watched, found in zip(self._bonds + self._balances, memory["energies"], strict=True):
            watched.largest = float(found[0])
            watched.at = float(found[1])
            watched.ran_away_at = None if np.isnan(found[2]) else float(found[2])
        self._largest_work = float(memory["largest_work"][0])
        self._newest = memory["works"].copy()

    @property
    def reference(self) -> float:
        """Energy E0 (J) that errors are compared with; see EnergyAlarm."""
        if self._reference is not None:
            return self._reference
        return max(self._kinetic_at_start, self._largest_work)

    def refuse_runaway(self) -> None:
        """Do nothing as long as no error of energy is as large as the E0 that the system names.

        Raises
        ------
        RunFailed
            The first bond or component that made or lost more than :data:`RUNAWAY` of E0.
        """
        lost = [w for w in self._bonds + self._balances if w.ran_away_at is not None]
        if not lost:
            return
        first = min(lost, key=lambda watched: watched.ran_away_at or 0.0)
        at = first.ran_away_at or 0.0
        raise RunFailed(
            first.owner,
            at,
            f"unstable: {first.what} is more than {RUNAWAY:g} times E0 = "
            f"{abs(self.reference):.6g} J, and nothing after it means anything; "
            f"{self._advice(at, first.remedy)}",
        )

    @property
    def warnings(self) -> list[str]:
        """A sentence for each bond and component that made or lost more energy than tolerated."""
        share = self.plan.system.energy_alarm.share
        reference = abs(self.reference)
        return [
            watched.warning(share, reference, self._advice)
            for watched in self._bonds + self._balances
            if reference and abs(watched.largest) > share * reference
        ]

    def metrics(self) -> list[Metric]:
        """Return the newest values, for the summary."""
        return [
            Metric(column.name, float(value), column.unit)
            for column, value in zip(self.described, self._newest)
        ]

    def _read(self, end: End | None) -> float:
        """Return a value at the start; 0 without a port."""
        if end is None:
            return 0.0
        status, (value,) = read_values(self._slaves[end.component], [end.port])
        if status > WARNING:
            at = self.plan.timing.seconds(0)
            raise RunFailed(end.component, at, f"does not give {end.port.name}")
        return value


def _sums(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sum of each row, added up from left to right.

    The bits are then the same however many rows there are. Columns are added, a fraction of the
    time of adding along rows.
    """
    first, *others = rows.T
    total = first.copy()
    for column in others:
        total += column
    return total
