"""The screen of a command: notes, progress and problems on stderr, results on stdout."""

import json
import logging
import os
import sys
import time
import unicodedata
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import typer
from rich import table as rich_table
from rich.cells import cell_len
from rich.console import Console
from rich.markup import escape
from rich.padding import Padding
from rich.text import Text

from rockshed.components.common.cache import cache_problem

from ..core.ending import asked_to_end, interrupt, lost_requests_repeated, true_cause
from ..core.errors import ComponentLost, InputRefused, Problem
from ..tables import Table
from .words import in_options

if TYPE_CHECKING:
    from ..runs.inspection import Overview

OK, RUN_FAILED, REFUSED, CHECK_FAILED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes. Refused: usage or input, nothing was run."""

WIDTH_ELSEWHERE = 160
"""Characters in a line where the results do not go to a terminal."""

COLD_START = "compiling kernels, first run only (a minute or two)"


_SURE_AFTER = 2.0
"""Seconds after which the speed of a run says how long it will take."""
_TOLD_AFTER = 5.0
"""Seconds after which progress is told where there is no bar.

It is told again whenever the time that has gone has doubled.
"""


class Estimate:
    """An estimate of how long a run will still take, from its own speed until now.

    Parameters
    ----------
    clock : callable
        Returns the time (s).
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._began: tuple[float, float] | None = None

    def gone(self, reached: float) -> float:
        """Return the wall time since the first call.

        Parameters
        ----------
        reached : float
            Simulated time reached (s); that of the first call is where the estimate begins.

        Returns
        -------
        float
            Wall time (s).
        """
        now = self._clock()
        self._began = self._began or (now, reached)
        return now - self._began[0]

    def left(self, reached: float, stop: float) -> str:
        """Return the wall time that is left, in words.

        Parameters
        ----------
        reached, stop : float
            Simulated time reached, and at the end (s).

        Returns
        -------
        str
            Empty as long as nothing can be said.
        """
        gone = self.gone(reached)
        done = reached - self._began[1] if self._began else 0.0
        return (
            f"about {spoken(gone * (stop - reached) / done)} left"
            if gone >= _SURE_AFTER and done > 0.0
            else ""
        )


_SPANS = (
    ("s", 1.0, 90.0),
    ("min", 60.0, 5.4e3),
    ("h", 3.6e3, 1.8e5),
    ("days", 8.64e4, 6e7),
    ("years", 3.156e7, float("inf")),
)
"""Unit, its length (s), and where it ends to be used (s)."""


def spoken(seconds: float) -> str:
    """Return a span of time to two digits, in the unit in which one would say it.

    Parameters
    ----------
    seconds : float
        The span (s).

    Returns
    -------
    str
        Number and unit.
    """
    unit, size, _ = next(span for span in _SPANS if seconds < span[2])
    return f"{float(f'{seconds / size:.2g}'):,.10g} {unit}"


@dataclass(frozen=True)
class Bar:
    """A progress bar over simulated time, called with the time reached and the stop time (s).

    Attributes
    ----------
    describe : callable
        Called with the text before the bar.
    show : callable
        Called with the time reached and the stop time (s).
    """

    describe: Callable[[str], None]
    show: Callable[[float, float], None] = lambda reached, stop: None

    def __call__(self, reached: float, stop: float) -> None:
        """Show the time reached and the stop time (s)."""
        self.show(reached, stop)


