"""Runs that go on from a checkpoint in another process, whatever ended the first one."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ..versions import sources_digest
from .errors import InputRefused, Problem
from .fmu.slave import Source
from .loop.changes import plan_change
from .loop.checkpointing import PROGRAM, Checkpointing, checkpoint_exchanges
from .loop.master import Interruption, Progress
from .results.changes import ValueChange, branch_record, changes_of
from .results.checkpoints import (
    Checkpoint,
    copy_checkpoints,
    known_checkpoints,
    new_record,
    read_settled,
    readable_checkpoints,
)
from .results.memory import MemoryResults
from .results.own_files import is_marked, read_data
from .results.provenance import program_problems, source_problems
from .results.reading import StoredRun, read_run
from .results.run_folder import RUN, RunFolder, leftovers
from .run import Session
from .supervisor import announce
from .system.plan import Plan
from .system.planning import make_plan
from .system.reading import system_from
from .system.system import SystemSpec

_OF_THE_END = (
    *("error", "ended", "warnings", "wall_time", "cpu_time"),
    *("rockshed_files", "replaces", "formulas", "band"),
)
"""Entries of ``run.json`` that are written when a run ends."""
AGAIN = "run it again from the start"
_RUNNING = re.compile(r"(.+)\.running(?:-\d+)?")


@dataclass(frozen=True)
class Stopped:
    """A run that has not come to its end, and where it may go on.

    Attributes
    ----------
    folder : Path
        Its final place.
    run : StoredRun
        What there is of it.
    settled : Checkpoint or None
        Settled states, with which FMUs come to their first step sooner.
    base : Checkpoint
        State from which it goes on.
    witness : Checkpoint or None
        Later state that it has to come by.
    """

    folder: Path
    run: StoredRun
    settled: Checkpoint | None
    base: Checkpoint
    witness: Checkpoint | None


def final_folder(folder: Path) -> Path:
    """Return the final place of a run, also of one that is named by the folder it wrote in."""
    found = _RUNNING.fullmatch(folder.name)
    if found and is_marked(folder):
        return folder.parent / found[1]
    return folder


def system_of(run: StoredRun) -> SystemSpec:
    """Return the system of a run, as its provenance holds it.

    Raises
    ------
    InputRefused
        It holds none of this version.
    """
    return system_from(run.provenance.get("system") or {}, str(run.folder / RUN))


def find_stopped(folder: Path) -> Stopped | None:
    """Find out where a run goes on.

    Parameters
    ----------
    folder : Path
        Of a run.

    Returns
    -------
    Stopped or None
        None of a run that is complete.

    Raises
    ------
    InputRefused
        There is no run, or it has no checkpoint.
    """
    place = final_folder(folder)
    newest = _newest(place, folder)
    if newest.get("status") == "complete":
        return None
    record = newest.get("checkpoints")
    if not isinstance(record, Mapping) or "run" not in record:
        what = "has no checkpoint: it was run without checkpoint_every"
        again = "run it again with checkpoint_every=..., which a run that is ended goes on from"
        raise InputRefused([Problem(str(folder), what, again)])
    found = [
        stopped
        for path in _folders(place)
        if _run_of(read_data(path / RUN)) == record["run"]
        and (stopped := _stopped(place, path)) is not None
    ]
    if not found:
        what = "has no checkpoint that is whole: it was ended before the first one"
        raise InputRefused([Problem(str(folder), what, AGAIN)])
    return max(found, key=lambda stopped: stopped.base.exchange)


def _folders(place: Path) -> list[Path]:
    return [path for path in (place, *leftovers(place)) if os.path.isfile(path / RUN)]


def _run_of(provenance: Mapping[str, Any]) -> object:
    record = provenance.get("checkpoints")
    return record.get("run") if isinstance(record, Mapping) else None


def _newest(place: Path, named: Path) -> dict[str, Any]:
    """Return what describes the newest run of a folder."""
    known = [read_data(path / RUN) for path in _folders(place)]
    if not any(known):
        read_run(named)  # says why there is none, or what is damaged
        raise InputRefused([Problem(str(named), "is no folder of a run", "give one")])
    return max(known, key=lambda provenance: str(provenance.get("started", "")))


def _stopped(place: Path, path: Path) -> Stopped | None:
    """Return where the run in a folder goes on; None where something of it is missing."""
    try:
        run = read_run(path)
    except InputRefused:
        return None
    known = [c for c in readable_checkpoints(path) if c.rows <= run.time.size]
    if not known:
        return None
    witness = known[-1] if len(known) > 1 else None
    return Stopped(place, run, read_settled(path), known[-2:][0], witness)


def resume(
    stopped: Stopped,
    sources: Mapping[str, Source],
    *,
    progress: Progress | None = None,
) -> StoredRun:
    """Let a run go on to its end.

    Its results are those of a run that nothing has ended, to the bit.

    Parameters
    ----------
    stopped : Stopped
        Of :func:`find_stopped`.
    sources : mapping of str to Source
        Makers of all components.
    progress : callable, optional
        Called now and then with the time reached and the stop time (s).

    Returns
    -------
    StoredRun
        Complete or interrupted.

    Raises
    ------
    InputRefused
        FMUs or programs are others than those of the run, or its state is not taken back; what
        there is of it stays.
    RunFailed
        The run could not go on; the results until then are in the folder.
    """
    provenance = stopped.run.provenance
    plan = make_plan(system_of(stopped.run), sources)
    refuse_others(stopped.run, sources, (stopped.base, stopped.witness))
    plan = replace(plan, warnings=warnings_before(stopped.run))
    every = checkpoint_exchanges(plan, float(provenance["checkpoints"]["every"]))
    course = Continuation(plan, sources, every, changes_of(provenance), progress)
    return _gone_on(stopped, course, _continued(stopped, plan))


@dataclass(frozen=True)
class Continuation:
    """How a run goes on.

    Attributes
    ----------
    plan, sources
        Of the run.
    every : int
        Number of exchanges between two checkpoints; 0 for none.
    changes : sequence of ValueChange
        Values that change on the way.
    progress : callable, optional
        Called now and then with the time reached and the stop time (s).
    """

    plan: Plan
    sources: Mapping[str, Source]
    every: int
    changes: Sequence[ValueChange] = ()
    progress: Progress | None = None


def _gone_on(stopped: Stopped, course: Continuation, facts: dict[str, Any]) -> StoredRun:
    """Let a run go on into the folder of its results, or into another one."""
    changes = [plan_change(course.plan, change) for change in course.changes]
    with Interruption() as interruption, RunFolder(stopped.folder) as results:
        announce(folder=str(results.folder), running=str(results.running))
        session = Session(course.plan, course.sources, results, interruption)
        session.begin_with(stopped.settled, changes)
        if course.every:
            keeper = Checkpointing(course.every, results.running, stopped.witness)
            session.take_checkpoints(keeper)
        try:
            session.prepare(True, facts)
            take_over(stopped, session, results)
            session.run(course.progress)
        except InputRefused:
            results.discard()
            raise
        finally:
            session.close()
    return read_run(stopped.folder)


def branch(
    parent: StoredRun,
    change: ValueChange,
    folder: Path,
    sources: Mapping[str, Source],
    *,
    checkpoint_every: float | None = None,
    progress: Progress | None = None,
) -> StoredRun:
    """Let a variant of a run go on from one of its states.

    It begins at the newest checkpoint at or before the time of the change, and runs on to that time
    as its parent did.

    Parameters
    ----------
    parent : StoredRun
        The run.
    change : ValueChange
        Time and values.
    folder : Path
        Of the results, which begin with the rows of the parent.
    sources : mapping of str to Source
        Makers of all components.
    checkpoint_every : float, optional
        Simulated time (s) between two checkpoints of the variant.
    progress : callable, optional
        Called now and then with the time reached and the stop time (s).

    Returns
    -------
    StoredRun
        Complete or interrupted.

    Raises
    ------
    InputRefused
        FMUs or programs are others than those of the run; times or values that cannot be.
    RunFailed
        The variant could not go on; the results until then are in the folder.
    """
    plan = make_plan(system_of(parent), sources)
    number = plan_change(plan, change).exchange
    every = checkpoint_exchanges(plan, checkpoint_every)
    stem = stopped_before(parent, change.at, number, folder)
    refuse_others(parent, sources, (stem.base,))
    plan = replace(plan, warnings=warnings_before(parent))
    facts = branch_facts(parent, change)
    if checkpoint_every is not None:
        facts["checkpoints"] = new_record(checkpoint_every, plan.warnings)
    changes = [*changes_of(parent.provenance), change]
    return _gone_on(stem, Continuation(plan, sources, every, changes, progress), facts)


def stopped_before(parent: StoredRun, at: float, number: int, folder: Path) -> Stopped:
    """Return where variants of a run go on: at its newest checkpoint before a time, or then.

    Parameters
    ----------
    parent : StoredRun
        The run.
    at : float
        The time (s).
    number : int
        Of the exchanges until then.
    folder : Path
        Of the results of the variant.

    Raises
    ------
    InputRefused
        There is no such checkpoint, or a component has ended the run before.
    """
    if parent.status == "complete" and parent.time.size and parent.time[-1] < at:
        what = f"{at:g} s is after the end of the run, which a component has ended"
        remedy = f"give a time before {float(parent.time[-1]):.9g} s"
        raise InputRefused([Problem("at", what, remedy)])
    known = readable_checkpoints(parent.folder)
    before = [c for c in known if c.exchange <= number and c.rows <= parent.time.size]
    if not before:
        what = "has no checkpoint before this time"
        remedy = "run it again with checkpoint_every=..., or branch at its start"
        raise InputRefused([Problem(str(parent.folder), what, remedy)])
    return Stopped(folder, parent, read_settled(parent.folder), before[-1], None)


def warnings_before(run: StoredRun) -> tuple[str, ...]:
    """Return the warnings that a run with checkpoints had before its first step.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    record = run.provenance.get("checkpoints") or {}
    return tuple(map(str, record.get("warnings", ())))


