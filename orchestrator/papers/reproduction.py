"""A reproduction: the studies of a paper, their runs, and the files that tell of them."""

import shutil
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import partial
from importlib import import_module
from itertools import chain, count
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

from ..analyses.asked import remembering
from ..core.errors import InputRefused, Problem, all_causes, refusing_unwritable
from ..core.results.own_files import is_foreign_picture, refuse_foreign
from ..core.system.names import nearest
from ..files import whole_file, write_file, write_json
from ..runs.batch import INTERRUPTED, Counted, run_all, uncounted
from ..runs.building import Note, silent
from ..runs.executors import number_of_workers
from ..runs.kept import FINISHED, KeptRuns
from ..tables import Table
from ..temporary import TemporaryFolder
from ..versions import versions
from .kernel_stamps import stamps
from .page import page
from .report import Part, as_data, table
from .study import Outcomes, Study

PAPERS = {
    "sonoda1993": "Sonoda, Satoh, Ishikawa, Ohta 1993",
    "mogami1973": "Mogami, Tamura 1973, settlement of sandy ground under an impulsive load",
    "uto1974": "Uto, Fuyuki, Kondo, Yamada, about 1974",
    "ushiro": "Ushiro, A study on computer simulation of rockfalls (DRSP)",
}
"""Papers that have studies: package of this name."""
DATA, PAGE, FIGURES = "reproduction.json", "reproduction.html", "figures"
KIND = "reproduction"
"""Kind of the analysis, where it is kept what it was asked."""
_REMEDY = "name another folder: folder=..."
_PACKAGES = ("numpy", "numba", "fmpy", "pythonfmu")


