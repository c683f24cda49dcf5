"""The designer's page has every key of a project, as the form declares it."""

from pathlib import Path

from docs.tables.project_fields import BEGIN, END, table

PAGE = Path(__file__).parents[2] / "docs" / "designer.md"


def test_the_table_of_the_page_is_made_from_the_form():
    text = PAGE.read_text(encoding="utf-8")
    shown = text.partition(BEGIN)[2].partition(END)[0].strip()
    assert shown == table(), "python -m docs.tables.project_fields writes it anew"
