"""Places in memory that hold pointers, when code for 64-bit pointers becomes code for 32-bit ones.

Numba's code is written for pointers of 8 bytes: it reserves structures by their type, and reaches
their members partly by type, partly by distance in bytes. With pointers of 4 bytes the two would no
longer agree. Here every structure with a pointer in it keeps its size and its distances, as bytes;
a pointer then lies in the first half of its place.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

_POINTER = re.compile(r"\bptr\b")
_RESERVED = re.compile(r"= alloca (?P<type>[\[{p])")
_REACHED = re.compile(r"getelementptr (?P<flags>(?:inbounds |nuw |nusw )*)(?P<type>[\[{p])")
_LOADED = re.compile(r"^  (?P<to>%\S+) = load (?P<type>\{)")
_STORED = re.compile(r"^  store (?P<type>\{)")
_STORED_TO = re.compile(r" (%[^\s,]+|zeroinitializer), ptr (%[^\s,]+)")
_TOKEN = re.compile(r"\s*(\{|\}|\[\d+ x|\]|,|ptr|double|float|i\d+)")


class LayoutError(Exception):
    """Code that reaches memory in a way that is not known here."""


@dataclass(frozen=True)
class MemoryType:
    """A type of LLVM: its text, size and alignment (bytes), and its members.

    Parameters
    ----------
    text : str
        As LLVM writes it.
    size, alignment : int
        With pointers of 8 bytes (bytes).
    members : tuple of (int, MemoryType)
        Distance from the beginning (bytes) and type of each; none of a number or pointer.
    """

    text: str
    size: int
    alignment: int
    members: "tuple[tuple[int, MemoryType], ...]" = ()

    def leaves(self) -> "Iterator[tuple[tuple[int, ...], int, MemoryType]]":
        """Yield path, distance (bytes) and type of every number and pointer."""
        if not self.members:
            yield (), 0, self
        for number, (distance, member) in enumerate(self.members):
            for path, inner, leaf in member.leaves():
                yield (number, *path), distance + inner, leaf


def kind_at(text: str, at: int) -> tuple[MemoryType, int]:
    """Read the type that begins at a place of a text.

    Parameters
    ----------
    text : str
        Line of LLVM.
    at : int
        Place of its first character.

    Returns
    -------
    kind : MemoryType
        The type.
    end : int
        Place behind it.

    Raises
    ------
    LayoutError
        A type that is not known.
    """
    found = _TOKEN.match(text, at)
    if not found:
        raise LayoutError(f"no known type: {text[at : at + 40]}")
    word = found[1]
    end = found.end()
    if word == "{":
        return _structure(text, end)
    if word.startswith("["):
        member, end = kind_at(text, end)
        count = int(word[1:-2])
        members = tuple((number * member.size, member) for number in range(count))
        kind = MemoryType(f"{word} {member.text}]", count * member.size, member.alignment, members)
        return kind, text.index("]", end) + 1
    size = {"ptr": 8, "double": 8, "float": 4, "i1": 1}.get(word) or int(word[1:]) // 8
    return MemoryType(word, size, size), end


def _structure(text: str, end: int) -> tuple[MemoryType, int]:
    members: list[tuple[int, MemoryType]] = []
    size = 0
    alignment = 1
    while True:
        member, end = kind_at(text, end)
        size = _up(size, member.alignment)
        members.append((size, member))
        size += member.size
        alignment = max(alignment, member.alignment)
        found = _TOKEN.match(text, end)
        if not found or found[1] not in ",}":
            raise LayoutError(f"no known structure: {text}")
        end = found.end()
        if found[1] == "}":
            inside = ", ".join(member.text for _, member in members)
            return MemoryType(
                f"{{ {inside} }}", _up(size, alignment), alignment, tuple(members)
            ), end


def _up(size: int, alignment: int) -> int:
    return -(-size // alignment) * alignment


def kept_places(code: str) -> str:
    """Rewrite code for pointers of 8 bytes, so that it also holds where they have 4.

    Parameters
    ----------
    code : str
        A module as LLVM writes it.

    Returns
    -------
    str
        The same module.

    Raises
    ------
    LayoutError
        Code that reaches memory in a way that is not known here.
    """
    return "\n".join(_kept(line, number) for number, line in enumerate(code.split("\n")))


def _kept(line: str, number: int) -> str:
    if not _POINTER.search(line):
        return line
    if found := _RESERVED.search(line):
        return _as_bytes(line, found.start("type"))
    if found := _REACHED.search(line):
        kind, end = kind_at(line, found.start("type"))
        if not _POINTER.search(kind.text):
            return line
        if line[end:].count(", i") != 1:
            raise LayoutError(f"a member that is reached by its number: {line}")
        return _as_bytes(line, found.start("type"))
    if found := _LOADED.match(line):
        kind, end = kind_at(line, found.start("type"))
        return _loaded(found["to"], kind, line[end:], number)
    if found := _STORED.match(line):
        kind, end = kind_at(line, found.start("type"))
        return _stored(kind, line[end:], number)
    return line


def _as_bytes(line: str, at: int) -> str:
    """Return a line with as many bytes in the place of the type that begins there."""
    kind, end = kind_at(line, at)
    return f"{line[:at]}[{kind.size} x i8]{line[end:]}"


def _loaded(to: str, kind: MemoryType, rest: str, number: int) -> str:
    """Return instructions that load a structure member by member."""
    found = re.match(r", ptr (%[^\s,]+)", rest)
    if not found:
        raise LayoutError(f"a structure that is loaded from no known place: {rest}")
    lines = []
    whole = "poison"
    leaves = list(kind.leaves())
    for place, (path, distance, leaf) in enumerate(leaves):
        address, value = f"%place.{number}.{place}", f"%member.{number}.{place}"
        name = to if place == len(leaves) - 1 else f"%whole.{number}.{place}"
        lines.append(f"  {address} = getelementptr i8, ptr {found[1]}, i64 {distance}")
        lines.append(f"  {value} = load {leaf.text}, ptr {address}, align {leaf.alignment}")
        where = ", ".join(map(str, path))
        lines.append(f"  {name} = insertvalue {kind.text} {whole}, {leaf.text} {value}, {where}")
        whole = name
    return "\n".join(lines)


def _stored(kind: MemoryType, rest: str, number: int) -> str:
    """Return instructions that store a structure member by member."""
    found = _STORED_TO.match(rest)
    if not found:
        raise LayoutError(f"a structure that is stored to no known place: {rest}")
    whole, to = found.groups()
    lines = []
    for place, (path, distance, leaf) in enumerate(kind.leaves()):
        address, value = f"%place.{number}.{place}", f"%member.{number}.{place}"
        where = ", ".join(map(str, path))
        lines.append(f"  {value} = extractvalue {kind.text} {whole}, {where}")
        lines.append(f"  {address} = getelementptr i8, ptr {to}, i64 {distance}")
        lines.append(f"  store {leaf.text} {value}, ptr {address}, align {leaf.alignment}")
    return "\n".join(lines)