@dataclass(frozen=True)
class Reproduction:
    """A paper's studies, carried out.

    Attributes
    ----------
    parts : sequence of Part
        Studies with rows and figures.
    content : dict
        Content of ``reproduction.json``.
    files : sequence of Path
        ``reproduction.json`` and ``reproduction.html``.
    """

    parts: Sequence[Part]
    content: dict[str, Any]
    files: Sequence[Path] = field(default_factory=list)

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C has ended it before all runs were carried out."""
        return any(run["status"] == INTERRUPTED for run in self.content["runs"])

    def tables(self) -> list[Table]:
        """Return a table for each study, without the details."""
        return [table(part) for part in self.parts]


def studies(paper: str) -> list[Study]:
    """Return the studies of a paper, in its order.

    Parameters
    ----------
    paper : str
        Key of :data:`PAPERS`.

    Returns
    -------
    list of Study
        ``STUDY`` of every module in the folder of the paper that has one.

    Raises
    ------
    InputRefused
        There is no such paper.
    """
    if paper not in PAPERS:
        problem = Problem(paper, "there are no studies of such a paper", nearest(paper, PAPERS))
        raise InputRefused([problem])
    package = import_module(f".{paper}", __package__)
    modules = [
        import_module(f".{entry.name}", package.__name__)
        for entry in iter_modules(package.__path__)
    ]
    known = (module.STUDY for module in modules if hasattr(module, "STUDY"))
    return sorted(known, key=lambda study: study.place)


def chosen(paper: str, only: Sequence[str]) -> list[Study]:
    """Return the studies of these names, or all.

    Parameters
    ----------
    paper : str
        Key of :data:`PAPERS`.
    only : sequence of str
        Names of studies; none for all.

    Returns
    -------
    list of Study
        In the order of the paper.

    Raises
    ------
    InputRefused
        Unknown paper, or unknown names, all of them.
    """
    known = studies(paper)
    names = [study.name for study in known]
    problems = [
        Problem(f"only {name}", "there is no such study", nearest(name, names))
        for name in only
        if name not in names
    ]
    if problems:
        raise InputRefused(problems)
    return [study for study in known if not only or study.name in only]


def reproduce(
    paper: str,
    folder: Path,
    only: Sequence[str] = (),
    quick: bool = False,
    workers: int | None = None,
    note: Note = silent,
    counted: Counted = uncounted,
) -> Reproduction:
    """Carry out studies; write ``reproduction.json``, ``reproduction.html`` and figures.

    Parameters
    ----------
    paper : str
        Key of :data:`PAPERS`.
    folder : Path
        Folder of the results; made where it is missing.
    only : sequence of str
        Names of studies; none for all.
    quick : bool
        One run where the full reproduction has a run for each seed.
    workers : int, optional
        Number of processes, by default that of the cores.
    note : callable
        Called with a line for each FMU that is built.
    counted : callable
        Called with the number of runs that have ended, and of all.

    Returns
    -------
    Reproduction
        Rows, figures and files.

    Raises
    ------
    InputRefused
        Unknown paper or study, or a folder that cannot be written; nothing has been run.
    """
    with all_causes(partial(_refuse_place, folder)):
        selected = chosen(paper, only)
    _refuse_place(folder)
    with refusing_unwritable(folder / FIGURES, _REMEDY):
        (folder / FIGURES).mkdir(parents=True, exist_ok=True)
    arguments = {"paper": paper, "only": list(only), "quick": quick, "workers": workers}
    made = None
    with suppress(_InterruptedError), remembering(folder / FINISHED, KIND, arguments):
        made = _carried_out(paper, selected, folder, (quick, workers), note, counted)
        if made.interrupted:  # what it was asked is kept
            raise _InterruptedError
    assert made is not None
    return made


class _InterruptedError(Exception):
    """A reproduction was interrupted, and has results of what had ended."""


def _carried_out(
    paper: str,
    selected: Sequence[Study],
    folder: Path,
    how: tuple[bool, int | None],
    note: Note,
    counted: Counted,
) -> Reproduction:
    """Carry out studies, one run or all seeds, with a number of processes; write the files."""
    quick, workers = how
    began = time.perf_counter()
    started = datetime.now(UTC).isoformat(timespec="seconds")
    tasks = [task for study in selected for task in study.tasks(quick)]
    stamped = stamps(selected)
    kept = KeptRuns(folder / FINISHED)
    outcomes = Outcomes(run_all(tasks, workers, note, counted, kept), quick)
    with TemporaryFolder() as drawn:
        parts = [
            _part(study, outcomes, stamped[study.name], drawn, folder / FIGURES)
            for study in selected
        ]
    facts = {
        "paper": PAPERS[paper],
        "started": started,
        "quick": quick,
        "workers": number_of_workers(workers),
        "wall_time": time.perf_counter() - began,
        "versions": versions(*_PACKAGES),
    }
    content = as_data(parts, tasks, list(outcomes.by_key.values()), folder, facts)
    write_json(folder / DATA, content)
    write_file(folder / PAGE, page(parts, content))
    made = Reproduction(parts, content, [folder / DATA, folder / PAGE])
    if not made.interrupted:
        kept.clear()
    return made


def _refuse_place(folder: Path) -> None:
    """Refuse a folder that is a file, or holds files of the user that would be overwritten."""
    if folder.is_file():
        raise InputRefused([Problem(str(folder), "is a file", _REMEDY)])
    refuse_foreign(folder, (DATA, PAGE), _REMEDY)


def _part(
    study: Study, outcomes: Outcomes, stamped: Mapping[str, str], drawn: Path, figures: Path
) -> Part:
    """Return the rows of a study, and its figures, which are drawn elsewhere first."""
    rows = study.rows(outcomes)
    files = study.draw(outcomes, rows, drawn)
    return Part(study, rows, [_put(file, figures / file.name) for file in files], stamped)


def _put(file: Path, target: Path) -> Path:
    """Move a figure to its place, or beside a file of the user that is there."""
    names = (target.with_name(f"{target.stem}-{n}{target.suffix}") for n in count(2))
    place = next(path for path in chain([target], names) if not is_foreign_picture(path))
    with whole_file(place) as temporary:
        shutil.copyfile(file, temporary)
    return place
