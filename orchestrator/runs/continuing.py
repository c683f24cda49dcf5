"""Runs that go on from a checkpoint: continued, or as variants."""

import os
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from rockshed.components.catalogue import component

from ..core import continuing
from ..core.continuing import Stopped, find_stopped, system_of
from ..core.errors import InputRefused, Problem, RunFailed, UnknownName
from ..core.fmu.slave import Source
from ..core.loop.master import Progress
from ..core.results.changes import ValueChange, branch_record, changes_of
from ..core.results.checkpoints import read_settled
from ..core.results.own_files import read_data
from ..core.results.reading import StoredRun
from ..core.results.run_folder import RUN
from ..core.run import simulate as simulate_spec
from ..core.run import sources_of
from ..core.system.fields import Value
from ..core.system.other_values import with_values
from ..core.system.plan import Plan
from ..core.system.planning import make_plan
from ..temporary import TemporaryFolder
from .building import Note, silent
from .job import Job
from .kept import FINISHED
from .request import Request, plain
from .run import Run, read_run
from .simulation import checked, kept, measured, warnings_of
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
    _refuse_batch(Path(folder))
    stopped = find_stopped(Path(folder))
    if stopped is None:
        return checked(read_run(folder), strict)
    try:
        continuing.resume(stopped, sources_of_run(stopped.run, system), progress=progress)
    except RunFailed as failure:
        failure.run = measured(stopped.folder)
        raise
    return checked(measured(stopped.folder), strict)


def _refuse_batch(folder: Path) -> None:
    """Refuse a folder of many runs, and say how those go on.

    Raises
    ------
    InputRefused
        A study, a calibration, a campaign, ... was or is in it.
    """
    kind = read_data(folder / RUN).get("kind")
    if os.path.isdir(folder / FINISHED):
        what = "holds runs of a calibration, convergence study or reproduction that was ended"
        remedy = "start the same command again: it goes on from these runs"
    elif kind:
        what = f"holds the results of {kind}, which has ended"
        remedy = "nothing is left to do; the same command would carry it out anew"
    else:
        return
    raise InputRefused([Problem(str(folder), what, remedy)])


def stopped_at(folder: Path) -> Stopped | None:
    """Return where the run of a folder would go on; None where it cannot."""
    try:
        return find_stopped(folder)
    except InputRefused:
        return None


def branch(
    run: StoredRun | str | Path,
    values: Mapping[str, Value],
    *,
    at: float | None = None,
    folder: str | Path | None = None,
    checkpoint_every: float | None = None,
    progress: Progress | None = None,
    note: Note = silent,
) -> Run:
    """Run a variant of a run from one of its states.

    From the start, any parameter may have another value: components of which nothing is other than
    in the run begin with their settled states (a bed of sand does not settle again), the others are
    initialised anew. From a later time on, the variant has the rows of the run before it, and
    takes what FMI lets a master set between two steps: tunable parameters, and inputs that nothing
    feeds.

    Parameters
    ----------
    run : Run, str or Path
        The run, or its folder. States are there if it had ``checkpoint_every``; without them the
        variant takes as long as a run.
    values : mapping of str to Value
        By ``component.variable``, of a case from the start also as ``with_values`` takes them.
    at : float, optional
        Time (s) from which on the values hold; by default the start of the run.
    folder : str or Path, optional
        Folder of the results; by default a temporary one, as for :func:`rockshed.simulate`.
    checkpoint_every : float, optional
        Simulated time (s) between two checkpoints of the variant.
    progress : callable, optional
        Called with the time reached and the stop time (s), every now and then.
    note : callable, optional
        Called with a line for each FMU that is built.

    Returns
    -------
    Run
        The variant.

    Raises
    ------
    InputRefused
        FMUs, kernels or versions are others than those of the run; values that cannot be set then,
        or do not fit; a time without an exchange.
    RunFailed
        The variant could not go on; its attribute ``run`` has the results until then.

    Examples
    --------
    >>> import rockshed
    >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
    >>> run = rockshed.simulate(system, checkpoint_every=5e-4)
    >>> slower = rockshed.branch(run, {"rock.velocity0.y": -4.0})
    >>> float(slower["rock.velocity.y"][0])
    -4.0
    """
    parent = run if isinstance(run, StoredRun) else read_run(run)
    begin = system_of(parent).start_time
    change = ValueChange(begin if at is None else at, plain(values))
    temporary = TemporaryFolder("rockshed-") if folder is None else None
    name = f"{parent.provenance.get('name', 'run')}-branch"
    place = Path(temporary.name) / name if temporary else Path(str(folder))
    conduct: dict[str, Any] = {"checkpoint_every": checkpoint_every, "progress": progress}
    try:
        if change.at == begin:
            _from_start(parent, change, place, note, conduct)
        else:
            continuing.branch(parent, change, place, sources_of_run(parent), **conduct)
    except RunFailed as failure:
        failure.run = kept(measured(place), temporary)
        raise
    except BaseException:
        if temporary:
            temporary.cleanup()
        raise
    return kept(measured(place), temporary)


