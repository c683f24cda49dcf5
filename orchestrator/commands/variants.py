"""Variants of a run, in a table: names in the first line, then a line for each."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from ..core.errors import InputRefused, Problem, counted
from ..core.input_text import shown
from ..input_files.csv_table import CsvField, CsvRow, CsvTable, read_csv

_OF_VARIANT = re.compile(r"in design (\d+)(?: \(.*?\))?(?:: |$)")
_OF_NAME = re.compile(r"vary (.+)")
"""Places of what is wrong with one variant, and with the values of one name, as a study tells."""
_QUANTITY = re.compile(r"([+-]?[\d.,]+(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)


@dataclass(frozen=True)
class Variants:
    """The variants of a table.

    Attributes
    ----------
    table : CsvTable
        The file.
    names : list of str
        Of the values, by column.
    """

    table: CsvTable
    names: list[str]

    @property
    def values(self) -> list[dict[str, str]]:
        """Values by name, of each variant."""
        return [dict(zip(self.names, self._texts(row), strict=True)) for row in self.table.rows[1:]]

    def _texts(self, row: CsvRow) -> list[str]:
        """Return the texts of a line; numbers with a decimal comma have a point."""
        return [self._with_point(field) for field in row.fields]

    def _with_point(self, field: CsvField) -> str:
        found = _QUANTITY.fullmatch(field.text)
        if found is None or "," not in found[1]:
            return field.text
        number = self.table.number(CsvField(found[1], field.column))
        return field.text if number is None else f"{number}{found[2]}"

    @contextmanager
    def placed(self) -> Iterator[None]:
        """Name file and line of values that are refused.

        Raises
        ------
        InputRefused
            That of the block.
        """
        try:
            yield
        except InputRefused as refusal:
            raise type(refusal)([self._placed(problem) for problem in refusal.problems]) from None

    def _placed(self, problem: Problem) -> Problem:
        if found := _OF_VARIANT.match(problem.where):
            place = self.table.place(self.table.rows[int(found[1])])
            rest = problem.where[found.end() :]
            return replace(problem, where=f"{place}: {rest}" if rest else place)
        found = _OF_NAME.fullmatch(problem.where)
        if found is None or found[1] not in self.names:
            return problem
        column = self.names.index(found[1])
        rows = [
            row for row in self.table.rows[1:] if shown(row.fields[column].text) in problem.what
        ]
        row = rows[0] if rows else self.table.rows[0]
        return replace(problem, where=f"{self.table.place(row, column)}: {found[1]}")


def read_variants(file: Path) -> Variants:
    """Read a table of variants.

    Parameters
    ----------
    file : Path
        A CSV file.

    Raises
    ------
    InputRefused
        It is no table, has no variant, a name twice, or lines with more or fewer fields than names.
    """
    table = read_csv(file)
    names = [field.text for field in table.rows[0].fields] if table.rows else []
    problems = [
        Problem(
            table.place(row),
            f"has {counted(len(row.fields), 'field')}, and the first line {len(names)}",
            "give each variant a value for each name",
        )
        for row in table.rows[1:]
        if len(row.fields) != len(names)
    ]
    problems += [
        Problem(table.place(table.rows[0]), f"has {shown(name)} twice", "keep one")
        for name in sorted({name for name in names if names.count(name) > 1})
    ]
    if len(table.rows) < 2:
        problems.append(Problem(str(file), "has no variant", "write a line for each"))
    if problems:
        raise InputRefused(problems)
    return Variants(table, names)
