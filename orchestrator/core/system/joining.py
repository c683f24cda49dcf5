"""Connections of terminals: the single connections that they stand for."""

from collections.abc import Mapping

from ..errors import InputRefused, Problem
from ..fmu.description import Description
from ..fmu.fmu_slave import TERMINALS_FILE
from ..fmu.slave import Source
from ..fmu.terminals import Terminal, TerminalMember, matched, terminals_in, terminals_of_bonds
from .names import nearest
from .parts import Connection

_ONE_BY_ONE = "connect the variables one by one"

_Place = tuple[str, str]
"""A component and a name in it."""


class Joiner:
    """Turns connections of terminals into connections of variables.

    Parameters
    ----------
    descriptions : mapping of str to Description
        Of the components that can be described.
    sources : mapping of str to Source
        Of all components.
    """

    def __init__(
        self, descriptions: Mapping[str, Description], sources: Mapping[str, Source]
    ) -> None:
        self._descriptions = descriptions
        self._sources = sources
        self._known: dict[str, dict[str, Terminal]] = {}

    def connections(self, where: str, one: _Place, other: _Place) -> list[Connection]:
        """Return the connections that a connection of two terminals stands for.

        Parameters
        ----------
        where : str
            Names the connection in messages.
        one, other : (str, str)
            Component and terminal.

        Raises
        ------
        InputRefused
            A terminal is not there, or they do not fit together.
        """
        missing = [name for name, _ in (one, other) if name not in self._sources]
        if missing:
            hint = nearest(missing[0], self._sources)
            raise _refusal(where, f"there is no component {missing[0]!r}", hint)
        if any(name not in self._descriptions for name, _ in (one, other)):
            return []  # the reason is told with the component
        found = [self._terminal(where, *end) for end in (one, other)]
        try:
            pairs = matched(*found)
        except ValueError as error:
            raise _refusal(where, str(error)) from error
        return [self._of_members(where, (one[0], a), (other[0], b)) for a, b in pairs]

    def _terminal(self, where: str, component: str, name: str) -> Terminal:
        try:
            known = self._terminals(component)
        except ValueError as error:
            raise _refusal(where, f"{component}: {error}") from error
        if name not in known:
            hint = nearest(name, known) if known else _ONE_BY_ONE
            raise _refusal(where, f"{component} has no terminal {name!r}", hint)
        return known[name]

    def _terminals(self, component: str) -> dict[str, Terminal]:
        """Return the terminals of a component, of its bonds or as its file describes them."""
        if component not in self._known:
            read = getattr(self._sources[component], "content", None)
            xml = None if read is None else read(TERMINALS_FILE)
            bonds = terminals_of_bonds(self._descriptions[component])
            self._known[component] = bonds if xml is None else {**bonds, **terminals_in(xml)}
        return self._known[component]

    def _of_members(
        self, where: str, one: tuple[str, TerminalMember], other: tuple[str, TerminalMember]
    ) -> Connection:
        """Return the connection of two members in its direction.

        Flows that both ends count inwards, or both outwards, change their sign.
        """
        names = [f"{component}.{member.variable}" for component, member in (one, other)]
        kinds = [self._causality(component, member.variable) for component, member in (one, other)]
        if sorted(kinds) != ["input", "output"]:
            told = " and ".join(f"{name} is {kind}" for name, kind in zip(names, kinds))
            raise _refusal(where, f"joins no output with an input: {told}")
        source, target = names if kinds[0] == "output" else reversed(names)
        flows = {member.kind for _, member in (one, other)}
        is_turned = len(flows) == 1 and flows != {"signal"}
        return Connection(source=source, target=target, factor=-1.0 if is_turned else None)

    def _causality(self, component: str, name: str) -> str:
        """Return the causality of a variable or array, in words where there is none."""
        known = self._descriptions[component]
        array = known.arrays.get(name)
        port = known.ports.get(array.names[0] if array and array.names else name)
        return "not there" if port is None else port.causality


def _refusal(where: str, what: str, remedy: str = _ONE_BY_ONE) -> InputRefused:
    return InputRefused([Problem(where, what, remedy)])
