"""A report as a PDF, set by typst.

The template reads the report as data: no text of a result is ever set as typst's own language.
"""

import json
import re
import shutil
from pathlib import Path
from typing import Any

from ..tables import Table
from ..temporary import TemporaryFolder
from .form import Chapter, Document, Illustration

TEMPLATE = Path(__file__).parent / "report.typ"
MARK = "rockshed report"
"""Keyword in the document by which it is known as one of this program."""
_LONGEST_WORD = 24
"""Letters of a name that is never broken, at most."""
_WORDS = re.compile(r"(\s+)")
_NUMBER = re.compile(r"[\[({=]?[+-]?\d[\d.,]*(?:e[+-]?\d+)?[\]),;}]*", re.IGNORECASE)
_BREAKS = re.compile(r"(?<=[/\\_,=&?.])(?=[^\W\d])")
"""Places after a sign and before a letter, where a long name may go on in the next line."""
_LONGEST_LISTING = 400
"""Lines of a listing, at most: the page and the files of the result have it all."""


def write_pdf(report: Document, file: Path) -> None:
    """Write the report into a file.

    Parameters
    ----------
    report : Document
        Of any result.
    file : Path
        To be written; its folder has to exist.
    """
    import typst  # nobody else needs it

    with TemporaryFolder("rockshed-") as folder:
        content = {
            "title": pieces(report.title),
            "lines": [pieces(line) for line in report.lines],
            "status": pieces(report.status),
            "mark": MARK,
            "chapters": [
                _chapter(chapter, number, folder) for number, chapter in enumerate(report.chapters)
            ],
        }
        (folder / "report.json").write_text(json.dumps(content), encoding="utf-8")
        shutil.copyfile(TEMPLATE, folder / TEMPLATE.name)
        typst.compile(str(folder / TEMPLATE.name), output=str(file), root=str(folder))


def _chapter(chapter: Chapter, number: int, folder: Path) -> dict[str, Any]:
    lines = chapter.listing.splitlines()
    if len(lines) > _LONGEST_LISTING:
        lines = [*lines[:_LONGEST_LISTING], f"... and {len(lines) - _LONGEST_LISTING} lines more"]
    drawn = [
        _picture(illustration, folder / f"{number}-{place}")
        for place, illustration in enumerate(chapter.illustrations)
    ]
    return {
        "title": chapter.title,
        "alarm": chapter.alarm,
        "paragraphs": [pieces(text) for text in chapter.paragraphs],
        "listing": "\n".join(lines),
        "tables": [_table(table) for table in chapter.tables],
        "pictures": drawn,
    }


def _picture(illustration: Illustration, place: Path) -> dict[str, str]:
    """Draw a picture; return its title, the name of its file, and why there is none."""
    file = place.with_suffix(illustration.printed)
    reason = illustration.drawn_into(file)
    return {"title": illustration.title, "file": "" if reason else file.name, "reason": reason}


def _table(table: Table) -> dict[str, Any]:
    return {
        "title": table.title,
        "columns": list(table.columns),
        "right": [title in table.right for title in table.columns],
        "wide": [_width(table, place) for place in range(len(table.columns))],
        "rows": [[pieces(cell) for cell in row] for row in table.rows],
        "notes": [pieces(note) for note in table.notes],
    }


def _width(table: Table, place: int) -> bool:
    """Tell whether a column takes what width is left: the cells of others stay on one line."""
    return max((len(row[place]) for row in table.rows), default=0) > 28


def pieces(text: str) -> list[str]:
    """Divide a text where a line may end in the middle of a long name or digest.

    A number is never divided, and nothing is added to the text: the pieces joined are the text.

    Parameters
    ----------
    text : str
        Of the report.

    Returns
    -------
    list of str
        Whole words stay together, as lines may end between them anyway.
    """
    made = [""]
    for word in _WORDS.split(text):
        first, *rest = _parts(word)
        made[-1] += first
        made += rest
    return made


def _parts(word: str) -> list[str]:
    """Divide a long word: after signs, and where it has none, at the longest length."""
    if len(word) <= _LONGEST_WORD or _NUMBER.fullmatch(word):
        return [word]
    return [
        part[start : start + _LONGEST_WORD]
        for part in _BREAKS.split(word)
        for start in range(0, len(part), _LONGEST_WORD)
    ]


def is_own(head: bytes) -> bool:
    """Tell whether the bytes of a PDF are those of a report.

    Parameters
    ----------
    head : bytes
        Content of the file.
    """
    return head.startswith(b"%PDF") and MARK.encode() in head
