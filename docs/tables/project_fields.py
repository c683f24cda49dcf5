"""The table of a project's fields, made from its form: ``python -m docs.tables.project_fields``.

Writes it into docs/designer.md, between the marks.
"""

from pathlib import Path

from rockshed.input_files.fields import fields, unit_of, usual_of
from rockshed.sites.shed.site import ShedProject

PAGE = Path(__file__).parents[1] / "designer.md"
BEGIN, END = "<!-- fields of a project -->", "<!-- end of the fields -->"
"""Marks around the table on the page."""


def table() -> str:
    """Return the table in Markdown: key, unit, meaning and default, usual range."""
    rows = [
        f"| `{name}` | {unit_of(entry)} | {_meaning(entry)} | {_usual(entry)} |"
        for name, entry in fields(ShedProject)
    ]
    head = ["| key | SI unit | meaning; default | usual |", "|---|---|---|---|"]
    return "\n".join([*head, *rows])


def _meaning(entry) -> str:
    text = entry.description.replace("|", "\\|")
    if entry.is_required():
        return f"**{text}**"
    if isinstance(entry.default, int | float | str) and entry.default != "":
        return f"{text}; {entry.default}"
    return text


def _usual(entry) -> str:
    usual = usual_of(entry)
    return f"{usual.low:g} to {usual.high:g}" if usual else ""


def written() -> str:
    """Return the page with the table written anew."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    return f"{before}{BEGIN}\n{table()}\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    PAGE.write_text(written(), encoding="utf-8")
