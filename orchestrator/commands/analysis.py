"""Parts of the commands of all analyses: progress, names of options, display of a result."""

from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import Any

import typer

from ..analyses.frame import Result, StageProgress
from ..core.ending import true_cause
from ..core.errors import AnalysisFailed, InputRefused
from .screen import INTERRUPTED, RUN_FAILED, Screen
from .words import option


@contextmanager
def kept_if_ended(screen: Screen, folder: Path) -> Iterator[None]:
    """End a command in words where its analysis fails, is interrupted or finds the disk full.

    Parameters
    ----------
    screen : Screen
        Of the command.
    folder : Path
        Of the results, from which it goes on.

    Raises
    ------
    typer.Exit
        With the exit code.
    """
    again = f"`rockshed resume {quote(str(folder))}` goes on from what has ended"
    try:
        with true_cause(AnalysisFailed, InputRefused, OSError, MemoryError):
            yield
    except AnalysisFailed as failure:
        screen.fail(str(failure))
        raise typer.Exit(RUN_FAILED) from None
    except OSError as error:  # a full disk, for instance
        screen.fail(f"{error}; {again}")
        raise typer.Exit(RUN_FAILED) from None
    except KeyboardInterrupt:
        screen.warn(f"interrupted; {again}")
        raise typer.Exit(INTERRUPTED) from None


@contextmanager
def stages(screen: Screen) -> Iterator[StageProgress]:
    """Show each stage of an analysis as a bar of its own.

    Parameters
    ----------
    screen : Screen
        Of the command.

    Yields
    ------
    StageProgress
        Called with stage, pieces done and pieces in all.
    """
    with ExitStack() as bar:
        shown: dict[str, Any] = {}

        def progress(stage: str, done: int, total: int) -> None:
            if stage not in shown:
                bar.close()
                shown.clear()
                shown[stage] = bar.enter_context(screen.counting(stage))
            if done:
                shown[stage](done, total)

        yield progress


@contextmanager
def options_named(
    arguments: Collection[str], target: str = "", given: Collection[str] | None = None
) -> Iterator[None]:
    """Name the arguments that a function refuses as the options of a command.

    Arguments in the texts of a refusal are written as options wherever they are shown.

    Parameters
    ----------
    arguments : collection of str
        Arguments that are options: ``scheduler x`` is shown as ``--scheduler x``.
    target : str
        What they change: ``lab-impact: stop_time`` is shown as ``--stop-time``.
    given : collection of str, optional
        Those of them that can be the place of a problem, by default all. What a file has under
        the same name is not the fault of an option that was not given.

    Raises
    ------
    InputRefused
        The same problems.
    """
    try:
        yield
    except InputRefused as refusal:
        places = arguments if given is None else given
        problems = [
            replace(problem, where=_place(problem.where, places, target))
            for problem in refusal.problems
        ]
        raise type(refusal)(problems) from None


def _place(where: str, arguments: Collection[str], target: str) -> str:
    name, blank, rest = where.removeprefix(f"{target}: ").partition(" ")
    table, dot, entry = name.partition(".")
    if dot and table in arguments:
        return f"{option(table)} {entry}{blank}{rest}"
    return f"{option(name)}{blank}{rest}" if name in arguments else where


def show(screen: Screen, result: Result) -> None:
    """Show warnings, tables and notes of a result, or its JSON.

    Parameters
    ----------
    screen : Screen
        Of the command.
    result : Result
        Which has been saved.
    """
    for text in result.warnings:
        screen.warn(text)
    if screen.as_json:
        screen.dump(as_json(result))
        return
    for table in result.tables():
        screen.say("")
        screen.table(table)
    screen.say("")
    for text in result.notes:
        screen.say(text)
    drawn = f", pictures in {result.pictures[0].parent}" if result.pictures else ""
    screen.say(f"results in {result.folder}{drawn}")


def as_json(result: Result) -> dict[str, Any]:
    """Return a saved result as one JSON document.

    Parameters
    ----------
    result : Result
        Which has been saved.

    Returns
    -------
    dict
        Status, folder, warnings, metrics and names of the pictures.
    """
    return {
        "status": result.status,
        "folder": str(result.folder),
        "warnings": result.warnings,
        "metrics": [metric.as_entry() for metric in result.metric_list()],
        "pictures": [str(file) for file in result.pictures],
    }
