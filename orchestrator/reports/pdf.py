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
_LONG_WORD = re.compile(r"[^\s\u200b]{24}")
_BREAKS = re.compile(r"([/\\_.,=&?])(?=\w)")
"""Signs after which a long name may go on in the next line."""
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
            "title": _breakable(report.title),
            "lines": [_breakable(line) for line in report.lines],
            "status": _breakable(report.status),
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
        "paragraphs": [_breakable(text) for text in chapter.paragraphs],
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
        "rows": [[_breakable(cell) for cell in row] for row in table.rows],
        "notes": [_breakable(note) for note in table.notes],
    }


def _width(table: Table, place: int) -> bool:
    """Tell whether a column takes what width is left: the cells of others stay on one line."""
    return max((len(row[place]) for row in table.rows), default=0) > 28


def _breakable(text: str) -> str:
    """Return a text with places where long names and digests may be broken."""
    softer = _BREAKS.sub("\\1\u200b", text)
    return _LONG_WORD.sub(lambda word: f"{word[0]}\u200b", softer)


def is_own(head: bytes) -> bool:
    """Tell whether the bytes of a PDF are those of a report.

    Parameters
    ----------
    head : bytes
        Content of the file.
    """
    return head.startswith(b"%PDF") and MARK.encode() in head
