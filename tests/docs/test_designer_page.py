"""The pages of input files have every key, as the forms declare them."""

import pytest

from docs.tables.project_fields import BEGIN, END, FORMS, table


@pytest.mark.parametrize("page", FORMS, ids=lambda page: page.stem)
def test_the_table_of_the_page_is_made_from_the_form(page):
    text = page.read_text(encoding="utf-8")
    shown = text.partition(BEGIN)[2].partition(END)[0].strip()
    assert shown == table(page), "python -m docs.tables.project_fields writes it anew"
