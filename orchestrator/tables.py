"""Tables as data: what an analysis has to show, whoever shows it.

The command line draws a table with lines, a notebook as HTML, and a script reads its rows.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from html import escape


@dataclass
class Table:
    """Rows of text under named columns.

    Parameters
    ----------
    columns : sequence of str
        Titles of the columns.
    rows : list of sequences of str
        Cells, one for each column.
    right : collection of str
        Titles of the columns whose cells end flush right, as numbers do.
    title : str
        Shown above the table.
    notes : list of str
        Lines shown below the table.
    """

    columns: Sequence[str]
    rows: list[Sequence[str]] = field(default_factory=list)
    right: Sequence[str] = ()
    title: str = ""
    notes: list[str] = field(default_factory=list)

    def add(self, *cells: str) -> None:
        """Append a row.

        Raises
        ------
        ValueError
            There are not as many cells as columns.
        """
        if len(cells) != len(self.columns):
            raise ValueError(f"{len(cells)} cells for the columns {', '.join(self.columns)}")
        self.rows.append(cells)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[dict[str, str]]:
        for row in self.rows:
            yield dict(zip(self.columns, row, strict=True))

    def __repr__(self) -> str:
        lines = [self.columns, *self.rows]
        widths = [max(len(line[place]) for line in lines) for place in range(len(self.columns))]
        texts = ["  ".join(self._padded(line, widths)).rstrip() for line in lines]
        return "\n".join([*filter(None, [self.title]), *texts, *self.notes])

    def _padded(self, line: Sequence[str], widths: Sequence[int]) -> Iterator[str]:
        for title, cell, width in zip(self.columns, line, widths, strict=True):
            yield cell.rjust(width) if title in self.right else cell.ljust(width)

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{escape(title)}</th>" for title in self.columns)
        body = "".join("<tr>" + "".join(self._html_cells(row)) + "</tr>" for row in self.rows)
        caption = f"<caption>{escape(self.title)}</caption>" if self.title else ""
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        table = f"{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
        return f"<table>{table}</table>{notes}"

    def _html_cells(self, row: Sequence[str]) -> Iterator[str]:
        for title, cell in zip(self.columns, row, strict=True):
            side = "right" if title in self.right else "left"
            yield f'<td style="text-align:{side}">{escape(cell)}</td>'


def digits(value: float, number: int = 3) -> str:
    """Write a number with so many digits and without an exponent: ``1044``, not ``1.04e+03``.

    Parameters
    ----------
    value : float
        The number.
    number : int
        Digits; of a whole number with more of them, none is lost.

    Returns
    -------
    str
        With an exponent only below 1e-6 and from 1e12 on.
    """
    if value and not 1e-6 <= abs(value) < 1e12:
        return f"{value:.{number}g}"
    rounded = float(f"{value:.{number}g}") + 0.0  # no -0
    if abs(rounded) >= 10.0 ** (number - 1):
        return f"{value:.0f}"
    return f"{rounded:.{number + 6}f}".rstrip("0").rstrip(".")
