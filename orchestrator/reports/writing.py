"""Reports on results of any kind, written to files."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from ..analyses.frame import Result
from ..analyses.saved import saved_result
from ..core.errors import InputRefused, Problem, all_causes, refusing_unwritable
from ..core.loop.master import Progress
from ..core.results.own_files import add_files, own_files
from ..files import whole_file, write_file
from ..runs.building import Note, silent
from ..runs.run import Run, read_run
from .form import Document
from .of_result import report_of_result
from .of_run import report_of_run
from .page import GENERATOR, page
from .pdf import is_own, write_pdf
from .step_halving import StepHalving, is_cheap, kept, step_halving

NAME = "report"
"""Name of the files of a report in the folder of its result, without ending."""
_HEAD = 4096
"""Bytes in which a page says who has made it."""


def report(
    result: Run | Result | str | Path,
    file: str | Path | None = None,
    *,
    pdf: bool = False,
    check: bool | None = None,
    repeat: Callable[[dict[str, object]], str] | None = None,
    progress: Progress | None = None,
    note: Note = silent,
) -> list[Path]:
    """Write a report that a reviewer can check, as one HTML page that needs no network.

    Warnings, results with references, figures to move through, inputs, assumptions, a check by
    halved steps, versions, digests of the FMUs, and how to repeat it.

    Parameters
    ----------
    result : Run, Result, str or Path
        A run, finished or not; or the folder of a run, of a campaign of rockfall or of a pile.
    file : str or Path, optional
        The page, ``.html``, or a PDF alone, ``.pdf``. By default ``report.html`` in the folder of
        the result.
    pdf : bool
        Whether a PDF of the same name is written beside the page.
    check : bool, optional
        Whether the run is made once more with half of its steps. By default it is if it took less
        than 10 s; the check is kept with the run.
    repeat : callable, optional
        Gives the command that repeats a run from its request; by default lines of Python are shown.
    progress : Progress, optional
        Called with the time reached and the stop time (s) of the repeated run.
    note : callable, optional
        Called with a line for each thing that the report has to do without.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputRefused
        There is no result, the file cannot be written, or is not one of this program; or the check
        was asked for and cannot be made.

    Examples
    --------
    >>> import rockshed, tempfile
    >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
    >>> run = rockshed.simulate(system)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (page,) = rockshed.report(run, f"{folder}/impact.html", check=False)
    ...     page.name
    'impact.html'
    """
    with all_causes(lambda: file is None or _files(Path(), file, pdf)):
        found = _found(result)
        folder = _folder(found, result)
        files = _files(folder, file, pdf)
        for place in files:
            _refuse_foreign(folder, place)
    if isinstance(found, Run):
        halving, without = _check(found, check, progress, note)
        command = _command(found, repeat)
        made = report_of_run(found, halving, without, command)
    else:
        made = report_of_result(found, folder)
    for place in files:
        _write(made, place)
    with suppress(OSError):  # the folder of the result cannot be written, and need not be
        add_files(folder, files)
    return files


def _found(result: Run | Result | str | Path) -> Run | Result:
    if isinstance(result, Run | Result):
        return result
    return saved_result(Path(result)) or read_run(result)


def _folder(found: Run | Result, told: object) -> Path:
    """Return the folder of a result."""
    folder = found.folder
    if folder is None and isinstance(told, str | Path):
        folder = Path(told)
    if folder is None:
        remedy = "save the result, and give its folder"
        raise InputRefused([Problem("report", "the result lies in no folder", remedy)])
    return folder


def _files(folder: Path, file: str | Path | None, pdf: bool) -> list[Path]:
    """Return the files that are to be written."""
    first = folder / f"{NAME}.html" if file is None else Path(file)
    ending = first.suffix.lower()
    if ending not in (".html", ".htm", ".pdf"):
        what = f"{first.name} is neither a page nor a PDF"
        raise InputRefused([Problem("file", what, "let its name end in .html or .pdf")])
    if not first.parent.is_dir():
        raise InputRefused([Problem(str(first.parent), "is no folder", "make it, or name another")])
    if pdf and ending != ".pdf":
        return [first, first.with_suffix(".pdf")]
    return [first]


def _refuse_foreign(folder: Path, file: Path) -> None:
    """Refuse to write over a file that is no report."""
    if not file.exists() or (file.name in own_files(folder) and file.parent == folder):
        return
    with refusing_unwritable(file):
        content = file.read_bytes() if file.is_file() else b""
    if file.suffix.lower() == ".pdf":
        own = is_own(content)
    else:
        own = GENERATOR.encode() in content[:_HEAD]
    if not own:
        what = "is there, is no report of this program, and would be overwritten"
        raise InputRefused([Problem(str(file), what, "rename it or name another file")])


def _check(
    run: Run, wanted: bool | None, progress: Progress | None, note: Note
) -> tuple[StepHalving | None, str]:
    """Return the check by halved steps, or why there is none."""
    found = kept(run)
    if found is not None or wanted is False:
        return found, "It was left out."
    if run.status != "complete":
        return None, "The run is not complete, and was not made again with half of its steps."
    if wanted is None and not is_cheap(run):
        return None, (
            "The run took too long to be made again without being asked for: with check=True it is "
            "made once more with half of its steps."
        )
    try:
        return step_halving(run, progress, note), ""
    except InputRefused as refusal:
        if wanted:
            raise
        reason = "; ".join(problem.what for problem in refusal.problems)
        note(f"no check by halved steps: {reason}")
        return None, f"The run was not made again with half of its steps: {reason}."


def _command(run: Run, repeat: Callable[[dict[str, object]], str] | None) -> str:
    told = run.provenance.get("request")
    return repeat(dict(told)) if repeat and isinstance(told, dict) else ""


def _write(made: Document, file: Path) -> None:
    with refusing_unwritable(file, "name another file: file=..."):
        if file.suffix.lower() == ".pdf":
            with whole_file(file) as temporary:
                write_pdf(made, temporary)
        else:
            write_file(file, page(made))
