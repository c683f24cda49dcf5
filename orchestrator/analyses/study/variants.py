"""Many variants of a run, from one settled state: a study of the system that was run."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ...core.errors import InputRefused, Problem
from ...core.results.reading import StoredRun
from ...core.system.fields import Value
from ...runs.building import Note, silent
from ...runs.continuing import request_of
from ...runs.run import read_run
from ..frame import StageProgress, no_progress
from .arguments import StudyArguments
from .designs import LISTED
from .factors import Listed
from .result import StudyResult
from .run import carry_out_study


def branches(
    run: StoredRun | str | Path,
    variants: Sequence[Mapping[str, Value]],
    *,
    workers: int | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
    note: Note = silent,
) -> StudyResult:
    """Run many variants of a run, each with values of its own from the start on.

    FMUs are instantiated once in each process, and what none of the values changes settles once:
    a bed of sand, for all variants of the rock. The numbers are those of :func:`rockshed.branch`
    and of a run with these values, to the bit; rows and states are not kept.

    Parameters
    ----------
    run : Run, str or Path
        The run of a case, a project or a system file, or its folder.
    variants : sequence of mapping of str to Value
        Values of each by ``component.variable``, or as ``with_values`` takes them; all have the
        same names.
    workers : int, optional
        Number of processes, by default one for each core.
    folder : path, optional
        Where the results are saved; variants that have ended are kept there until all have.
    pictures : bool
        Whether figures are drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    StudyResult
        A row for each variant, in their order.

    Raises
    ------
    InputRefused
        FMUs, kernels or versions are others than those of the run; values that do not fit.
    StudyFailed
        No variant has a result.

    Examples
    --------
    >>> import rockshed
    >>> run = rockshed.simulate(rockshed.case("lab-impact", stop_time=0.001))
    >>> found = rockshed.branches(run, [{"rock.velocity0.y": v} for v in (-4.0, -6.0)], workers=1)
    >>> found.to_arrow().column("rock.velocity0.y").to_pylist()
    [-4.0, -6.0]
    """
    parent = run if isinstance(run, StoredRun) else read_run(run)
    names = list(dict.fromkeys(name for values in variants for name in values))
    _refuse_gaps(variants, names)
    columns = {name: Listed(tuple(values[name] for values in variants)) for name in names}
    asked = StudyArguments(
        request_of(parent, names, note),
        columns,
        LISTED,
        workers=workers,
        pictures=pictures,
    )
    place = Path(folder) if folder else None
    return carry_out_study(asked, place, progress or no_progress, note)


def _refuse_gaps(variants: Sequence[Mapping[str, Value]], names: Sequence[str]) -> None:
    """Refuse variants that have no value of something that others have.

    Raises
    ------
    InputRefused
        One problem for each of them.
    """
    problems = [
        Problem(f"variant {number}", f"has no value of {name}", "give it to all variants")
        for number, values in enumerate(variants, 1)
        for name in names
        if name not in values
    ]
    if not names:
        problems.append(Problem("variants", "have no values", "give some by component.variable"))
    if problems:
        raise InputRefused(problems)
