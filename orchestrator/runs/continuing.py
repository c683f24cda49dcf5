"""Runs that go on from a checkpoint: continued."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rockshed.components.catalogue import component

from ..core import continuing
from ..core.continuing import Stopped, find_stopped, system_of
from ..core.errors import InputRefused, Problem, RunFailed, UnknownName
from ..core.fmu.slave import Source
from ..core.loop.master import Progress
from ..core.results.reading import StoredRun
from ..core.run import sources_of
from .run import Run, read_run
from .simulation import checked, measured
from .system import System


def resume(
    folder: str | Path,
    *,
    system: System | None = None,
    progress: Progress | None = None,
    strict: bool = False,
) -> Run:
    """Let a run that was killed, interrupted or has failed go on from its last checkpoints.

    Its results are those of a run that nothing has ended, to the bit. It begins at the last
    checkpoint but one and has to come by the last one with the same values: an FMU whose
    serialized state does not hold everything is found out.

    Parameters
    ----------
    folder : str or Path
        Folder of the results of a run with ``checkpoint_every``.
    system : System, optional
        For a run with components of one's own in this process: the same system.
    progress : callable, optional
        Called with the time reached and the stop time (s), every now and then.
    strict : bool
        Take a complete run with any warning for an error.

    Returns
    -------
    Run
        Complete, or with the status ``interrupted`` after Ctrl-C. Of a run that is complete
        already, its results.

    Raises
    ------
    InputRefused
        There is no run or no checkpoint, FMUs, kernels or versions are others than those of the
        run, or an FMU does not take its state back; what there is of the run stays.
    RunFailed
        The run could not go on; its attribute ``run`` has the results until then.
    RunDoubted
        With ``strict``, the run is complete and has warnings.

    Examples
    --------
    >>> import rockshed, tempfile
    >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
    >>> with tempfile.TemporaryDirectory() as place:
    ...     done = rockshed.simulate(system, f"{place}/run", checkpoint_every=2e-4)
    ...     again = rockshed.resume(f"{place}/run")
    >>> again.status
    'complete'
    """
    stopped = find_stopped(Path(folder))
    if stopped is None:
        return checked(read_run(folder), strict)
    try:
        continuing.resume(stopped, sources_of_run(stopped.run, system), progress=progress)
    except RunFailed as failure:
        failure.run = measured(stopped.folder)
        raise
    return checked(measured(stopped.folder), strict)


def stopped_at(folder: Path) -> Stopped | None:
    """Return where the run of a folder would go on; None where it cannot."""
    try:
        return find_stopped(folder)
    except InputRefused:
        return None


def sources_of_run(run: StoredRun, system: System | None = None) -> dict[str, Source]:
    """Return the makers of all components of a run, as its provenance names them.

    Parameters
    ----------
    run : StoredRun
        The run.
    system : System, optional
        Has components that are in no file.

    Raises
    ------
    InputRefused
        Components of somebody's own, which only their system has.
    """
    known = run.provenance.get("components") or {}
    here = dict(system.job.sources) if system is not None else {}
    problems = []
    for name, facts in known.items():
        if "fmu" in facts or name in here:
            continue
        try:
            here[name] = _in_process(facts)
        except (UnknownName, LookupError, ValueError):
            what = "ran in its process, and is none of the catalogue"
            remedy = "give the system that it belongs to: system=..., in Python"
            problems.append(Problem(name, what, remedy))
    if problems:
        raise InputRefused(problems)
    return {**sources_of(system_of(run)), **here}


def _in_process(facts: Mapping[str, Any]) -> Source:
    """Make a component of the catalogue again in its sizes."""
    from rockshed.fmus.in_process import InProcess  # imports pythonfmu, which FMU files do not need

    made = component(str(facts["component"]))
    sizes = {name: int(facts[name]) for name in made.sizes if name in facts}
    return InProcess(made, sizes)
