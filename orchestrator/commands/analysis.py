"""Parts of the commands of all analyses: progress, names of options, display of a result."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import Any

from ..analyses.frame import Result, StageProgress
from ..core.errors import InputRefused
from .screen import Screen


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
def options_named(options: Sequence[str]) -> Iterator[None]:
    """Name the arguments of a function in its refusals as the options of a command.

    Parameters
    ----------
    options : sequence of str
        Arguments that are options: a problem of ``scheduler x`` is shown as ``--scheduler x``.

    Raises
    ------
    InputRefused
        The same problems.
    """
    try:
        yield
    except InputRefused as refusal:
        raise InputRefused(
            [
                replace(problem, where=f"--{problem.where}")
                if problem.where.split(" ")[0] in options
                else problem
                for problem in refusal.problems
            ]
        ) from None


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
        "figures": [metric.as_entry() for metric in result.metric_list()],
        "pictures": [str(file) for file in result.pictures],
    }