@contextmanager
def opened(quiet: bool = False, as_json: bool = False) -> "Iterator[Screen]":
    """Open the screen of a command; refusals and failures become messages and exit codes.

    Parameters
    ----------
    quiet : bool
        No notes and no progress.
    as_json : bool
        Results on stdout are one JSON document.

    Yields
    ------
    Screen
        Of the command.

    Raises
    ------
    typer.Exit
        With the exit code, where the command was refused, interrupted or could not write.
    """
    screen = Screen(quiet, as_json)
    try:
        with (
            asked_to_end(interrupt),
            lost_requests_repeated(),
            true_cause(typer.Exit, InputRefused, OSError, MemoryError),
            without_warnings_of_libraries(),
        ):
            yield screen
    except ComponentLost as lost:
        for problem in lost.problems:
            screen.fail(str(problem))
        screen.say("nothing was computed")
        raise typer.Exit(RUN_FAILED) from None
    except InputRefused as refusal:
        screen.refuse(refusal.problems)
        raise typer.Exit(REFUSED) from None
    except KeyboardInterrupt:
        screen.warn("interrupted")
        raise typer.Exit(INTERRUPTED) from None
    except OSError as error:
        screen.fail(str(error))
        raise typer.Exit(RUN_FAILED) from error
    except MemoryError as error:
        screen.fail("there is not enough memory for it")
        raise typer.Exit(RUN_FAILED) from error


@contextmanager
def without_warnings_of_libraries() -> Iterator[None]:
    """Keep from the screen what libraries say to programmers, unless Python was asked for it."""
    loud = [logging.getLogger(name) for name in ("matplotlib", "ezdxf", "rockshed")]
    before = [logger.level for logger in loud]
    with warnings.catch_warnings():
        if not sys.warnoptions:
            for logger in loud:
                logger.setLevel(logging.CRITICAL)
            for category in (UserWarning, RuntimeWarning, FutureWarning):
                warnings.simplefilter("ignore", category)
        try:
            yield
        finally:
            for logger, level in zip(loud, before, strict=True):
                logger.setLevel(level)


