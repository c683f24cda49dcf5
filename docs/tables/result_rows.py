"""The table of a run's rows, made from their meanings: ``python -m docs.tables.result_rows``.

Writes it into docs/report.md, between the marks.
"""

from pathlib import Path

from rockshed.metrics.comparison import every_meaning

PAGE = Path(__file__).parents[1] / "report.md"
BEGIN, END = "<!-- rows of a run -->", "<!-- end of the rows -->"
"""Marks around the table on the page."""


def table() -> str:
    """Return the table in Markdown: row and meaning."""
    rows = [f"| {label} | {words} |" for label, words in every_meaning().items()]
    return "\n".join(["| row | meaning |", "|---|---|", *rows])


def written() -> str:
    """Return the page with the table written anew."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    return f"{before}{BEGIN}\n{table()}\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    PAGE.write_text(written(), encoding="utf-8")
