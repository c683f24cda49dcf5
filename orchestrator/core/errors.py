"""Errors of a co-simulation, made for the person who has to act on them."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from shlex import quote
from typing import Any

_PLACE = re.compile(r", line (\d+)(?:, column (\d+))?(?=:|$)")
"""Line and column in the place of a problem."""


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong.

    Attributes
    ----------
    where : str
        ``component.port``, or the path of a key in a file.
    what : str
        Reason.
    remedy : str
        Something to do about it; empty where none is known.
    """

    where: str
    what: str
    remedy: str = ""

    def __str__(self) -> str:
        return f"{self.where}: {self.what}" + (f"; {self.remedy}" if self.remedy else "")


def in_order(problems: Iterable[Problem]) -> list[Problem]:
    """Return problems, each once, in the order of each file."""
    each = list(dict.fromkeys(problems))
    files = list(dict.fromkeys(_place(problem)[0] for problem in each))
    each.sort(key=lambda problem: (files.index(_place(problem)[0]), _place(problem)))
    return each


def _place(problem: Problem) -> tuple[str, int, int]:
    """Return file, line and column of a problem; 0 where it has none."""
    found = _PLACE.search(problem.where)
    if found is None:
        return problem.where, 0, 0
    return problem.where[: found.start()], int(found.group(1)), int(found.group(2) or 0)


def check_of(fmu: str) -> str:
    """Return what finds out why the code of an FMU crashes; empty where it is in no file.

    Parameters
    ----------
    fmu : str
        Its path.
    """
    is_file = "\0" not in fmu and Path(fmu).is_file()
    return f"`rockshed check {quote(fmu)}` looks for the reason" if is_file else ""


def counted(number: int, noun: str) -> str:
    """Return a number with its noun: ``1 output``, ``2 outputs``."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


class InputRefused(Exception):  # noqa: N818 (it says what happened, not that it is an error)
    """A request cannot be carried out; nothing has been computed.

    Attributes
    ----------
    problems : list of Problem
        Every reason.
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = list(problems)
        count = f"{len(self.problems)} problems:\n" if len(self.problems) > 1 else ""
        super().__init__(count + "\n".join(map(str, self.problems)))


class ComponentLost(InputRefused):
    """The code of a component crashed or hung while it was made ready; nothing has been computed.

    Only a component in a process of its own can be lost without this one.
    """


class RunFailed(Exception):  # noqa: N818
    """A run began and could not go on. What was computed until then is kept.

    Attributes
    ----------
    component : str
        The component that failed.
    time : float
        Simulated time of the failure (s).
    run : Any
        Results until then, where the caller of :func:`rockshed.simulate` gets the error.
    """

    run: Any = None

    def __init__(self, component: str, time: float, what: str) -> None:
        self.component = component
        self.time = time
        super().__init__(f"{component} at t = {time:.9g} s: {what}")


class RunDoubted(Exception):  # noqa: N818
    """A complete run has warnings, and none was allowed (``strict``). Its results are kept.

    Attributes
    ----------
    run : Any
        With all results.
    """

    def __init__(self, run: Any) -> None:
        self.run = run
        super().__init__(
            f"the run has {counted(len(run.warnings), 'warning')}, and none is allowed (strict):\n"
            + "\n".join(run.warnings)
        )


class AnalysisFailed(Exception):  # noqa: N818
    """An analysis of many runs or trials began and could not go on."""


class UnknownName(KeyError):  # noqa: N818
    """There is nothing of this name. The message names those that come nearest."""

    def __str__(self) -> str:
        return str(self.args[0])


@contextmanager
def all_causes(*looks: Callable[[], object] | None) -> Iterator[None]:
    """Tell with a refusal what else is wrong: every input is looked at alone.

    Parameters
    ----------
    *looks : callable or None
        Each looks at one input, and raises InputRefused where something is wrong with it. They are
        called where the block refuses something, and what the block has told is told once.

    Raises
    ------
    InputRefused
        That of the block, with the problems of all looks behind its own.
    """
    try:
        yield
    except InputRefused as refusal:
        told = list(refusal.problems)
        for look in filter(None, looks):
            try:
                look()
            except InputRefused as another:
                known = {(problem.where, problem.what) for problem in told}
                told += [p for p in another.problems if (p.where, p.what) not in known]
        if len(told) == len(refusal.problems):
            raise
        raise type(refusal)(told) from None


@contextmanager
def refusing_unwritable(place: Path, remedy: str = "name another folder") -> Iterator[None]:
    """Turn an error of the file system into a refusal of the folder or file that is written.

    Parameters
    ----------
    place : Path
        Folder or file.
    remedy : str
        For the person who has to act.

    Raises
    ------
    InputRefused
        The block has raised an OSError.
    """
    try:
        yield
    except OSError as error:
        what = f"cannot be written: {error.strerror or error}"
        raise InputRefused([Problem(str(place), what, remedy)]) from error