def branch_facts(parent: StoredRun, change: ValueChange) -> dict[str, Any]:
    """Return the provenance of a variant that has its parent's up to a time.

    Parameters
    ----------
    parent : StoredRun
        The run that it branches off.
    change : ValueChange
        Time and values.
    """
    left_out = (*_OF_THE_END, "checkpoints", "resumed")
    known = {key: value for key, value in parent.provenance.items() if key not in left_out}
    differing = {**known.get("differences", {}), **change.values}
    started = datetime.now(UTC).isoformat()
    record = branch_record(parent.folder, parent.provenance, change)
    return {**known, "started": started, "differences": differing, "branch": record}


def refuse_others(
    run: StoredRun, sources: Mapping[str, Source], checkpoints: Sequence[Checkpoint | None] = ()
) -> None:
    """Refuse FMUs and programs that are others than those of a run.

    Parameters
    ----------
    run : StoredRun
        The run.
    sources : mapping of str to Source
        Makers of all components; their descriptions have been read.
    checkpoints : sequence of Checkpoint or None
        States from which it goes on.

    Raises
    ------
    InputRefused
        With all that is other than it was.
    """
    problems = [
        *program_problems(run.provenance, AGAIN),
        *(
            problem
            for name, source in sources.items()
            for problem in source_problems(name, run.provenance, source, AGAIN)
        ),
    ]
    problems += [
        Problem("rockshed", "its sources have changed since the checkpoint was taken", AGAIN)
        for checkpoint in checkpoints
        if checkpoint and checkpoint.facts.get("program") != sources_digest(PROGRAM)
    ][:1]
    if problems:
        raise InputRefused(problems)


