"""Positions of the values in a TOML file, which the standard library does not tell."""

import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import tree_sitter_toml
from tree_sitter import Language, Node, Parser

from ..core.input_text import line_and_column

Key = tuple[str | int, ...]
"""Keys and numbers of elements that lead to a value: ``("barrier", 0, "height")``."""


@dataclass(frozen=True)
class Places:
    """Lines and columns of the values in a file.

    Attributes
    ----------
    source : str
        Name of the file, or of data that were never in one.
    content : bytes
        Of the file.
    offsets : mapping of Key to int
        First byte of each value, or of the key before it.
    replaced : collection of str
        Keys, with dots, whose values are not those of the file: arguments of the same name replace
        them.
    """

    source: str
    content: bytes = b""
    offsets: Mapping[Key, int] = field(default_factory=dict)
    replaced: Collection[str] = ()

    def of(self, key: Key) -> str:
        """Return the place of a value in words.

        Parameters
        ----------
        key : Key
            Of the value; where it is missing, the nearest table above it counts.

        Returns
        -------
        str
            ``slope.toml, line 3, column 5``; the source alone where nothing above it is known; the
            name of the argument that replaces the value.
        """
        names = [".".join(map(str, key[: depth + 1])) for depth in range(len(key))]
        if argument := next((name for name in names if name in self.replaced), None):
            return argument
        while key and key not in self.offsets:
            key = key[:-1]
        if key not in self.offsets:
            return self.source
        before = self.content[: self.offsets[key]].decode("utf-8")
        return f"{self.source}, {line_and_column(before)}"


def places(source: str, text: str) -> Places:
    """Find the places of all values in a text that ``tomllib`` has read.

    Parameters
    ----------
    source : str
        Name of the file.
    text : str
        Its content.

    Returns
    -------
    Places
        Of every table, key and element of an array.
    """
    content = text.encode("utf-8")
    parser = Parser(Language(tree_sitter_toml.language()))
    offsets: dict[Key, int] = {}
    last: dict[Key, int] = {}  # number of the last element of each array of tables
    for node in parser.parse(content).root_node.named_children:
        if node.type == "pair":
            _note(offsets, _pair((), node))
        elif node.type in ("table", "table_array_element"):
            header = _header(node, last)
            offsets.setdefault(header, node.start_byte)
            for entry in node.named_children[1:]:
                _note(offsets, _pair(header, entry))
    return Places(source, content, offsets)


def _note(offsets: dict[Key, int], found: Iterable[tuple[Key, int]]) -> None:
    """Note the first place of each key."""
    for key, offset in found:
        offsets[key] = min(offset, offsets.get(key, offset))


def _header(node: Node, last: dict[Key, int]) -> Key:
    """Return the key of a table; an array of tables on the way stands for its last element."""
    names = list(_names(node.named_children[0]))
    is_element = node.type == "table_array_element"
    key: Key = ()
    for i, name in enumerate(names, 1):
        key = (*key, name)
        if key in last and (i < len(names) or not is_element):
            key = (*key, last[key])
    if is_element:
        last[key] = last.get(key, -1) + 1
        key = (*key, last[key])
    return key


def _names(node: Node) -> Iterator[str]:
    """Yield the names in a key, dotted or not."""
    text = (node.text or b"").decode("utf-8")
    if node.type == "dotted_key":
        for part in node.named_children:
            yield from _names(part)
    elif node.type == "quoted_key":
        yield from tomllib.loads(f"{text} = 0")
    else:
        yield text


def _pair(table: Key, node: Node) -> Iterator[tuple[Key, int]]:
    """Yield key and offset of an entry of a table, and of all that is in it."""
    if node.type == "pair":
        name, value = _without_comments(node)
        key = (*table, *_names(name))
        yield from _value(key, value)
        for depth in range(len(table) + 1, len(key) + 1):  # a.b = 1 makes a table a
            yield key[:depth], node.start_byte


def _value(key: Key, node: Node) -> Iterator[tuple[Key, int]]:
    """Yield key and offset of a value, and of all that is in it."""
    yield key, node.start_byte
    inner = _without_comments(node)
    if node.type == "array":
        for i, element in enumerate(inner):
            yield from _value((*key, i), element)
    elif node.type == "inline_table":
        for entry in inner:
            yield from _pair(key, entry)


def _without_comments(node: Node) -> list[Node]:
    return [child for child in node.named_children if child.type != "comment"]
