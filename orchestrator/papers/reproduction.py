"""A reproduction: the studies of a paper, their runs, and the files that tell of them."""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.system.names import nearest
from ..files import write_file, write_json
from ..runs.batch import INTERRUPTED, Done, run_all
from ..runs.building import Note
from ..versions import versions
from .page import page
from .report import Part, as_data
from .study import Outcomes, Study

PAPERS = {
    "sonoda1993": "Sonoda, Satoh, Ishikawa, Ohta 1993",
    "mogami1973": "Mogami, Tamura 1973, settlement of sandy ground under an impulsive load",
    "uto1974": "Uto, Fuyuki, Kondo, Yamada, about 1974",
    "ushiro": "Ushiro, A study on computer simulation of rockfalls (DRSP)",
}
"""Papers that have studies: package of this name."""
DATA, PAGE, FIGURES = "reproduction.json", "reproduction.html", "figures"
_PACKAGES = ("numpy", "numba", "fmpy", "pythonfmu")


@dataclass(frozen=True)
class Reproduction:
    """What came of it. content: that of ``reproduction.json``."""

    parts: Sequence[Part]
    content: dict[str, Any]
    files: Sequence[Path] = field(default_factory=list)

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C has ended it before all runs were carried out."""
        return any(run["status"] == INTERRUPTED for run in self.content["runs"])


def studies(paper: str) -> list[Study]:
    """The studies of a paper, in its order.

    Raises:
        InputRefused: there is no such paper.
    """
    if paper not in PAPERS:
        raise InputRefused(
            [Problem(paper, "there are no studies of such a paper", nearest(paper, PAPERS))]
        )
    package = import_module(f".{paper}", __package__)
    modules = [
        import_module(f".{found.name}", package.__name__)
        for found in iter_modules(package.__path__)
    ]
    return sorted(
        (module.STUDY for module in modules if hasattr(module, "STUDY")),
        key=lambda study: study.place,
    )


def chosen(paper: str, only: Sequence[str]) -> list[Study]:
    """The studies asked for, or all.

    Raises:
        InputRefused: unknown names, all of them.
    """
    known = studies(paper)
    names = [study.name for study in known]
    problems = [
        Problem(f"--only {name}", "there is no such study", nearest(name, names))
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
    note: Note = lambda text: None,
    done: Done = lambda count, total: None,
    drawing: Callable[[], None] = lambda: None,
) -> Reproduction:
    """Carry out studies and write ``reproduction.json``, ``reproduction.html`` and figures into ``folder``.

    Raises:
        InputRefused: unknown paper or study, or a folder that cannot be written; nothing has been run.
    """
    selected = chosen(paper, only)
    _make(folder / FIGURES)
    began, started = time.perf_counter(), datetime.now(UTC).isoformat(timespec="seconds")
    tasks = [task for study in selected for task in study.tasks(quick)]
    outcomes = Outcomes(run_all(tasks, workers, note, done), quick)
    drawing()
    parts = [_part(study, outcomes, folder / FIGURES) for study in selected]
    facts = {
        "paper": PAPERS[paper],
        "started": started,
        "quick": quick,
        "workers": workers or os.cpu_count() or 1,
        "wall_time": time.perf_counter() - began,
        "versions": versions(*_PACKAGES),
    }
    content = as_data(parts, tasks, list(outcomes.by_key.values()), folder, **facts)
    write_json(folder / DATA, content)
    write_file(folder / PAGE, page(parts, content))
    return Reproduction(parts, content, [folder / DATA, folder / PAGE])


def _part(study: Study, outcomes: Outcomes, figures: Path) -> Part:
    rows = study.rows(outcomes)
    return Part(study, rows, study.draw(outcomes, rows, figures))


def _make(folder: Path) -> None:
    with refusing_unwritable(folder, "name another folder with --output-dir"):
        folder.mkdir(parents=True, exist_ok=True)
