"""Power ports on which a scenario imposes a force or a motion, and so does work."""

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ..fmu.description import Description, Port
from .plan import BondPlaces, End

SCENARIO = "scenario"
"""Name of the account of that work."""
_CONJUGATES = (("force.x", "position.x"), ("force.y", "position.y"), ("torque", "angle"))
"""Members of a bond whose product is work. Along a rod, no bond says in which direction each of its
members counts, and none is taken."""


class Imposed(NamedTuple):
    """A force and the motion of its point, at a port of one component; one is imposed.

    is_force: whether it is the force.
    """

    force: End
    motion: End
    is_force: bool

    @property
    def shown(self) -> End:
        """Return the output, which the component computes from what is imposed."""
        return self.motion if self.is_force else self.force


def imposed_ends(
    descriptions: Mapping[str, Description], inputs: Iterable[End], fed: Iterable[str]
) -> list[Imposed]:
    """Return the ports on which a scenario does work.

    Parameters
    ----------
    descriptions : mapping of str to Description
        Of the components, with the bonds that they declare.
    inputs : iterable of End
        Inputs on which the scenario acts.
    fed : iterable of str
        Names of inputs that connections feed: what a fault makes there stands in the account of the
        bond.
    """
    of_connections = set(fed)
    return [
        pair
        for end in inputs
        if end.name not in of_connections
        for pair in _pairs(end, descriptions[end.component])
    ]


def _pairs(end: End, known: Description) -> Iterator[Imposed]:
    """Yield the pair of an input and the output that belongs to it, if there is one."""
    array, bracket, place = end.port.name.partition("[")
    for bond in known.bonds:
        members = bond["members"]
        for force, motion in _CONJUGATES:
            names = (members.get(force), members.get(motion))
            if array not in names or None in names:
                continue
            is_force = array == names[0]
            other: Port | None = known.ports.get(f"{names[is_force]}{bracket}{place}")
            if other is not None and other.causality == "output":
                shown = End(end.component, other)
                yield Imposed(*((end, shown) if is_force else (shown, end)), is_force)
                return


def imposed_places(
    pairs: Iterable[Imposed], place: Mapping[str, int], place_of_input: Mapping[str, int]
) -> BondPlaces | None:
    """Return these ports by places on the buses, a channel for each; None where there are none.

    A force is that of a taker, a motion is shown to a giver: the other side is nobody's.
    """
    rows = [
        (place_of_input[force.name], -1, 0, place[motion.name])
        if is_force
        else (-1, place_of_input[motion.name], place[force.name], 0)
        for force, motion, is_force in pairs
    ]
    if not rows:
        return None
    given, seen, forces, positions = np.array(rows, np.int64).T
    return BondPlaces(SCENARIO, given, seen, forces, positions, None)
