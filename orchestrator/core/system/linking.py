"""Connections of a system as single pairs of ports whose kinds and units fit."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..errors import InputRefused, counted
from ..fmu.slave import NUMBERS, REAL, STRING, Source
from .finding import Finder, few
from .joining import Joiner
from .parts import Connection
from .plan import End
from .units import unit_text, units_agree

Links = list[tuple[End, End]]
"""Source and target of every single connection."""


@dataclass
class Linker:
    """Resolves the connections of a system.

    Attributes
    ----------
    finder : Finder
        Finds their ports, and takes problems.
    sources : mapping of str to Source
        Of the components.
    linear : dict of str to (float, float)
        Factor and offset of inputs that get other values than their sources have.
    """

    finder: Finder
    sources: Mapping[str, Source]
    linear: dict[str, tuple[float, float]] = field(default_factory=dict)

    def links(self) -> Links:
        """Return the pairs of all connections; an input that is driven twice is refused."""
        links: Links = []
        for connection in self.finder.system.connections:
            parts = self._of_terminals(connection) if connection.terminals else [connection]
            for part in parts:
                links += self._expanded(part)
        drivers: dict[str, list[str]] = {}
        for source, target in links:
            drivers.setdefault(target.name, []).append(source.name)
        for name, sources in drivers.items():
            if len(sources) > 1:
                self.finder.refuse(
                    name,
                    f"is driven {len(sources)} times: by {' and by '.join(sources)}",
                    "keep one of the connections",
                )
        return links

    def _of_terminals(self, connection: Connection) -> list[Connection]:
        """Return the connections that a connection of two terminals stands for."""
        ends = (self.finder.split(connection.source), self.finder.split(connection.target))
        try:
            return Joiner(self.finder.descriptions, self.sources).connections(
                str(connection), *ends
            )
        except InputRefused as refusal:
            self.finder.problems += refusal.problems
            return []

    def _expanded(self, connection: Connection) -> Links:
        where = str(connection)
        sources = self.finder.of_causality(
            where, self.finder.ends(where, *self.finder.split(connection.source)), "output"
        )
        targets = self.finder.of_causality(
            where, self.finder.ends(where, *self.finder.split(connection.target)), "input"
        )
        if not sources or not targets:
            return []
        shapes = [
            self.finder.shape_of(*self.finder.split(name))
            for name in (connection.source, connection.target)
        ]
        if all(shapes) and shapes[0] != shapes[1]:
            texts = " with one of ".join(" x ".join(map(str, shape)) for shape in shapes)
            remedy = "connect arrays of one shape, or elements: x[1], x[2..4]"
            self.finder.refuse(where, f"connects an array of {texts} elements", remedy)
            return []
        if len(sources) != len(targets):
            self.finder.refuse(
                where,
                f"connects {counted(len(sources), 'output')} with {counted(len(targets), 'input')}",
                "give ranges of one length, [1..24], or build the FMUs with sizes that fit",
            )
            return []
        pairs = list(zip(sources, targets, strict=True))
        self._check_pairs(where, pairs, connection.is_linear)
        if connection.way != (1.0, 0.0):
            self.linear |= {target.name: connection.way for target in targets}
        return pairs

    def _check_pairs(self, where: str, pairs: Links, is_linear: bool) -> None:
        """Refuse the first pair that does not fit: the elements of an array have it in common."""
        for source, target in pairs:
            why = _misfit_of_kinds(source, target, is_linear)
            if why is None and not is_linear:  # of a linear connection, units are not looked at
                why = _misfit_of_units(source, target)
            if why is not None:
                self.finder.refuse(where, *why)
                return


_Why = tuple[str, str]
"""Reason why a pair of ports does not fit, and a remedy."""


def _misfit_of_kinds(source: End, target: End, is_linear: bool) -> _Why | None:
    """Return why the kinds of two ports do not fit; None where they do."""
    kind = source.port.kind
    if kind != target.port.kind or kind not in (*NUMBERS, STRING):
        return (
            f"{source.name} is {source.port.type} and {target.name} is {target.port.type}",
            "connect ports of one type, Real, Integer, Boolean or String",
        )
    if source.port.items and target.port.items not in ({}, source.port.items):
        names = [f"{end.name} is one of {few(end.port.items)}" for end in (source, target)]
        return " and ".join(names), "connect enumerations of the same items"
    if is_linear and kind != REAL:
        what = f"has a factor or an offset, and {source.name} is {kind}"
        return what, "leave them out: they are for Real"
    return None


def _misfit_of_units(source: End, target: End) -> _Why | None:
    """Return why the units of two ports do not fit; None where they do."""
    agree = units_agree(source.port.unit, target.port.unit)
    if agree is False:
        return (
            f"{source.name} is in {unit_text(source.port.unit)}, {target.name} in "
            f"{unit_text(target.port.unit)}",
            "connect ports of one unit",
        )
    if agree is None:
        ports = (source, target)
        unknown = next(e for e in ports if e.port.unit and e.port.unit.base is None)
        other = target if unknown is source else source
        return (
            f"the unit {unknown.port.unit_name} of {unknown.name} is not defined in its "
            f"model description, and {other.name} is in {unit_text(other.port.unit)}",
            "give the connection a factor, 1 if they are the same",
        )
    return None
