"""Many variants of a run from one of its states, one after the other in one process.

The run goes on to the time at which the variants branch off once; each of them begins with its
state and rows then.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace

from .continuing import (
    Stopped,
    branch_facts,
    refuse_others,
    stopped_before,
    system_of,
    take_over,
    warnings_before,
)
from .errors import InputRefused, Problem, RunFailed
from .fmu.slave import Source
from .loop.changes import plan_change
from .loop.checkpointing import Parts
from .loop.instances import KeptInstances
from .loop.master import Interruption
from .results.changes import ValueChange, changes_of
from .results.checkpoints import Checkpoint, file_of
from .results.memory import NOWHERE, MemoryResults
from .results.reading import StoredRun
from .results.run_folder import RUN
from .run import Session, sources_of
from .system.fields import Value
from .system.plan import Plan
from .system.planning import make_plan
from .system.system import SystemSpec


@dataclass(frozen=True)
class Stem:
    """A run up to the time at which its variants branch off.

    Attributes
    ----------
    parent : StoredRun
        The run.
    at : float
        The time (s).
    plan, sources
        Of each variant.
    stopped : Stopped
        Rows and state then.
    """

    parent: StoredRun
    at: float
    plan: Plan
    sources: Mapping[str, Source]
    stopped: Stopped


class _Stopping:
    """Takes the state after some exchanges, and ends the run there.

    Parameters
    ----------
    exchange, last : int
        Number of these exchanges, and of all.
    interruption : Interruption
        Of the run.

    Attributes
    ----------
    parts : Parts
        Of the run; set before the first exchange.
    taken : Checkpoint or None
        The state, once it is reached.
    """

    parts: Parts
    taken: Checkpoint | None = None

    def __init__(self, exchange: int, last: int, interruption: Interruption) -> None:
        self._exchange = exchange
        self._last = last
        self._interruption = interruption

    def next(self, exchange: int) -> int:
        """Return the number of exchanges after which the state is taken."""
        return self._exchange if exchange < self._exchange else self._last

    def look(self, exchange: int) -> None:
        """Take the state if it is time.

        Raises
        ------
        RunFailed
            A slave does not give its state.
        """
        if exchange == self._exchange:
            self.taken = self.parts.take()
            self._interruption.requested = True


def grow_stem(parent: StoredRun, at: float, system: SystemSpec, instances: KeptInstances) -> Stem:
    """Let a run go on from the newest checkpoint before a time to that time, in memory.

    Parameters
    ----------
    parent : StoredRun
        The run.
    at : float
        The time (s).
    system : SystemSpec
        Of the run, with or without recorded states.
    instances : KeptInstances
        Of earlier runs of this thread; they take those of this one.

    Returns
    -------
    Stem

    Raises
    ------
    InputRefused
        FMUs or programs are others than those of the run, there is no checkpoint before this time,
        or the state is not taken back.
    RunFailed
        The run does not come to this time.
    KeyboardInterrupt
        It was interrupted.
    """
    sources = instances.sources(sources_of(system))
    plan = make_plan(system, sources)
    number = plan_change(plan, ValueChange(at, {})).exchange
    stopped = stopped_before(parent, at, number, NOWHERE)
    refuse_others(parent, sources, (stopped.base,))
    plan = replace(plan, warnings=warnings_before(parent))
    if stopped.settled is not None:
        instances.know(stopped.settled)
    stem = Stem(parent, at, plan, sources, stopped)
    return stem if stopped.base.exchange == number else _grown(stem, number, instances)


def _grown(stem: Stem, number: int, instances: KeptInstances) -> Stem:
    """Let the run of a stem go on to a number of exchanges."""
    with Interruption() as interruption:
        results = MemoryResults()
        session = Session(stem.plan, stem.sources, results, interruption, instances)
        stopping = _Stopping(number, stem.plan.timing.exchanges, interruption)
        changes = [plan_change(stem.plan, change) for change in changes_of(stem.parent.provenance)]
        session.begin_with(None, changes)
        session.keepers.append(stopping)
        try:
            session.prepare(True, dict(stem.parent.provenance))
            stopping.parts = session.parts
            take_over(stem.stopped, session, results)
            session.run(None)
        finally:
            session.close()
    if stopping.taken is None:
        raise KeyboardInterrupt
    grown = replace(stem.stopped, run=results.run(), base=stopping.taken)
    return replace(stem, stopped=grown)


def digest_of_state(parent: StoredRun, at: float) -> str:
    """Return a digest by which the state is known from which variants of a run go on.

    Parameters
    ----------
    parent : StoredRun
        The run.
    at : float
        Time (s) at which they branch off.

    Raises
    ------
    InputRefused
        There is no checkpoint before this time.
    """
    system = system_of(parent)
    number = plan_change(make_plan(system, sources_of(system)), ValueChange(at, {})).exchange
    base = stopped_before(parent, at, number, NOWHERE).base
    content = file_of(parent.folder, base.exchange).read_bytes()
    return hashlib.sha256(content + (parent.folder / RUN).read_bytes()).hexdigest()


def refuse_values(stem: Stem, values: Mapping[str, Value]) -> None:
    """Refuse values that a variant cannot have from its time on.

    Parameters
    ----------
    stem : Stem
        That the variant branches off.
    values : mapping of str to Value
        By ``component.variable``.

    Raises
    ------
    InputRefused
        With the reason for each of them.
    """
    plan_change(stem.plan, ValueChange(stem.at, values))


def run_variant(stem: Stem, values: Mapping[str, Value], instances: KeptInstances) -> StoredRun:
    """Run a variant without files, from the state of its stem.

    Parameters
    ----------
    stem : Stem
        That it branches off.
    values : mapping of str to Value
        From then on, by ``component.variable``.
    instances : KeptInstances
        Of earlier runs of this thread; they take those of this one.

    Returns
    -------
    StoredRun
        Complete, interrupted or failed; it lies in no folder, and has no serialized states. The
        provenance of one that failed has the time (s), ``failed_at``.

    Raises
    ------
    InputRefused
        The values cannot be set then, or a component does not take its state back.
    """
    change = ValueChange(stem.at, values)
    every = [*changes_of(stem.parent.provenance), change]
    changes = [plan_change(stem.plan, each) for each in every]
    results = MemoryResults()
    with Interruption() as interruption:
        session = Session(stem.plan, stem.sources, results, interruption, instances)
        session.begin_with(None, changes)
        try:
            session.prepare(True, branch_facts(stem.parent, change))
            take_over(stem.stopped, session, results)
            session.run(None)
        except RunFailed as failure:
            results.amend(failed_at=failure.time)
        finally:
            session.close()
    return results.run()


def plan_branching(parent: StoredRun, at: float, problems: list[Problem]) -> Plan:
    """Return the plan of a run whose variants branch off at a time; nothing is run.

    Parameters
    ----------
    parent : StoredRun
        The run.
    at : float
        The time (s).
    problems : list of Problem
        Takes everything that stands against it.

    Raises
    ------
    InputRefused
        The FMUs are no longer there, or do not fit together.
    """
    system = system_of(parent)
    sources = sources_of(system)
    plan = make_plan(system, sources)
    stopped = None
    try:
        number = plan_change(plan, ValueChange(at, {})).exchange
        stopped = stopped_before(parent, at, number, NOWHERE)
    except InputRefused as refusal:
        problems += refusal.problems
    try:
        refuse_others(parent, sources, (stopped.base if stopped else None,))
    except InputRefused as refusal:
        problems += refusal.problems
    return plan
