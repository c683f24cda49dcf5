"""The energy that couplings make in an exchange."""

from collections.abc import Mapping

import numpy as np

from ..fmu.access import read_values
from ..fmu.slave import Slave
from ..loop.buses import Buses
from ..system.plan import End


class Energies:
    """Holds the work of each bond in an exchange against that of forces at both of its ends.

    The taker of a bond got the work of the force that it was given. The mean of the forces that the
    giver shows before and after the exchange, times the displacement of the taker, is that work to
    second order. What lies between is made by the coupling: E. Both sides of the ledger together
    have it too, but count an exchange late where one component follows the other, so that a change
    of the step would be an error.

    Parameters
    ----------
    buses : Buses
        With the values after the initialisation.
    slaves : mapping of str to Slave
        By component.

    Attributes
    ----------
    largest_work : array of float, shape (1,)
        Largest work (J) of a bond so far, which is E0 where the system names none and more than
        moved at the start.
    """

    def __init__(self, buses: Buses, slaves: Mapping[str, Slave]) -> None:
        plan = buses.plan
        self._buses = buses
        given = plan.reference
        known = _read(slaves, given) if isinstance(given, End) else given
        self._given = abs(known) if known is not None else None
        self._kinetic = sum(_read(slaves, end) for end in plan.kinetic)
        places = np.cumsum([0, *(bond.force.size for bond in plan.bonds)])
        self._begins = places[:-1]
        self._end = int(places[-1])
        self._works = np.zeros(0)
        self._forces = np.zeros(0)
        self._positions = np.zeros(0)
        self.largest_work = np.zeros(1)

    def enter(self) -> None:
        """Begin an exchange with the present values."""
        channels = self._buses.channels[: self._end]  # those of bonds
        self._works = channels["taken"].copy()
        self._forces = self._buses.outputs[channels["force"]]
        self._positions = self._buses.outputs[channels["position"]]

    def made(self) -> float:
        """Return the energy made since :meth:`enter`, as a part of E0; then begin anew.

        What the bonds have made adds up by its amounts. 0 where there is no E0 yet.
        """
        works, forces, positions = self._works, self._forces, self._positions
        self.enter()
        expected = 0.5 * (forces + self._forces) * (self._positions - positions)
        residuals = np.add.reduceat(self._works - works - expected, self._begins)
        of_bonds = np.add.reduceat(self._works, self._begins)
        self.largest_work[0] = max(self.largest_work[0], np.abs(of_bonds).max())
        size = self._given
        if size is None:
            size = max(self._kinetic, float(self.largest_work[0]))
        return float(np.abs(residuals).sum()) / size if size else 0.0


def _read(slaves: Mapping[str, Slave], end: End) -> float:
    _, (value,) = read_values(slaves[end.component], [end.port])
    return float(value)
