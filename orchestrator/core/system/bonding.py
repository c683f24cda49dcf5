"""Power bonds, and the energy that their errors are compared with, by ports and places."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import counted
from ..fmu.description import UnitDefinition
from .finding import Finder
from .linking import Links
from .parts import PowerBond
from .plan import BondPlaces, End
from .units import is_force, is_joule


class BondEnds(NamedTuple):
    """A power bond by ports."""

    name: str
    force: list[End]
    position: list[End]
    given: list[End]
    seen: list[End]
    work: End | None
    sign: float


@dataclass
class Bonder:
    """Resolves power bonds.

    Attributes
    ----------
    finder : Finder
        Finds their ports, and takes problems.
    connected : bool
        Whether all connections are known; else none is missed.
    """

    finder: Finder
    connected: bool = True

    def bond(self, name: str, bond: PowerBond, links: Links) -> BondEnds | None:
        """Return a bond by its ports; None where something about it is wrong."""
        where = f"bonds.{name}"
        force = self._outputs(where, bond.giver, bond.force)
        position = self._outputs(where, bond.taker, bond.position)
        work = self._outputs(where, bond.giver, [bond.work] if bond.work else [])
        if not force or not position or (bond.work and not work):
            return None
        if len(force) != len(position):
            what = f"has {counted(len(force), 'force')} and {counted(len(position), 'position')}"
            self.finder.refuse(where, what, "name one position for each force")
            return None
        fed = _fed_by(links, bond.taker)
        why = "the ledger takes the force that the taker was given"
        given = self._connected(where, force, fed, bond.taker, why)
        seen: list[End] = []
        if not work:
            why = (
                "the ledger takes the displacement that the giver was shown; or name the giver's "
                "work output"
            )
            fed = _fed_by(links, bond.giver)
            seen = self._connected(where, position, fed, bond.giver, why)
        self._check_energy_units(where, force, position, work)
        sign = -1.0 if bond.opposed else 1.0
        return BondEnds(name, force, position, given, seen, work[0] if work else None, sign)

    def reference(self) -> float | End | None:
        """Return E0 of the alarm: an energy (J), an output, or None where it is not named."""
        alarm = self.finder.system.energy_alarm
        if alarm.reference is None or isinstance(alarm.reference, float):
            return alarm.reference
        where = "energy_alarm.reference"
        ends = self.finder.of_causality(
            where, self.finder.ends(where, *self.finder.split(alarm.reference)), "output"
        )
        return ends[0] if ends else None

    def _outputs(self, where: str, component: str, names: Iterable[str]) -> list[End]:
        ends = [end for name in names for end in self.finder.ends(where, component, name)]
        return self.finder.of_causality(where, ends, "output")

    def _connected(
        self, where: str, sources: list[End], fed: Mapping[str, End], component: str, why: str
    ) -> list[End]:
        """Return the inputs of a component that the sources feed."""
        missing = [source.name for source in sources if source.name not in fed]
        if missing and self.connected:
            self.finder.refuse(where, f"{missing[0]} is connected to no input of {component}", why)
        if missing:
            return []
        return [fed[source.name] for source in sources]

    def _check_energy_units(
        self, where: str, force: list[End], position: list[End], work: list[End]
    ) -> None:
        for f, p in zip(force, position, strict=True):
            if is_force(f.port.unit) is False:
                self.finder.refuse(
                    where,
                    f"{f.name} is in {f.port.unit_name}, and no force or torque",
                    "name the forces first, then the positions",
                )
                return
            if is_joule(f.port.unit, p.port.unit) is False:
                self.finder.refuse(
                    where,
                    f"{f.name} in {f.port.unit_name} times {p.name} in {p.port.unit_name} is no "
                    "energy in J",
                    "name forces with positions and torques with angles, in SI units",
                )
                return
        if work and is_joule(work[0].port.unit, UnitDefinition("1", {})) is False:
            self.finder.refuse(
                where, f"{work[0].name} is in {work[0].port.unit_name}", "name an output in J"
            )


def bond_places(
    bond: BondEnds, place: Mapping[str, int], place_of_input: Mapping[str, int]
) -> BondPlaces:
    """Return a bond by places on the buses."""

    def places(table: Mapping[str, int], ends: list[End]) -> NDArray[np.int64]:
        return np.array([table[end.name] for end in ends], np.int64)

    seen = np.full(len(bond.force), -1, np.int64)
    if bond.seen:
        seen = places(place_of_input, bond.seen)
    return BondPlaces(
        name=bond.name,
        given=places(place_of_input, bond.given),
        seen=seen,
        force=places(place, bond.force),
        position=places(place, bond.position),
        work=bond.work,
        sign=bond.sign,
    )


def _fed_by(links: Links, component: str) -> dict[str, End]:
    """Return the inputs of a component by the outputs that feed them."""
    return {source.name: target for source, target in links if target.component == component}
