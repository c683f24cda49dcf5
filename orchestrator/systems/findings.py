"""Findings of a measurement of the impact systems about each master, from its numbers."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .bench import REFERENCE
from .catalogue import impact_system
from .masters.table import MASTERS
from .measured import SuiteRuns
from .results import Summary, number, summaries

_CLEAR = 0.5
"""Difference of two orders that is told."""
_MUCH = 0.01
"""Energy made, as a part of the impact energy, that is told."""


@dataclass(frozen=True)
class Findings:
    """Things to tell of a master; an entry has the names of systems and numbers.

    Attributes
    ----------
    master : str
        Its name.
    cannot : tuple of str
        Systems without a result.
    beyond : tuple of str
        Systems with an error beyond their tolerance.
    lost, gained : tuple of str
        Systems with an order clearly below that of the reference master, or above.
    energy : tuple of str
        The system with the most energy made by the coupling, and that with the most lost.
    """

    master: str
    cannot: tuple[str, ...] = ()
    beyond: tuple[str, ...] = ()
    lost: tuple[str, ...] = ()
    gained: tuple[str, ...] = ()
    energy: tuple[str, ...] = ()

    @property
    def are_none(self) -> bool:
        """Whether there is nothing to tell."""
        return not (self.cannot or self.beyond or self.lost or self.gained or self.energy)


def findings(measured: SuiteRuns) -> list[Findings]:
    """Return what a measurement says about each master that it has."""
    known = summaries(measured)
    reference = {each.system: each.order for each in known if each.master == REFERENCE}
    names = [m.name for m in MASTERS if any(each.master == m.name for each in known)]
    return [
        _of_master(name, [each for each in known if each.master == name], reference)
        for name in names
    ]


def _of_master(name: str, own: Sequence[Summary], reference: dict[str, float | None]) -> Findings:
    orders = [
        (each.system, each.order, expected)
        for each in own
        if each.order is not None and (expected := reference.get(each.system)) is not None
    ]
    told = [
        (system, f"{system}: {order:.1f}, not {expected:.1f}", order - expected)
        for system, order, expected in orders
    ]
    return Findings(
        name,
        cannot=tuple(each.system for each in own if each.stated.reason),
        beyond=tuple(_beyond(own)),
        lost=tuple(text for _, text, more in told if more < -_CLEAR),
        gained=tuple(text for _, text, more in told if more > _CLEAR),
        energy=tuple(_energies(own)),
    )


def _beyond(own: Iterable[Summary]) -> Iterable[str]:
    for each in own:
        error, tolerance = each.stated.error, impact_system(each.system).tolerance
        if error is not None and error > tolerance:
            yield f"{each.system}: {number(error)} > {tolerance:g}"


def _energies(own: Iterable[Summary]) -> list[str]:
    """Return the most energy that was made and the most that was lost, where it is much."""
    made = sorted(
        (each.stated.energy, each.system)
        for each in own
        if each.stated.energy is not None and (each.stated.error or 0.0) <= 1.0
    )
    ends = dict.fromkeys((made[-1], made[0])) if made else {}
    return [f"{system}: {100.0 * part:+.2g} %" for part, system in ends if abs(part) > _MUCH]
