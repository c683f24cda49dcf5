"""Carry out a convergence study of a shed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ...cases.shed import prepared
from ...core.errors import InputRefused, Problem
from ...core.system.fields import Value
from ...runs.batch import INTERRUPTED, run_all
from ...runs.building import Note, silent
from ...runs.kept import FINISHED, KeptRuns
from ...sites.shed.preparation import is_field
from ..asked import remembering
from ..frame import StageProgress, counter, no_progress
from .figures import common_cut_off, measured
from .meshes import DISC_FIELD, ELEMENT_FIELD, SEED_FIELD, meshes, tasks
from .result import ConvergenceResult

_SOUGHT = (DISC_FIELD, ELEMENT_FIELD, SEED_FIELD)
FINEST = 8.0
"""Fineness that is taken at most; runs take the cube of it longer."""


def converge(
    project: str | Path | Mapping[str, Any],
    *,
    packings: int = 5,
    finest: float = 2.0,
    values: Mapping[str, Value] | None = None,
    workers: int | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
    note: Note = silent,
) -> ConvergenceResult:
    """Compute a shed with coarser and finer sand discs and beam elements, and compare.

    Parameters
    ----------
    project : path or mapping
        Project file (TOML), or its content; its own sizes are those that are judged.
    packings : int
        Number of packings of the sand for each mesh, two at least.
    finest : float
        Size of the project's discs / that of the finest ones, sqrt(2) at least.
    values : mapping of str to Value, optional
        Fields of the project and values of components that differ.
    workers : int, optional
        Number of processes, by default one for each core.
    folder : path, optional
        Where the results are saved; other files stay there. Runs that have ended are kept there
        until all have: a study that was killed or interrupted goes on.
    pictures : bool
        Whether the figure is drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    ConvergenceResult
        Tables, metrics and figure.

    Raises
    ------
    InputRefused
        Everything that is wrong with the arguments or the project.

    Examples
    --------
    >>> import rockshed
    >>> try:
    ...     rockshed.converge("shed.toml", packings=1)
    ... except rockshed.InputRefused as refusal:
    ...     print(refusal)
    packings: 1 shows no scatter of the packings; give two at least
    """
    source = Path(project).absolute() if isinstance(project, str | Path) else project
    files = [source] if isinstance(source, Path) else []
    asked = {
        "project": source,
        "packings": packings,
        "finest": finest,
        "values": values,
        "workers": workers,
        "pictures": pictures,
    }
    place = Path(folder) if folder else None
    with remembering(place and place / FINISHED, ConvergenceResult.kind, asked, files):
        source = Path(project) if isinstance(project, str | Path) else project
        study = _MeshStudy(source, packings, finest, dict(values or {}), workers)
        return _carried_out(study, place, pictures, progress or no_progress, note)


class _MeshStudy(NamedTuple):
    """Meshes of a project to be compared, and the number of processes."""

    source: Path | Mapping[str, Any]
    packings: int
    finest: float
    values: dict[str, Value]
    workers: int | None


def _carried_out(
    study: _MeshStudy, folder: Path | None, pictures: bool, show: StageProgress, note: Note
) -> ConvergenceResult:
    """Carry out the runs of all meshes, and save what they give where a folder is given."""
    source, packings, finest, given, workers = study
    _check(packings, finest, given)
    fields = {name: value for name, value in given.items() if is_field(name)}
    shed = prepared(source, fields)
    found = meshes(source, fields, finest)
    runs = {mesh: tasks(source, given, mesh, shed.layout.seed, packings) for mesh in found}
    kept = KeptRuns(folder / FINISHED) if folder else None
    wanted = [task for listed in runs.values() for task in listed]
    outcomes = run_all(wanted, workers, note, counter(show, "runs"), kept)
    if any(outcome.status == INTERRUPTED for outcome in outcomes.values()):
        raise KeyboardInterrupt
    ended = {mesh: [outcomes[task.key] for task in runs[mesh]] for mesh in found}
    cut_off = common_cut_off(next(ended[mesh] for mesh in found if mesh.fineness == 1.0))
    figures = [measured(mesh, ended[mesh], cut_off) for mesh in found]
    file = str(source) if isinstance(source, Path) else ""
    result = ConvergenceResult(shed.name, figures, packings, file)
    if folder:
        result.save(folder, pictures=pictures, progress=show)
    if kept is not None:
        kept.clear()
    return result


def _check(packings: int, finest: float, values: Mapping[str, Value]) -> None:
    """Refuse arguments that make no study."""
    problems = [
        Problem(name, "is what the study changes", "leave it out, or set it in the project")
        for name in values
        if name in _SOUGHT
    ]
    if packings < 2:
        text = f"{packings} shows no scatter of the packings"
        problems.append(Problem("packings", text, "give two at least"))
    if not 2.0**0.5 - 1e-9 <= finest <= FINEST:
        text = f"{finest:g} is not in the range from 1.41 to {FINEST:g}"
        problems.append(Problem("finest", text, "2 halves the discs of the project"))
    if problems:
        raise InputRefused(problems)
