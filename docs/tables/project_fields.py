"""The tables of the fields of input files, made from their forms.

``python -m docs.tables.project_fields`` writes them into the pages, between the marks.
"""

from pathlib import Path

from rockshed.input_files.fields import fields, unit_of, usual_of
from rockshed.sites.pile.site import PileSite
from rockshed.sites.shed.site import ShedProject

_DOCS = Path(__file__).parents[1]
PAGE = _DOCS / "designer.md"
FORMS = {PAGE: ShedProject, _DOCS / "piles.md": PileSite}
"""Form of the input file that a page describes."""
BEGIN, END = "<!-- fields of a project -->", "<!-- end of the fields -->"
"""Marks around the table on a page."""


def table(page: Path = PAGE) -> str:
    """Return the table of a page in Markdown: key, unit, meaning and default, usual range."""
    rows = [
        f"| `{name}` | {unit_of(entry)} | {_meaning(entry)} | {_usual(entry)} |"
        for name, entry in fields(FORMS[page])
    ]
    head = ["| key | SI unit | meaning; default | usual |", "|---|---|---|---|"]
    return "\n".join([*head, *rows])


def _meaning(entry) -> str:
    text = (entry.description or "").replace("|", "\\|")
    if entry.is_required():
        return f"**{text or 'required'}**"
    if isinstance(entry.default, bool):
        return f"{text}; {str(entry.default).lower()}"
    if isinstance(entry.default, int | float | str) and entry.default != "":
        return f"{text}; {entry.default}"
    return text


def _usual(entry) -> str:
    usual = usual_of(entry)
    return f"{usual.low:g} to {usual.high:g}" if usual else ""


def written(page: Path = PAGE) -> str:
    """Return a page with the table written anew."""
    before, _, rest = page.read_text(encoding="utf-8").partition(BEGIN)
    return f"{before}{BEGIN}\n{table(page)}\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    for described in FORMS:
        described.write_text(written(described), encoding="utf-8")