class Screen:
    """The two streams of a command.

    Parameters
    ----------
    quiet : bool
        No notes and no progress.
    as_json : bool
        Results on stdout are one JSON document.
    """

    def __init__(self, quiet: bool = False, as_json: bool = False) -> None:
        self.quiet, self.as_json = quiet, as_json
        self._knows_cache = False
        self.out = Console(highlight=False, emoji=False)
        if not self.out.is_terminal and "COLUMNS" not in os.environ:
            self.out.width = WIDTH_ELSEWHERE
        self.err = Console(stderr=True, highlight=False, emoji=False)

    # ------------------------------------------------------------------ stderr

    def note(self, text: str) -> None:
        """Say what is being done, unless the command is quiet."""
        if not self.quiet:
            self.err.print(escape(_worded(text)), style="dim", soft_wrap=True)

    def warn(self, text: str) -> None:
        """Say something that the user should know although it went on."""
        self._marked("yellow", "warning:", text)

    def _tell_of_cache(self) -> None:
        """Say once that no compiled code is kept, and why, before something is computed."""
        problem = "" if self._knows_cache else cache_problem()
        self._knows_cache = True
        if problem:
            self.warn(f"kernels are compiled at every start, a minute or two: {problem}")

    def fail(self, text: str) -> None:
        """Say why the command did not go on."""
        self._marked("bold red", "failed:", text)

    def _marked(self, style: str, word: str, text: str) -> None:
        self.err.print(Text.assemble((word, style), " ", _worded(text)), soft_wrap=True)

    def refuse(self, problems: Sequence[Problem]) -> None:
        """Say what has to be changed before the command can be tried again."""
        problems = [
            replace(each, what=in_options(each.what), remedy=in_options(each.remedy))
            for each in problems
        ]
        if self.as_json:
            self.dump({"status": "refused", "problems": [asdict(problem) for problem in problems]})
        count = "" if len(problems) == 1 else f"{len(problems)} problems"
        self.err.print(f"[bold red]refused:[/] {count}" if count else "[bold red]refused:[/]")
        for problem in problems:
            where = printable(problem.where, ends="")
            told = Text.assemble((where, "bold"), ": ", printable(problem.what))
            self.err.print(Padding(told, (0, 0, 0, 2)))
            if problem.remedy:
                hint = Text.assemble(("→", "dim"), " ", printable(problem.remedy))
                self.err.print(Padding(hint, (0, 0, 0, 4)))

    @contextmanager
    def busy(self, text: str) -> Iterator[None]:
        """Show a spinner while something goes on that cannot tell how far it is."""
        self._tell_of_cache()
        if self.quiet or not self.err.is_terminal:
            self.note(f"{text} ...")
            yield
        else:
            with self.err.status(escape(text)):
                yield

    @contextmanager
    def progress(self, preparing: str) -> "Iterator[Bar]":
        """Show a bar over the simulated time.

        Parameters
        ----------
        preparing : str
            Text that stands there until the first exchange.

        Yields
        ------
        Bar
            Shows nothing where nobody looks.
        """
        self._tell_of_cache()
        estimate = Estimate()
        if self.quiet or not self.err.is_terminal:
            yield Bar(self.note, self._told(estimate))
            return
        from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

        with Progress(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[reached]}"),
            console=self.err,
            transient=True,
        ) as shown:
            task = shown.add_task(preparing, total=None, reached="")

            def describe(text: str) -> None:
                shown.update(task, description=text)

            def show(reached: float, stop: float) -> None:
                shown.update(
                    task,
                    description="running",
                    total=stop,
                    completed=reached,
                    reached=f"{_reached(reached, stop)} {estimate.left(reached, stop)}",
                )

            yield Bar(describe, show)

    def _told(self, estimate: Estimate) -> Callable[[float, float], None]:
        """Return a function that gives notes in the place of a bar, at ever longer intervals."""
        due = _TOLD_AFTER

        def show(reached: float, stop: float) -> None:
            nonlocal due
            if estimate.gone(reached) >= due:
                due = 2.0 * estimate.gone(reached)
                self.note(f"reached {_reached(reached, stop)}, {estimate.left(reached, stop)}")

        return show

    @contextmanager
    def counting(self, text: str) -> "Iterator[Callable[[int, int], None]]":
        """Show a bar over pieces of work; where there is no terminal, a note for each tenth.

        Parameters
        ----------
        text : str
            Name of the pieces.

        Yields
        ------
        callable
            Called with the number done and the number of all.
        """
        self._tell_of_cache()
        if self.quiet or not self.err.is_terminal:
            tenths = 0

            def tell(done: int, total: int) -> None:
                nonlocal tenths
                if total and 10 * done // total > tenths:
                    tenths = 10 * done // total
                    self.note(f"{text}: {done} of {total}")

            yield tell
            return
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            SpinnerColumn,
            TextColumn,
            TimeRemainingColumn,
        )

        with Progress(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=self.err,
            transient=True,
        ) as shown:
            task = shown.add_task(text, total=None)
            yield lambda done, total: shown.update(task, total=total, completed=done)

    # ------------------------------------------------------------------ stdout

    def show(self, *parts: str | Table) -> None:
        """Print texts and tables for a person."""
        for part in parts:
            if isinstance(part, Table):
                self.table(part)
            else:
                self.out.print(Text(printable(part)))

    def overview(self, overview: "Overview") -> None:
        """Print texts and tables with an empty line between two."""
        for number, part in enumerate(overview.parts):
            self.show(*([""] if number else []), part)

    def table(self, table: Table) -> None:
        """Print a table under its title; the title alone where the table has no rows."""
        if table.title:
            title = Text(printable(table.title, ends=""), style="bold")
            self.out.print(title, soft_wrap=True)
        if not len(table):
            return
        cells = [[printable(cell, ends="") for cell in row] for row in table.rows]
        widths = column_widths(table, cells, self.out.width)
        if widths is None:
            self._turned(table, cells)
            return
        shown = plain_table(*table.columns, right=table.right, widths=widths)
        shown.show_header = any(table.columns)
        for row in cells:
            shown.add_row(*map(Text, row))
        self.out.print(shown, crop=False)

    def _turned(self, table: Table, cells: Sequence[Sequence[str]]) -> None:
        """Print a table that is wider than the screen row by row: a line for each cell."""
        for row in cells:
            self.out.print(Text(row[0], style="bold"), soft_wrap=True)
            for title, cell in zip(table.columns[1:], row[1:], strict=True):
                if cell:
                    words = " ".join(filter(None, (printable(title, ends=""), cell)))
                    self.out.print(Text(f"  {words}"), soft_wrap=True)

    def say(self, text: str) -> None:
        """Print a line, however long it is."""
        self.out.print(Text(_worded(text)), soft_wrap=True)

    def dump(self, content: Any) -> None:
        """Print results for a program, in letters that every encoding has."""
        self.out.file.write(json.dumps(content, indent=2) + "\n")


