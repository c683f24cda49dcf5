"""Connections through systems: from the inputs of components back to the outputs that feed them."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from ..core.errors import Problem
from ..core.fmu.description import UnitDefinition
from ..core.system.names import nearest
from ..core.system.units import units_agree
from .conversion import UNCHANGED, Way, between
from .structure import Connector, ConnectorKey, Element, FmuElement, Link, SystemElement

_GIVES = ("output", "calculatedParameter", "constant", "local", "inout", "unspecified")
"""Kinds of the connectors of an element that a value leaves; of the system itself they take it."""
_TAKES = ("input", "parameter", "structuralParameter", "inout", "unspecified")
"""Kinds of the connectors of an element that a value enters."""
_FIXED = ("parameter", "structuralParameter")


class Units(NamedTuple):
    """Units of a connector: as the description has it, and of the variable of the FMU behind it."""

    told: UnitDefinition | None
    own: UnitDefinition | None


UnitsOf = Callable[[Element, Connector], Units]
"""Returns the units of a connector."""


@dataclass(frozen=True)
class Wire:
    """A value on its way to an input of a component.

    Attributes
    ----------
    source : ConnectorKey
        Output of a component, or connector of a system that nothing feeds.
    target : ConnectorKey
        Input or parameter of a component.
    way : Way
        What becomes of the number.
    is_told : bool
        The way has to be told, also where it changes nothing: both units are not known to be one.
    from_component : bool
        The source is that of a component.
    place : str
        Of the last connection, for messages.
    """

    source: ConnectorKey
    target: ConnectorKey
    way: Way
    is_told: bool
    from_component: bool
    place: str


class _Feed(NamedTuple):
    """A connection by its direction."""

    source: ConnectorKey
    link: Link


@dataclass
class Wiring:
    """The connections of a system and of all systems in it.

    Attributes
    ----------
    root : SystemElement
        The system.
    units_of : callable
        Returns the units of a connector.
    problems : list of Problem
        Gets the faults.
    """

    root: SystemElement
    units_of: UnitsOf
    problems: list[Problem]
    feeds: dict[ConnectorKey, _Feed] = field(default_factory=dict)
    connectors: dict[ConnectorKey, tuple[Element, Connector]] = field(default_factory=dict)

    def wires(self) -> list[Wire]:
        """Return the ways of all values that reach a component."""
        for element in self.root.every():
            self.connectors |= {
                (element.name, name): (element, connector)
                for name, connector in element.connectors.items()
            }
        for element in self.root.every():
            if isinstance(element, SystemElement):
                for link in element.links:
                    self._take(element, link)
        return list(self._traced())

    # ------------------------------------------------------------------ each connection

    def _take(self, owner: SystemElement, link: Link) -> None:
        ends = [self._end(owner, link, key) for key in (link.start, link.end)]
        if ends[0] is None or ends[1] is None:
            return
        source, target = ends[0], ends[1]
        if not self._leads(owner, source, target) and self._leads(owner, target, source):
            source, target = target, source
        if not self._leads(owner, source, target):
            self._refuse(
                link, self._words(owner, source, target), "connect an output with an input"
            )
            return
        if target in self.feeds:
            other = self.feeds[target].link.place.rpartition(", ")[2]
            what = f"{_name(target)} has a source already ({other})"
            self._refuse(link, what, "keep one of the connections")
            return
        self.feeds[target] = _Feed(source, link)

    def _end(self, owner: SystemElement, link: Link, key: ConnectorKey) -> ConnectorKey | None:
        element: Element | None = owner
        if key[0]:
            element = owner.elements.get(key[0])
        if element is None:
            around = f"system {owner.name}" if owner.name else "the system"
            what = f"{around} has no element {key[0]}"
            self._refuse(link, what, nearest(key[0], owner.elements))
            return None
        if key[1] not in element.connectors:
            named = element.name or "the system"
            what = f"{named} has no connector {key[1]}"
            self._refuse(link, what, nearest(key[1], element.connectors))
            return None
        return (element.name, key[1])

    def _leads(self, owner: SystemElement, source: ConnectorKey, target: ConnectorKey) -> bool:
        """Tell whether a value can go from one connector to the other (SSP 2.0, table in 5.5.2)."""
        gives = self.connectors[source][1].kind
        takes = self.connectors[target][1].kind
        inside_source, inside_target = source[0] == owner.name, target[0] == owner.name
        if gives not in (_TAKES if inside_source else _GIVES):
            return False
        if takes not in (_GIVES if inside_target else _TAKES):
            return False
        is_live = gives in (("input", "inout") if inside_source else ("output", "local", "inout"))
        return not (is_live and takes in (*_FIXED, "calculatedParameter", "constant"))

    def _words(self, owner: SystemElement, one: ConnectorKey, other: ConnectorKey) -> str:
        said = []
        for key in (one, other):
            of_system = " of the system itself" if key[0] == owner.name else ""
            said.append(f"{_name(key)} ({self.connectors[key][1].kind}{of_system})")
        return f"connects {said[0]} with {said[1]}, between which no value can go"

    # ------------------------------------------------------------------ whole ways

    def _traced(self) -> Iterator[Wire]:
        seen_circles: set[ConnectorKey] = set()
        for target in self.feeds:
            element, _ = self.connectors[target]
            chain = self._chain(target, seen_circles)
            if isinstance(element, FmuElement) and chain:
                wire = self._wire(target, chain)
                if wire is not None:
                    yield wire

    def _chain(self, target: ConnectorKey, circles: set[ConnectorKey]) -> list[_Feed]:
        """Return the connections from a target back to its source; none if they run in a circle."""
        chain: list[_Feed] = []
        passed = {target}
        key = target
        while key in self.feeds:
            feed = self.feeds[key]
            chain.append(feed)
            key = feed.source
            if isinstance(self.connectors[key][0], FmuElement):
                break
            if key in passed:
                if key not in circles:
                    circles |= passed
                    what = "comes back to itself through connectors of systems"
                    self._refuse(feed.link, f"{_name(key)} {what}", "give it an output as a source")
                return []
            passed.add(key)
        return chain

    def _wire(self, target: ConnectorKey, chain: list[_Feed]) -> Wire | None:
        source = chain[-1].source
        element, connector = self.connectors[source]
        unit, first = self.units_of(element, connector)
        way = between(first, unit)
        for feed, reached in zip(reversed(chain), self._reached(target, chain)):
            told, last = self.units_of(*self.connectors[reached])
            try:
                step = between(unit, told) if feed.link.converts else UNCHANGED
            except ValueError as error:
                remedy = "connect quantities of one kind, or suppress the conversion of units"
                self._refuse(feed.link, str(error), remedy)
                return None
            way = way.then(step).then(Way(feed.link.factor, feed.link.offset))
            unit = told or unit
        way = way.then(between(unit, last))
        agree = units_agree(first, last)
        is_suppressed = not all(feed.link.converts for feed in chain)
        is_told = way != UNCHANGED or agree is False or (agree is None and is_suppressed)
        from_component = isinstance(element, FmuElement)
        return Wire(source, target, way, is_told, from_component, chain[0].link.place)

    def _reached(self, target: ConnectorKey, chain: list[_Feed]) -> Iterator[ConnectorKey]:
        """Yield the connectors that a value comes to, behind its source."""
        for feed in reversed(chain[:-1]):
            yield feed.source
        yield target

    def _refuse(self, link: Link, what: str, remedy: str) -> None:
        self.problems.append(Problem(link.place, what, remedy))


def targets_of(wires: list[Wire]) -> Mapping[ConnectorKey, list[Wire]]:
    """Return the wires that begin at connectors of systems which nothing feeds, by connector."""
    found: dict[ConnectorKey, list[Wire]] = {}
    for wire in wires:
        if not wire.from_component:
            found.setdefault(wire.source, []).append(wire)
    return found


def _name(key: ConnectorKey) -> str:
    return ".".join(filter(None, key))
