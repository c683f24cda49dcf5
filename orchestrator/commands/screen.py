"""The screen of a command: notes, progress and problems on stderr, results on stdout."""

import json
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import typer
from rich import table as rich_table
from rich.console import Console
from rich.markup import escape
from rich.padding import Padding

from rockshed.components.common.cache import cache_problem

from ..core.errors import InputRefused, Problem
from ..tables import Table

if TYPE_CHECKING:
    from ..runs.inspection import Overview

OK, RUN_FAILED, REFUSED, CHECK_FAILED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes. Refused: usage or input, nothing was run."""

WIDTH_ELSEWHERE = 160
"""Characters in a line where the results do not go to a terminal."""

COLD_START = "compiling kernels, first run only (about a minute)"


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
        yield screen
    except InputRefused as refusal:
        screen.refuse(refusal.problems)
        raise typer.Exit(REFUSED) from None
    except KeyboardInterrupt:
        screen.fail("interrupted")
        raise typer.Exit(INTERRUPTED) from None
    except OSError as error:
        screen.fail(str(error))
        raise typer.Exit(RUN_FAILED) from error


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
        self.out = Console(highlight=False)
        if not self.out.is_terminal and "COLUMNS" not in os.environ:
            self.out.width = WIDTH_ELSEWHERE
        self.err = Console(stderr=True, highlight=False)

    # ------------------------------------------------------------------ stderr

    def note(self, text: str) -> None:
        """Say what is being done, unless the command is quiet."""
        if not self.quiet:
            self.err.print(escape(text), style="dim", soft_wrap=True)

    def warn(self, text: str) -> None:
        """Say something that the user should know although it went on."""
        self.err.print(f"[yellow]warning:[/] {escape(text)}", soft_wrap=True)

    def _tell_of_cache(self) -> None:
        """Say once that no compiled code is kept, and why, before something is computed."""
        problem = "" if self._knows_cache else cache_problem()
        self._knows_cache = True
        if problem:
            self.warn(f"kernels are compiled at every start, about a minute: {problem}")

    def fail(self, text: str) -> None:
        """Say why the command did not go on."""
        self.err.print(f"[bold red]failed:[/] {escape(text)}", soft_wrap=True)

    def refuse(self, problems: Sequence[Problem]) -> None:
        """Say what has to be changed before the command can be tried again."""
        if self.as_json:
            self.dump({"status": "refused", "problems": [asdict(problem) for problem in problems]})
        count = "" if len(problems) == 1 else f"{len(problems)} problems"
        self.err.print(f"[bold red]refused:[/] {count}" if count else "[bold red]refused:[/]")
        for problem in problems:
            self.err.print(
                Padding(f"[bold]{escape(problem.where)}[/]: {escape(problem.what)}", (0, 0, 0, 2))
            )
            if problem.remedy:
                self.err.print(Padding(f"[dim]→[/] {escape(problem.remedy)}", (0, 0, 0, 4)))

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
                if 10 * done // total > tenths:
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
                self.out.print(escape(part))

    def overview(self, overview: "Overview") -> None:
        """Print texts and tables with an empty line between two."""
        for number, part in enumerate(overview.parts):
            self.show(*([""] if number else []), part)

    def table(self, table: Table) -> None:
        """Print a table under its title; the title alone where the table has no rows."""
        if table.title:
            self.out.print(f"[bold]{escape(table.title)}[/]", soft_wrap=True)
        if len(table):
            shown = plain_table(*table.columns, right=table.right)
            shown.show_header = any(table.columns)
            for row in table.rows:
                shown.add_row(*map(escape, row))
            self.out.print(shown)

    def say(self, text: str) -> None:
        """Print a line as it stands, however long it is."""
        self.out.print(escape(text), soft_wrap=True)

    def dump(self, content: Any) -> None:
        """Print results for a program, in letters that every encoding has."""
        self.out.file.write(json.dumps(content, indent=2) + "\n")


def _reached(reached: float, stop: float) -> str:
    return f"{1e3 * reached:.1f} of {1e3 * stop:g} ms"


def plain_table(*columns: str, right: Sequence[str] = ()) -> rich_table.Table:
    """Return an empty table in the style of all commands.

    Parameters
    ----------
    *columns : str
        Titles.
    right : sequence of str
        Titles of columns of numbers, which are not broken into lines.

    Returns
    -------
    rich.table.Table
        Without rows.
    """
    table = rich_table.Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for name in columns:
        table.add_column(name, justify="right" if name in right else "left", no_wrap=name in right)
    return table
