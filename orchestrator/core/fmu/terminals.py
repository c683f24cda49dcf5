"""Terminals of FMUs: variables that are connected together, in FMI 3.0 and as bonds of our own.

FMI 3.0 describes them in ``terminalsAndIcons.xml``. An FMU of FMI 2.0 has none; those with our
annotations declare mechanical bonds, which are terminals of the same form.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

from .description import Description

PLUG, BUS, SEQUENCE = "plug", "bus", "sequence"
"""Rules by which the members of two terminals are matched: by name, all of them; by name, those
that both have; one after the other."""


@dataclass(frozen=True)
class TerminalMember:
    """A variable of a terminal.

    Attributes
    ----------
    variable : str
        Its name in the FMU; of an array, without an element.
    kind : str
        signal, inflow or outflow.
    """

    variable: str
    kind: str = "signal"


@dataclass(frozen=True)
class Terminal:
    """Variables that are connected together.

    Attributes
    ----------
    members : mapping of str to TerminalMember
        By the name that both ends of a connection have for it; those of a terminal in it follow
        with its name and a dot before their own.
    rule : str
        Matching rule.
    kind : str
        Only terminals of the same kind are connected; empty for any.
    streams : tuple of str
        Names of stream variables, which nobody can connect here.
    """

    members: Mapping[str, TerminalMember]
    rule: str = PLUG
    kind: str = ""
    streams: tuple[str, ...] = ()


def terminals_in(xml: bytes) -> dict[str, Terminal]:
    """Read the terminals of an FMU of FMI 3.0.

    Parameters
    ----------
    xml : bytes
        Content of ``terminalsAndIcons.xml``.

    Returns
    -------
    dict of str to Terminal
        By name; a terminal in another one as ``outer.inner``.

    Raises
    ------
    ValueError
        It cannot be read.
    """
    try:
        root = ElementTree.fromstring(xml)
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise ValueError(f"its terminalsAndIcons.xml cannot be read: {error}") from error
    return {
        name: terminal
        for element in root.findall("Terminals/Terminal")
        for name, terminal in _read(element, "")
    }


def _read(element: ElementTree.Element, outer: str) -> Iterator[tuple[str, Terminal]]:
    """Yield a terminal, and those in it."""
    name = outer + element.get("name", "")
    yield (
        name,
        Terminal(
            dict(_members(element, "")),
            element.get("matchingRule", PLUG),
            element.get("terminalKind", ""),
            tuple(e.get("inStreamMemberName", "") for e in element.iter(_STREAM)),
        ),
    )
    for inner in element.findall("Terminal"):
        yield from _read(inner, f"{name}.")


_STREAM = "TerminalStreamMemberVariable"


def _members(element: ElementTree.Element, outer: str) -> Iterator[tuple[str, TerminalMember]]:
    for number, member in enumerate(element.findall("TerminalMemberVariable"), 1):
        variable = member.get("variableName", "")
        name = member.get("memberName") or str(number)
        yield outer + name, TerminalMember(variable, member.get("variableKind", "signal"))
    for inner in element.findall("Terminal"):
        yield from _members(inner, f"{outer}{inner.get('name', '')}.")


def terminals_of_bonds(description: Description) -> dict[str, Terminal]:
    """Return the mechanical bonds that a description declares, as terminals.

    Parameters
    ----------
    description : Description
        With our annotations, or without any.
    """
    return {
        bond["name"]: Terminal(
            {member: TerminalMember(name) for member, name in bond["members"].items()}
        )
        for bond in description.bonds
    }


def matched(one: Terminal, other: Terminal) -> list[tuple[TerminalMember, TerminalMember]]:
    """Return which members of two terminals belong together.

    Parameters
    ----------
    one, other : Terminal
        Of two FMUs.

    Raises
    ------
    ValueError
        They do not fit together; with the reason.
    """
    if one.kind and other.kind and one.kind != other.kind:
        raise ValueError(f"one is a terminal of the kind {one.kind}, the other of {other.kind}")
    if one.rule != other.rule:
        raise ValueError(f"one is matched by the rule {one.rule}, the other by {other.rule}")
    if streams := one.streams + other.streams:
        raise ValueError(f"has the stream variable {streams[0]}, and streams cannot be connected")
    members = (one.members, other.members)
    if one.rule == SEQUENCE:
        if len(members[0]) != len(members[1]):
            raise ValueError(f"one has {len(members[0])} members, the other {len(members[1])}")
        return list(zip(members[0].values(), members[1].values(), strict=True))
    if one.rule not in (PLUG, BUS):
        raise ValueError(f"the rule {one.rule} by which they are matched is not known")
    lonely = sorted(set(members[0]) ^ set(members[1]))
    if one.rule == PLUG and lonely:
        raise ValueError(f"only one of both has {', '.join(lonely)}")
    common = [name for name in members[0] if name in members[1]]
    if not common:
        raise ValueError("they have no member in common")
    return [(members[0][name], members[1][name]) for name in common]
