"""Parts of the commands of all analyses: progress, names of options, display of a result."""

from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import Any

from ..analyses.frame import Result, StageProgress
from ..core.errors import InputRefused, Problem
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
def options_named(options: Collection[str], target: str = "") -> Iterator[None]:
    """Name the arguments of a function in its refusals as the options of a command.

    Parameters
    ----------
    options : collection of str
        Arguments that are options: a problem of ``scheduler x`` is shown as ``--scheduler x``.
    target : str
        What they change: ``lab-impact: stop_time`` is shown as ``--stop-time``.

    Raises
    ------
    InputRefused
        The same problems.
    """
    try:
        yield
    except InputRefused as refusal:
        problems = [_of_option(problem, options, target) for problem in refusal.problems]
        raise InputRefused(problems) from None


def _of_option(problem: Problem, options: Collection[str], target: str) -> Problem:
    where = problem.where.removeprefix(f"{target}: ")
    name, blank, rest = where.partition(" ")
    if name not in options:
        return problem
    return replace(problem, where=f"--{name.replace('_', '-')}{blank}{rest}")


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
