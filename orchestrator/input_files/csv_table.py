"""Tables in CSV files as survey programs, R, QGIS and spreadsheets write them (RFC 4180).

Columns are separated by commas, semicolons or tabs; fields may stand in double quotes, lines end as
on any system, and numbers may have a decimal comma.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..core.errors import InputRefused, Problem
from ..core.input_text import read_text, shown

MOST_ROWS = 1_000_000
"""Largest number of lines of a table."""
LONGEST_FIELD = 1000
"""Letters of a field, at most."""
_SEPARATORS = ";\t,"
"""In the order in which they are looked for in the first line."""
_END = re.compile(r"\r\n|\n|\r")
_QUOTED = re.compile(r'"((?:[^"]|"")*+)"')
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


@dataclass(frozen=True)
class CsvField:
    """A field of a table.

    Attributes
    ----------
    text : str
        Without quotes and blanks around it.
    column : int
        Place in its line at which it begins, counted from 1.
    """

    text: str
    column: int


@dataclass(frozen=True)
class CsvRow:
    """A line of a table that is neither blank nor a comment.

    Attributes
    ----------
    line : int
        Its number in the file, from 1.
    fields : sequence of CsvField
        From left to right.
    """

    line: int
    fields: Sequence[CsvField]


@dataclass(frozen=True)
class CsvTable:
    """The lines of a CSV file.

    Attributes
    ----------
    path : Path
        Of the file.
    rows : sequence of CsvRow
        That of the titles first; empty if the file has none.
    separator : str
        Between the fields.
    """

    path: Path
    rows: Sequence[CsvRow]
    separator: str

    def place(self, row: CsvRow, number: int | None = None) -> str:
        """Return the place of a line, or of a field by its number (from 0), in words."""
        line = f"{self.path}, line {row.line}"
        return line if number is None else f"{line}, column {row.fields[number].column}"

    def number(self, field: CsvField) -> float | None:
        """Return the finite number in a field; None if it has none.

        A decimal comma is one where commas do not separate the columns, and in quotes if what
        follows it are not three digits, which may be thousands.
        """
        text = field.text
        if _DECIMAL_COMMA.fullmatch(text):
            is_thousand = len(re.split("[,eE]", text)[1]) == 3
            if self.separator == "," and is_thousand:
                return None
            text = text.replace(",", ".")
        if not _NUMBER.fullmatch(text):
            return None
        value = float(text)
        return value if math.isfinite(value) else None


def read_csv(path: Path) -> CsvTable:
    """Read a table.

    Parameters
    ----------
    path : Path
        Of the file. Blank lines and lines that begin with # are passed over, and so is the line
        ``sep=;`` of spreadsheets.

    Returns
    -------
    CsvTable
        All other lines.

    Raises
    ------
    InputRefused
        It is no text in UTF-8, has too many lines or too long fields, or a quote is not closed.
    """
    text = read_text(path)
    given = re.match(r"(?:sep=)(.)[ \t]*(?:\r\n|\n|\r|$)", text, re.IGNORECASE)
    separator = given.group(1) if given else _separator(text)
    begin = given.end() if given else 0
    rows = _rows(path, text, begin, separator, 2 if given else 1)
    return CsvTable(path, rows, separator)


def _separator(text: str) -> str:
    """Return the separator of the first line that is neither blank nor a comment."""
    for line in _END.split(text[: 100 * LONGEST_FIELD]):
        if line.strip() and not line.lstrip().startswith("#"):
            bare = re.sub(r'"[^"]*"', "", line)
            return next((mark for mark in _SEPARATORS if mark in bare), ",")
    return ","


def _rows(path: Path, text: str, at: int, separator: str, line: int) -> list[CsvRow]:
    """Return the lines of a text from a place on, where the line of this number begins."""
    rows: list[CsvRow] = []
    while at < len(text):
        end = _line_end(text, at)
        bare = text[at : end.start].strip()
        if not bare or bare.startswith("#"):
            at = end.stop
            line += 1
            continue
        row, at, lines = _row(path, text, at, separator, line)
        rows.append(row)
        line += lines
        if len(rows) > MOST_ROWS:
            problem = f"has more than {MOST_ROWS} lines, the most that are read"
            raise InputRefused([Problem(str(path), problem, "leave out some of them")])
    return rows


def _line_end(text: str, at: int) -> slice:
    """Return the end of the line at this place, and where the next one begins."""
    found = _END.search(text, at)
    return slice(found.start(), found.end()) if found else slice(len(text), len(text))


def _row(path: Path, text: str, at: int, separator: str, line: int) -> tuple[CsvRow, int, int]:
    """Read one line, which goes on after a line end in quotes.

    Returns
    -------
    row : CsvRow
        Of the line.
    at : int
        Place where the next one begins.
    lines : int
        Number of lines of the file that it takes.
    """
    begin = at
    fields: list[CsvField] = []
    while True:
        field, end = _field(path, text, at, separator, line)
        fields.append(CsvField(field, 1 + _first_letter(text, at, end) - begin))
        if end < len(text) and text[end] == separator:
            at = end + 1
            continue
        after = _line_end(text, end).stop
        lines = len(_END.findall(text, begin, after))
        return CsvRow(line, fields), after, lines


def _first_letter(text: str, at: int, end: int) -> int:
    """Return the place of the first letter of a field that is no blank."""
    return at + len(text[at:end]) - len(text[at:end].lstrip())


def _field(path: Path, text: str, at: int, separator: str, line: int) -> tuple[str, int]:
    """Return a field, and the place of the separator or line end that follows it."""
    first = at
    while first < len(text) and text[first] in " \t" and text[first] != separator:
        first += 1
    if not text.startswith('"', first):
        end = _field_end(text, separator, at)
        return _of_length(path, text[at:end].strip(), line), end
    quoted = _QUOTED.match(text, first)
    if quoted is None:
        unclosed = Problem(f"{path}, line {line}", "a quote is not closed", 'write a " at its end')
        raise InputRefused([unclosed])
    end = _field_end(text, separator, quoted.end())
    behind = text[quoted.end() : end].strip()
    content = quoted.group(1).replace('""', '"').strip()
    if behind:
        problem = f"{shown(behind)} stands behind a quoted field"
        raise InputRefused([Problem(f"{path}, line {line}", problem, "put it into the quotes")])
    return _of_length(path, content, line), end


def _field_end(text: str, separator: str, at: int) -> int:
    """Return the place of the separator or line end that comes next."""
    line_end = _line_end(text, at).start
    found = text.find(separator, at, line_end)
    return line_end if found < 0 else found


def _of_length(path: Path, field: str, line: int) -> str:
    if len(field) > LONGEST_FIELD:
        problem = f"has a field of {len(field)} letters, and {LONGEST_FIELD} are the most"
        raise InputRefused([Problem(f"{path}, line {line}", problem, "shorten it")])
    return field
