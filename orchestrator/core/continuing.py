"""Runs that go on from a checkpoint in another process, whatever ended the first one."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ..versions import sources_digest
from .errors import InputRefused, Problem
from .fmu.slave import Source
from .loop.checkpointing import PROGRAM, Checkpointing, checkpoint_exchanges
from .loop.instances import SettledInstances
from .loop.master import Interruption, Progress
from .results.checkpoints import (
    START,
    Checkpoint,
    copy_checkpoints,
    readable_checkpoints,
)
from .results.own_files import is_marked, read_data
from .results.provenance import program_problems, source_problems
from .results.reading import StoredRun, read_run
from .results.run_folder import RUN, RunFolder, leftovers
from .run import Session
from .supervisor import announce
from .system.plan import Plan
from .system.planning import make_plan
from .system.system import SystemSpec, system_from

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
    start : Checkpoint or None
        Settled states.
    base : Checkpoint or None
        State from which it goes on; None where there is none but the start.
    witness : Checkpoint or None
        Later state that it has to come by.
    """

    folder: Path
    run: StoredRun
    start: Checkpoint | None
    base: Checkpoint | None
    witness: Checkpoint | None

    @property
    def rows(self) -> int:
        """Number of rows that stay."""
        return self.base.rows if self.base else 0


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
    return max(found, key=lambda stopped: stopped.rows)


def _folders(place: Path) -> list[Path]:
    return [path for path in (place, *leftovers(place)) if (path / RUN).is_file()]


def _run_of(provenance: Mapping[str, Any]) -> object:
    record = provenance.get("checkpoints")
    return record.get("run") if isinstance(record, Mapping) else None


def _newest(place: Path, named: Path) -> dict[str, Any]:
    """Return what describes the newest run of a folder."""
    known = [read_data(path / RUN) for path in _folders(place)]
    if not known:
        read_run(named)  # says why there is none
        raise InputRefused([Problem(str(named), "is no folder of a run", "give one")])
    return max(known, key=lambda provenance: str(provenance.get("started", "")))


def _stopped(place: Path, path: Path) -> Stopped | None:
    """Return where the run in a folder goes on; None where something of it is missing."""
    try:
        run = read_run(path)
    except InputRefused:
        return None
    known = readable_checkpoints(path)
    start = next((c for c in known if c.exchange == START), None)
    later = [c for c in known if c.exchange != START and c.rows <= run.time.size]
    if start is None and not later:
        return None
    base = later[-2] if len(later) > 1 else None
    witness = later[-1] if later else None
    if start is None and base is None:
        base = witness
        witness = None
    return Stopped(place, run, start, base, witness)


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
    refuse_others(stopped, plan, sources)
    record = provenance["checkpoints"]
    plan = replace(plan, warnings=tuple(map(str, record["warnings"])))
    every = checkpoint_exchanges(plan, float(record["every"]))
    with Interruption() as interruption, RunFolder(stopped.folder) as results:
        announce(folder=str(results.folder), running=str(results.running))
        session = Session(plan, sources, results, interruption)
        session.take_checkpoints(Checkpointing(every, results.running, stopped.witness))
        if stopped.start is not None and isinstance(session.instances, SettledInstances):
            session.instances.know(stopped.start)
        try:
            session.prepare(True, _continued(stopped, plan))
            _take_over(stopped, session, results)
            session.run(progress)
        except InputRefused:
            results.discard()
            raise
        finally:
            session.close()
    return read_run(stopped.folder)


def refuse_others(stopped: Stopped, plan: Plan, sources: Mapping[str, Source]) -> None:
    """Refuse FMUs and programs that are others than those of a run.

    Parameters
    ----------
    stopped : Stopped
        The run.
    plan : Plan
        Of its system: the FMUs have been read.
    sources : mapping of str to Source
        Makers of all components.

    Raises
    ------
    InputRefused
        With all that is other than it was.
    """
    provenance = stopped.run.provenance
    problems = [
        *program_problems(provenance, AGAIN),
        *(
            problem
            for name in plan.order
            for problem in source_problems(name, provenance, sources[name], AGAIN)
        ),
    ]
    problems += [
        Problem("rockshed", "its sources have changed since the checkpoint was taken", AGAIN)
        for checkpoint in (stopped.base, stopped.witness)
        if checkpoint and checkpoint.facts.get("program") != sources_digest(PROGRAM)
    ][:1]
    if problems:
        raise InputRefused(problems)


def _continued(stopped: Stopped, plan: Plan) -> dict[str, Any]:
    """Return the provenance of a run that goes on."""
    known = {k: v for k, v in stopped.run.provenance.items() if k not in _OF_THE_END}
    at = plan.timing.seconds(stopped.base.exchange if stopped.base else START)
    event = {"at": at, "when": datetime.now(UTC).isoformat()}
    return {**known, "status": "running", "resumed": [*known.get("resumed", []), event]}


def _take_over(stopped: Stopped, session: Session, results: RunFolder) -> None:
    """Bring a session and its folder to the state of a run that goes on.

    Checkpoints come last: a folder that has one has all rows before it.
    """
    base = stopped.base
    if base is not None:
        session.parts.put_back(base)
        series = stopped.run.series
        values = [series[column.name][: base.rows] for column in stopped.run.columns[1:]]
        results.rows(stopped.run.time[: base.rows], np.reshape(values, (-1, base.rows)).T)
        for name, at, state in _frames(stopped, session.plan):
            results.frame(name, at, state)
    known = [c.exchange for c in (stopped.start, base) if c is not None]
    copy_checkpoints(stopped.run.folder, results.running, known)


def _frames(stopped: Stopped, plan: Plan) -> Iterator[tuple[str, float, bytes]]:
    """Yield the recorded states up to a checkpoint in the order in which they were recorded."""
    components = plan.system.components
    framed = [name for name in plan.order if components[name].record_states]
    number = stopped.base.frames if stopped.base else 0
    kept = {name: islice(stopped.run.states(name), number) for name in framed}
    for together in zip(*kept.values(), strict=True):
        for name, (at, state) in zip(kept, together):
            yield name, at, state
