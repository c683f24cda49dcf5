"""Many variants of a run, from one of its states: a study of the run from there on."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...core.continuing import system_of
from ...core.errors import InputRefused, Problem
from ...core.results.reading import StoredRun
from ...core.system.fields import Value
from ...runs.batch import BranchPoint
from ...runs.building import Note, silent
from ...runs.continuing import refuse_in_process, request_of
from ...runs.request import Request, plain
from ...runs.run import read_run
from ..frame import StageProgress, no_progress
from .arguments import StudyArguments, varied
from .designs import LISTED
from .factors import Listed, Varied
from .result import StudyResult
from .run import carry_out_study


def branches(
    run: StoredRun | str | Path,
    variants: Sequence[Mapping[str, Value]] | Mapping[str, Varied | Sequence[Value]],
    *,
    at: float | None = None,
    values: Mapping[str, Value] | None = None,
    design: str | None = None,
    samples: int | None = None,
    draw: int = 0,
    metrics: Sequence[str] = (),
    percentiles: Sequence[float] | None = None,
    workers: int | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
    note: Note = silent,
) -> StudyResult:
    """Run many variants of a run from one of its states, each with values of its own.

    FMUs are instantiated once in each process. From the start, what none of the values changes
    settles once: a bed of sand, for all variants of the rock. From a later time on, the run goes on
    to that time once in each process, and each variant begins with its state and rows then. The
    numbers are those of :func:`rockshed.branch` to the bit; rows and states are not kept.

    Parameters
    ----------
    run : Run, str or Path
        The run, or its folder; its components are FMUs. From the start it is that of a case, a
        project or a system file, from a later time on one that had ``checkpoint_every``.
    variants : sequence of mapping, or mapping
        Values of each variant by ``component.variable``, from the start also as ``with_values``
        takes them; all have the same names. Or how the values vary, by name, as
        :func:`rockshed.study` takes it.
    at : float, optional
        Time (s) from which on the values hold; by default the start of the run.
    values : mapping of str to Value, optional
        Other values than those of the run, the same in all variants.
    design, samples, draw
        Which combinations of values are run, as :func:`rockshed.study` has it; not of a sequence.
    metrics, percentiles
        What is told of the variants, as :func:`rockshed.study` has it.
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
        FMUs, kernels or versions are others than those of the run; values that do not fit, or that
        cannot be set then; a time without an exchange.
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
    known = plain(values or {})
    if isinstance(variants, Mapping):
        columns = {name: varied(given) for name, given in variants.items()}
    else:
        columns = _listed(variants)
        design = LISTED
    asked = StudyArguments(
        vary=columns,
        design=design,
        samples=samples,
        draw=draw,
        metrics=tuple(metrics),
        percentiles=percentiles,
        workers=workers,
        pictures=pictures,
        **_branched(parent, at, known, columns, note),
    )
    place = Path(folder) if folder else None
    return carry_out_study(asked, place, progress or no_progress, note)


def _branched(
    parent: StoredRun,
    at: float | None,
    values: Mapping[str, Value],
    columns: Mapping[str, Varied],
    note: Note,
) -> dict[str, Any]:
    """Return what was asked in a run, and where its variants branch off on its way."""
    if at is None or at == system_of(parent).start_time:
        request = request_of(parent, columns, note)
        return {"request": Request(**{**vars(request), "values": {**request.values, **values}})}
    refuse_in_process(parent)
    name = str(parent.provenance.get("name", "run"))
    point = BranchPoint(str(parent.folder.resolve()), at)
    return {"request": Request(name, values), "branch": point}


def _listed(variants: Sequence[Mapping[str, Value]]) -> dict[str, Varied]:
    """Return the values of some variants by name, in their order.

    Raises
    ------
    InputRefused
        A variant has no value of something that others have: one problem for each.
    """
    names = list(dict.fromkeys(name for values in variants for name in values))
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
    return {name: Listed(tuple(values[name] for values in variants)) for name in names}