def _worded(text: str) -> str:
    """Return a text of the library in the words of the command line, ready to be shown."""
    return printable(in_options(text))


def _reached(reached: float, stop: float) -> str:
    return f"{1e3 * reached:.1f} of {1e3 * stop:g} ms"


def printable(text: str, ends: str = "\n") -> str:
    """Write control characters, which would move the cursor of a terminal, as escapes.

    Parameters
    ----------
    text : str
        Any text.
    ends : str
        Control characters that stay.

    Returns
    -------
    str
        With escapes in the place of the others, as Python writes them.
    """
    return "".join(
        letter
        if letter in ends or unicodedata.category(letter) not in ("Cc", "Cs")
        else _escaped(letter)
        for letter in text
    )


def _escaped(letter: str) -> str:
    return repr(letter)[1:-1]


GAP = 2
"""Blanks between two columns."""


def column_widths(table: Table, cells: Sequence[Sequence[str]], width: int) -> list[int] | None:
    """Return the widths of the columns of a table on a screen, so that every letter is seen.

    Parameters
    ----------
    table : Table
        With the titles.
    cells : sequence of sequences of str
        Of its rows.
    width : int
        Letters in a line of the screen.

    Returns
    -------
    list of int or None
        Columns of words are broken into lines between words where that is needed, the first, which
        has the names, only where that of all others is not enough; None if the table does not fit
        all the same.
    """
    columns = [
        [printable(title, ends=""), *column]
        for title, column in zip(table.columns, zip(*cells, strict=True), strict=True)
    ]
    widths = [max(map(cell_len, column)) for column in columns]
    least = [
        wide if title in table.right else max(map(_longest_word, column))
        for title, column, wide in zip(table.columns, columns, widths, strict=True)
    ]
    room = width - GAP * (len(widths) - 1)
    return _narrowed(widths, [widths[0], *least[1:]], room) or _narrowed(widths, least, room)


def _narrowed(widths: Sequence[int], least: Sequence[int], room: int) -> list[int] | None:
    """Return widths that fit into a line, the widest made narrower first; None where none do."""
    widths = list(widths)
    excess = sum(widths) - room
    while excess > 0:
        spare = [wide - few for wide, few in zip(widths, least, strict=True)]
        widest = spare.index(max(spare))
        if spare[widest] <= 0:
            return None
        widths[widest] -= 1
        excess -= 1
    return widths


def _longest_word(text: str) -> int:
    return max(map(cell_len, text.split()), default=0)


def plain_table(
    *columns: str, right: Sequence[str] = (), widths: Sequence[int] = ()
) -> rich_table.Table:
    """Return an empty table in the style of all commands.

    Parameters
    ----------
    *columns : str
        Titles.
    right : sequence of str
        Titles of columns of numbers, which are not broken into lines.
    widths : sequence of int
        Of the columns; without them, as wide as their cells.

    Returns
    -------
    rich.table.Table
        Without rows.
    """
    table = rich_table.Table(box=None, pad_edge=False, header_style="bold", padding=(0, GAP, 0, 0))
    for number, name in enumerate(columns):
        table.add_column(
            Text(printable(name, ends="")),
            justify="right" if name in right else "left",
            no_wrap=name in right,
            overflow="fold",
            width=widths[number] if widths else None,
        )
    return table
