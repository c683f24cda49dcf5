"""Formats in which a run can be exported, and where its files go."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from ...core.errors import InputRefused, Problem, refusing_unwritable
from ...core.results.own_files import add_files, own_files
from ...core.results.reading import StoredRun
from ...core.system.names import nearest
from ...files import whole_file
from .mat4 import write_mat4
from .table import write_csv
from .vtk import write_vtk

Writer = Callable[[StoredRun, Path], list[Path]]
"""Writes a run into a file or folder, and returns its files."""


def _one_file(write: Callable[[StoredRun, Path], None]) -> Writer:
    def written(run: StoredRun, file: Path) -> list[Path]:
        with whole_file(file) as temporary:
            write(run, temporary)
        return [file]

    return written


_WRITERS: Mapping[str, tuple[str, Writer]] = {
    "csv": (".csv", _one_file(write_csv)),
    "mat4": (".mat", _one_file(write_mat4)),
    "vtk": ("-vtk", write_vtk),
}
"""By format: what the name of the file or folder ends in, and what writes it."""
FORMATS = tuple(_WRITERS)


def refuse_format(form: str) -> None:
    """Refuse a format that is none of :data:`FORMATS`."""
    if form not in _WRITERS:
        raise InputRefused([Problem("format", f"{form!r} is unknown", nearest(form, FORMATS))])


def export_run(run: StoredRun, form: str, output: Path | None = None) -> list[Path]:
    """Write a run in a format of other programs.

    Parameters
    ----------
    run : StoredRun
        The run.
    form : str
        ``csv``: time series as fmpy reads them. ``mat4``: time series and parameters as Dymola and
        OpenModelica have them. ``vtk``: recorded states for ParaView.
    output : Path, optional
        File, of ``vtk`` a folder; by default in the folder ``export`` of the run. What is there
        already stays, but for an earlier export in the folder of the run.

    Returns
    -------
    list of Path
        The files; of ``vtk`` the collection, which names all others, first.

    Raises
    ------
    InputRefused
        The format is unknown, a library for it is missing, the run has nothing to write, something
        is there already, or it cannot be written.
    """
    refuse_format(form)
    if not run.time.size:
        reason = "the run was ended before its first row was written"
        raise InputRefused([Problem(str(run.folder), reason, "run it again")])
    ending, write = _WRITERS[form]
    place = output or run.folder / "export" / f"{run.folder.absolute().name}{ending}"
    _refuse_foreign(run, place)
    with refusing_unwritable(place, "name another place: output=..."):
        place.parent.mkdir(parents=True, exist_ok=True)
        files = write(run, place)
    add_files(run.folder, files)
    return files


def _refuse_foreign(run: StoredRun, place: Path) -> None:
    """Refuse a place where something is that is not of this run."""
    own = {os.path.normpath(run.folder.absolute() / name) for name in own_files(run.folder)}
    there = [place] if os.path.lexists(place) and not place.is_dir() else [*place.glob("**/*")]
    foreign = [
        path for path in there if not path.is_dir() and os.path.normpath(path.absolute()) not in own
    ]
    if foreign:
        remedy = "remove it or name another place: output=..."
        raise InputRefused([Problem(str(foreign[0]), "is there already and stays", remedy)])
