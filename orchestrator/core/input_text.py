"""Text files as people have them: one reader for all, and what is wrong with them in words."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from datetime import date, time
from pathlib import Path
from typing import Any

from .errors import InputRefused, Problem

MOST_BYTES = 64 << 20
"""Largest size (bytes) of a text file that is read."""
DEEPEST = 40
"""Tables and lists in one another that a file has at most."""
_LONGEST = 60
"""Letters of a value that a message shows."""
_AT_LINE = re.compile(r"at line (\d+)")
_UNQUOTED = re.compile(
    r"(?P<key>\s*[\w.\"-]+\s*)=\s*(?P<number>[+-]?\d[\d.,]*)(?P<unit>\s*[^\W\d][\w/^*.²³⁴]*|\s*°)?\s*(?:#.*)?$"
)
"""A line with a bare value that TOML cannot read: ``mass = 1,8 t``."""
_TWICE = ("Cannot overwrite a value", "Cannot declare", "Duplicate inline table key")
"""Begins of what tomllib says of a key or table that is there already."""
_QUOTED_KEY = re.compile(r"inline table key '(.+)'")
_KEY = re.compile(r"\s*(\[.*\]|[^=\[]*[^=\[\s])\s*(?:=|#|$)")
"""The name of a table or a key, where its line is known."""
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


def read_text(path: Path) -> str:
    """Read a text file in UTF-8; a byte order mark is passed over.

    Parameters
    ----------
    path : Path
        Of the file.

    Returns
    -------
    str
        Its content, with the line ends that it has.

    Raises
    ------
    InputRefused
        It cannot be read, is too long, or is no text in UTF-8.
    """
    try:
        if path.is_dir():
            raise InputRefused([Problem(str(path), "is a folder", "name a file in it")])
        with path.open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        problem = Problem(str(path), f"cannot be read: {reason}", "correct the path")
        raise InputRefused([problem]) from error
    if len(content) > MOST_BYTES:
        text = f"has more than {MOST_BYTES >> 20} MiB, the most that is read"
        raise InputRefused([Problem(str(path), text, "leave out what is not needed")])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputRefused([_not_utf_8(path, content, error.start)]) from error


def _not_utf_8(path: Path, content: bytes, at: int) -> Problem:
    remedy = "save it again with the encoding UTF-8"
    if content[:2] in _UTF_16:
        form = "TOML" if path.suffix == ".toml" else "what is read here"
        return Problem(str(path), f"is written in UTF-16, and {form} is UTF-8", remedy)
    before = content[:at].decode("utf-8-sig")
    return Problem(f"{path}, {line_and_column(before)}", "is no text in UTF-8", remedy)


def line_and_column(before: str) -> str:
    """Return the place that follows some text: ``line 3, column 5``, counted from 1."""
    return f"line {before.count(chr(10)) + 1}, column {len(before) - before.rfind(chr(10))}"


def toml_content(path: Path, text: str) -> dict[str, Any]:
    """Read the content of a TOML file.

    Parameters
    ----------
    path : Path
        Of the file, for messages.
    text : str
        Of the file.

    Returns
    -------
    dict
        Its keys and values, at most :data:`DEEPEST` in one another.

    Raises
    ------
    InputRefused
        It is no TOML, nested too deeply, or has a number of too many digits.
    """
    reason, remedy = "", "correct the file"
    content: dict[str, Any] = {}
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        reason = f"is not valid TOML: {error}"
        remedy = _remedy_of_line(text, str(error))
    except RecursionError:
        reason = _too_deep()
    except (ValueError, OverflowError) as error:  # Python reads no integer of so many digits
        reason = f"has a value that cannot be read: {_first_sentence(error)}"
    if not reason and _is_too_deep(content):
        reason = _too_deep()
    if reason:
        raise InputRefused([Problem(str(path), reason, remedy)])
    return content


def _remedy_of_line(text: str, error: str) -> str:
    """Return what to do about a line that is no TOML: a value with a unit needs quotes."""
    at = _AT_LINE.search(error)
    lines = text.splitlines()
    if error.startswith(_TWICE):
        name = _QUOTED_KEY.search(error) or _KEY.match(lines[int(at[1]) - 1 if at else -1])
        return f"{name[1] if name else 'a key'} stands twice: keep one of them"
    line = lines[int(at[1]) - 1] if at and int(at[1]) <= len(lines) else ""
    found = _UNQUOTED.match(line)
    if found is None:
        return "correct the file"
    number, unit = found["number"].replace(",", "."), (found["unit"] or "").strip()
    key = found["key"].strip()
    if not unit and "," not in found["number"]:
        return "correct the file"
    if not unit:
        return f"a number has a decimal point and no comma: {key} = {number}"
    return f'a value with a unit stands in quotes, with a decimal point: {key} = "{number} {unit}"'


def _first_sentence(error: Exception) -> str:
    """Return the reason of an error as far as it is for the user."""
    words = str(error).split(";")[0].split(":")[0]
    if "integer string conversion" in words:
        return "an integer of thousands of digits"
    return words[:_LONGEST]


def _too_deep() -> str:
    return f"is nested more than {DEEPEST} deep: tables or lists in one another"


def _is_too_deep(content: Any) -> bool:
    """Tell whether there are too many tables and lists in one another, without recursion."""
    level = [content]
    for _ in range(DEEPEST + 1):
        level = [
            inner
            for outer in level
            for inner in (outer.values() if isinstance(outer, dict) else outer)
            if isinstance(inner, dict | list)
        ]
    return bool(level)


def shown(value: Any) -> str:
    """Write a value for a message, as it would stand in a file, and cut if it is long."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int):
        # of a number of very many digits, Python writes none
        return str(value) if value.bit_length() < 200 else "an integer of many digits"
    if isinstance(value, date | time):
        return value.isoformat()
    text = _compound(value) if isinstance(value, Mapping | list | tuple) else repr(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _compound(value: Mapping[str, Any] | Sequence[Any]) -> str:
    """Write the first entries of a table or a list."""
    most = 8
    rest = ", ..." if len(value) > most else ""
    if isinstance(value, Mapping):
        entries = [f"{key} = {shown(inner)}" for key, inner in list(value.items())[:most]]
        return "{" + ", ".join(entries) + rest + "}"
    return "[" + ", ".join(map(shown, value[:most])) + rest + "]"