def _continued(stopped: Stopped, plan: Plan) -> dict[str, Any]:
    """Return the provenance of a run that goes on."""
    known = {k: v for k, v in stopped.run.provenance.items() if k not in _OF_THE_END}
    at = plan.timing.seconds(stopped.base.exchange)
    event = {"at": at, "when": datetime.now(UTC).isoformat()}
    return {**known, "status": "running", "resumed": [*known.get("resumed", []), event]}


def take_over(stopped: Stopped, session: Session, results: RunFolder | MemoryResults) -> None:
    """Bring a session and its results to the state of a run that goes on.

    Checkpoints come last: a folder that has one has all rows before it.

    Parameters
    ----------
    stopped : Stopped
        The run.
    session : Session
        Prepared for it.
    results : RunFolder or MemoryResults
        Of the session.

    Raises
    ------
    InputRefused
        A component does not take its state back.
    """
    base = stopped.base
    session.parts.put_back(base)
    series = stopped.run.series
    values = [series[column.name][: base.rows] for column in stopped.run.columns[1:]]
    results.rows(stopped.run.time[: base.rows], np.reshape(values, (-1, base.rows)).T)
    for name, at, state in _frames(stopped, session.plan):
        results.frame(name, at, state)
    if session.checkpointing is not None and results.running is not None:
        known = {base.exchange, *known_checkpoints(stopped.run.folder)[:1]}
        copy_checkpoints(stopped.run.folder, results.running, sorted(known))


def _frames(stopped: Stopped, plan: Plan) -> Iterator[tuple[str, float, bytes]]:
    """Yield the recorded states up to a checkpoint in the order in which they were recorded."""
    components = plan.system.components
    framed = [name for name in plan.order if components[name].record_states]
    kept = {name: islice(stopped.run.states(name), stopped.base.frames) for name in framed}
    for together in zip(*kept.values(), strict=True):
        for name, (at, state) in zip(kept, together):
            yield name, at, state
