"""The page of the reports has the meaning of every row that a run's table may have."""

from docs.tables.result_rows import BEGIN, END, PAGE, table


def test_the_table_of_the_page_is_made_from_the_meanings():
    text = PAGE.read_text(encoding="utf-8")
    shown = text.partition(BEGIN)[2].partition(END)[0].strip()
    assert shown == table(), "python -m docs.tables.result_rows writes it anew"
