"""Numbers and tables as text of a page."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

Row = Mapping[str, Any]


def number(value: float | None, decimals: int = 0) -> str:
    """Return a number; a dash where there is none, and no minus before a zero."""
    if value is None:
        return "-"
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def spread(row: Row, decimals: int = 0) -> str:
    """Return computed value ± standard deviation over the seeds."""
    made = number(row["computed"], decimals)
    return made if row["spread"] is None else f"{made} ± {number(row['spread'], decimals)}"


def deviation(row: Row, reference: str) -> str:
    """Return the deviation of the computed value from ``paper`` or ``experiment``, signed."""
    if row["computed"] is None or not row[reference]:
        return "-"
    return f"{100.0 * (row['computed'] / row[reference] - 1.0):+.0f} %"


def beside(row: Row, reference: str, decimals: int = 0, spreads: bool = True) -> str:
    """Return a value with its spread, and in brackets its deviation from a reference."""
    made = spread(row, decimals) if spreads else number(row["computed"], decimals)
    return f"{made} ({deviation(row, reference)})"


def listed(rows: Iterable[Row], decimals: int = 0) -> str:
    """Return values one after the other, with slashes."""
    return " / ".join(number(row["computed"], decimals) for row in rows)


def spreads(rows: Iterable[Row], decimals: int = 0) -> str:
    """Return standard deviations one after the other, with slashes."""
    return " / ".join(number(row["spread"], decimals) for row in rows)


def table(headings: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    rule = "|".join("---" for _ in headings)
    body = [f"| {' | '.join(line)} |".replace("  |", " |") for line in (headings, *lines)]
    return "\n".join([body[0], f"|{rule}|", *body[1:]])