def _from_start(
    parent: StoredRun, change: ValueChange, folder: Path, note: Note, conduct: Mapping[str, Any]
) -> None:
    """Run a system with other values from the settled states of a run."""
    _refuse_other_system(parent, note)
    varied = _job_with(parent, change.values, note)
    record = branch_record(parent.folder, parent.provenance, change)

    def facts(plan: Plan) -> dict[str, Any]:
        return {**varied.facts, "branch": record, "warnings": warnings_of(varied, plan)}

    simulate_spec(
        varied.system,
        folder,
        sources=varied.sources,
        settled=read_settled(parent.folder),
        changes=changes_of(parent.provenance),
        facts=facts,
        **conduct,
    )


def _refuse_other_system(parent: StoredRun, note: Note) -> None:
    """Refuse variants of a run whose system would be another one now.

    Raises
    ------
    InputRefused
        FMUs, kernels, versions, case or project are others.
    """
    job = _job_with(parent, {}, note)
    sources = {**sources_of(job.system), **job.sources}
    make_plan(job.system, sources)  # reads the FMUs
    continuing.refuse_others(parent, sources)
    if job.system.model_dump(mode="json") != parent.provenance["system"]:
        what = "is another system now: its case or project has changed"
        raise InputRefused([Problem(str(parent.folder), what, continuing.AGAIN)])


def request_of(parent: StoredRun, varied: Collection[str], note: Note) -> Request:
    """Return what was asked in a run, for variants of it in other processes.

    Parameters
    ----------
    parent : StoredRun
        The run.
    varied : collection of str
        Values that the variants have instead of those of the run.
    note : callable
        Called with a line for each FMU that is built.

    Raises
    ------
    InputRefused
        The run is none of a case or file, ran in its process, or would be another one now.
    """
    refuse_in_process(parent)
    told = parent.provenance.get("request")
    if told is None:
        what = "is none of a case, a project or a system file, whose variants could begin anew"
        remedy = "branch it at a later time, at=..., or once for each variant"
        raise InputRefused([Problem(str(parent.folder), what, remedy)])
    if changes_of(parent.provenance):
        what = "is a variant whose values changed on the way, which no run has from its start"
        remedy = "branch it at a later time, at=..., or once for each variant"
        raise InputRefused([Problem(str(parent.folder), what, remedy)])
    request = _request_of(parent, told)
    _refuse_other_system(parent, note)
    kept = {name: value for name, value in request.values.items() if name not in varied}
    return replace(request, values=kept)


def refuse_in_process(parent: StoredRun) -> None:
    """Refuse a run whose variants cannot run in other processes.

    Parameters
    ----------
    parent : StoredRun
        The run.

    Raises
    ------
    InputRefused
        Components that are in no FMU file.
    """
    known = parent.provenance.get("components") or {}
    if not all("fmu" in facts for facts in known.values()):
        what = "has components in its process, and variants run in processes of their own"
        remedy = "run a case or a file with FMUs, or branch it once for each variant"
        raise InputRefused([Problem(str(parent.folder), what, remedy)])


def _request_of(run: StoredRun, told: Any) -> Request:
    try:
        return Request(**told)
    except TypeError as error:
        where = f"{run.folder / RUN}: request"
        what = "is none of this version of the program"
        raise InputRefused([Problem(where, what, continuing.AGAIN)]) from error


def _job_with(run: StoredRun, values: Mapping[str, Value], note: Note) -> Job:
    """Make the system of a run with other values; that of a case is made again, as they follow."""
    told = run.provenance.get("request")
    if told is not None:
        request = _request_of(run, told)
        return System.prepared(replace(request, values={**request.values, **values}), note).job
    spec = with_values(system_of(run), values)
    known = run.provenance.get("differences", {})
    return Job(spec.name, spec, sources_of_run(run), {"differences": {**known, **values}})


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
