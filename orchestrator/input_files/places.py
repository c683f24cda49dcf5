"""Where things stand in a TOML file, which the standard library's reader does not tell."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

Path = tuple[str | int, ...]
"""Keys and numbers of elements that lead to a value: ``("barrier", 0, "height")``."""

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}|' r"'''(?:.|\n)*?'{3,5}|" r'"(?:\\.|[^"\\\n])*"|' r"'[^'\n]*'",
    re.DOTALL,
)
_PLAIN = re.compile(r"[^,\]}#\n]*")


@dataclass
class _Scanner:
    """Walks through a text that is known to be valid TOML."""

    text: str
    at: int = 0
    found: dict[Path, int] = field(default_factory=dict)
    tables: dict[Path, int] = field(default_factory=dict)

    def document(self) -> None:
        """Headers of tables and keys, to the end."""
        table: Path = ()
        while self.skip():
            begin = self.at
            if self.text.startswith("[[", self.at):
                table = self.header(2)
                number = self.tables[table] = self.tables.get(table, -1) + 1
                table = (*table, number)
            elif self.text[self.at] == "[":
                table = self.header(1)
            else:
                self.entry(table)
                continue
            self.found.setdefault(table, begin)

    def header(self, brackets: int) -> Path:
        """A table's path; an array of tables on the way stands for its last element."""
        self.at += brackets
        path: Path = ()
        keys = self.key()
        for i, name in enumerate(keys):
            path = (*path, name)
            if path in self.tables and (i + 1 < len(keys) or brackets == 1):
                path = (*path, self.tables[path])
        self.skip()
        self.at += brackets
        return path

    def key(self) -> list[str]:
        """A key, dotted or not."""
        names = []
        while True:
            self.skip()
            quoted = self.text[self.at] in "\"'"
            match = (_STRING if quoted else _BARE).match(self.text, self.at)
            assert match is not None
            names.append(match.group()[1:-1] if quoted else match.group())
            self.at = match.end()
            self.skip()
            if self.text[self.at : self.at + 1] != ".":
                return names
            self.at += 1

    def entry(self, table: Path) -> None:
        """``key = value``."""
        begin = self.at
        path = (*table, *self.key())
        self.at += 1  # =
        self.skip()
        self.value(path)
        self.found[path] = begin

    def value(self, path: Path) -> None:
        """A value and all that is in it."""
        self.found[path] = self.at
        first = self.text[self.at]
        if first in "[{":
            self.members(path, first)
            return
        match = (_STRING if first in "\"'" else _PLAIN).match(self.text, self.at)
        assert match is not None
        self.at = match.end()

    def members(self, path: Path, opening: str) -> None:
        """Elements of an array, or entries of an inline table."""
        self.at += 1
        number = 0
        while self.skip() and self.text[self.at] not in "]}":
            if opening == "[":
                self.value((*path, number))
            else:
                self.entry(path)
            number += 1
            self.skip()
            if self.text[self.at] == ",":
                self.at += 1
        self.at += 1

    def skip(self) -> bool:
        """Leave out blanks and comments; whether anything follows."""
        match = _BLANK.match(self.text, self.at)
        assert match is not None
        self.at = match.end()
        return self.at < len(self.text)


@dataclass(frozen=True)
class Places:
    """Lines and columns of the values in a file."""

    file: str
    text: str = ""
    offsets: Mapping[Path, int] = field(default_factory=dict)

    def of(self, path: Path) -> str:
        """``slope.toml, line 3, column 5``: of a value, or of what is nearest above it in the same tables."""
        while path and path not in self.offsets:
            path = path[:-1]
        offset = self.offsets.get(path)
        return self.file if offset is None else f"{self.file}, {line_and_column(self.text, offset)}"


def line_and_column(text: str, offset: int) -> str:
    """``line 3, column 5`` of a place in a text, counted from 1."""
    return f"line {text.count(chr(10), 0, offset) + 1}, column {offset - text.rfind(chr(10), 0, offset)}"


def places(file: str, text: str) -> Places:
    """The places of all values in a text that ``tomllib`` has read."""
    scanner = _Scanner(text)
    scanner.document()
    return Places(file, text, scanner.found)
