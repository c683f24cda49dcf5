"""Run a system from its data to its results: the one function that an application needs."""

import time
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from .errors import InputRefused, Problem, RunFailed
from .fmu.fmu_slave import FmuFile
from .fmu.slave import FATAL, OK, WARNING, Slave, SlaveLost, Source, counts_of, status_name
from .isolation.slave import IsolatedFmu
from .loop.buses import Buses
from .loop.changes import Changing, advice, plan_change
from .loop.checkpointing import Checkpointing, Parts, checkpoint_exchanges
from .loop.initialisation import free, initialise, instantiate, losses_refused
from .loop.instances import FreshInstances, KeptInstances, SettledInstances
from .loop.journal import Journal
from .loop.ledger import Accounts
from .loop.master import Interruption, Keeper, Master, Progress
from .loop.recording import Hearing, Recorder
from .loop.scenario import Course
from .masters import driver_of
from .results.changes import ValueChange
from .results.checkpoints import Checkpoint, new_record, write_settled
from .results.memory import MemoryResults
from .results.metric import Metric
from .results.provenance import describe_run
from .results.reading import StoredRun, read_run
from .results.run_folder import RunFolder
from .supervisor import announce
from .system.limits import amount_in_words
from .system.plan import Plan
from .system.planning import make_plan
from .system.system import SystemSpec

Facts = Mapping[str, Any]
"""Facts of a run by their key in its provenance."""


def sources_of(system: SystemSpec, to_run: bool = True) -> dict[str, Source]:
    """Return the FMU files of a system by component, those to be isolated as such.

    Parameters
    ----------
    system : SystemSpec
        Components and their FMUs.
    to_run : bool
        Whether it is to run: then FMUs that this machine cannot run are refused.
    """
    limits = system.isolated
    files = {name: FmuFile(Path(spec.fmu), to_run) for name, spec in system.components.items()}
    return {
        name: IsolatedFmu(file, limits[name]) if name in limits else file
        for name, file in files.items()
    }


def simulate(
    system: SystemSpec,
    folder: Path,
    *,
    sources: Mapping[str, Source] | None = None,
    allow_unstable: bool = False,
    checkpoint_every: float | None = None,
    settled: Checkpoint | None = None,
    changes: Sequence[ValueChange] = (),
    progress: Progress | None = None,
    facts: Facts | Callable[[Plan], Facts] | None = None,
    note: Callable[[str], None] = lambda text: None,
    files: Callable[[Path], None] | None = None,
) -> StoredRun:
    """Run a system and write its results into a folder.

    Ctrl-C or SIGTERM ends the run and keeps what was computed. Everything happens in the calling
    process, but for FMUs that the system isolates: code of any other FMU that crashes takes it
    along (the command ``rockshed run`` does not die of it).

    Parameters
    ----------
    system : SystemSpec
        Components, connections and times.
    folder : Path
        Folder of the run. An earlier run in it is replaced at the end.
    sources : mapping of str to Source, optional
        Makers of components in the place of their FMU files.
    allow_unstable : bool
        Warn of steps that are too long, and do not refuse them.
    checkpoint_every : float, optional
        Simulated time (s) between two checkpoints, from which a run that was killed goes on; by
        default there are none.
    settled : Checkpoint, optional
        Settled states of another run, which are of use where the same was set before.
    changes : sequence of ValueChange
        Values that change, each time at one time of the run.
    progress : callable, optional
        Called now and then with the time reached and the stop time (s).
    facts : mapping or callable, optional
        Added to the provenance of the run, or a function that gives it from the plan. Warnings
        under ``warnings`` become those of the run.
    note : callable, optional
        Called with a line before the run if its results will be large.
    files : callable, optional
        Called with the folder in which the run writes, when it begins: writes further files there.

    Returns
    -------
    StoredRun
        Complete or interrupted.

    Raises
    ------
    InputRefused
        The system, the FMUs' answer to it, or the folder; nothing is left behind.
    RunFailed
        The run began and could not go on; the results until then are in the folder.
    """
    made_from = {**sources_of(system), **(sources or {})}
    plan = _plan(system, made_from, allow_unstable)
    known = dict(facts(plan) if callable(facts) else facts or {})
    plan = replace(plan, warnings=(*plan.warnings, *known.pop("warnings", ())))
    every = checkpoint_exchanges(plan, checkpoint_every)
    planned = [plan_change(plan, change) for change in changes]
    with Interruption() as interruption, RunFolder(folder) as results:
        announce(folder=str(results.folder), running=str(results.running))
        session = Session(plan, made_from, results, interruption)
        session.begin_with(settled, planned)
        if checkpoint_every is not None:
            session.take_checkpoints(Checkpointing(every, results.running))
            known["checkpoints"] = new_record(checkpoint_every, plan.warnings)
        try:
            session.prepare(allow_unstable, known)
            session.keep_settled(results.running)
            if large := session.large_results():
                note(large)
            session.run(progress, files)
        finally:
            session.close()
    return read_run(folder)


def plan_of(system: SystemSpec, instances: KeptInstances) -> Plan:
    """Return the plan of a system, one of many; files are read once.

    Parameters
    ----------
    system : SystemSpec
        Components, connections and times.
    instances : KeptInstances
        Of the runs of this thread.

    Raises
    ------
    InputRefused
        Everything that is wrong with the system.
    """
    return make_plan(system, instances.sources(sources_of(system)))


def simulate_in_memory(
    system: SystemSpec,
    instances: KeptInstances,
    *,
    allow_unstable: bool = False,
    facts: Facts | None = None,
) -> StoredRun:
    """Run a system as one of many, without files.

    Parameters
    ----------
    system : SystemSpec
        Components, connections and times.
    instances : KeptInstances
        Of earlier runs of this thread; they take those of this run.
    allow_unstable : bool
        Warn of steps that are too long, and do not refuse them.
    facts : mapping, optional
        Added to the provenance of the run.

    Returns
    -------
    StoredRun
        Complete, interrupted or failed; it lies in no folder, and has no serialized states. The
        provenance of one that failed has the time (s), ``failed_at``.

    Raises
    ------
    InputRefused
        The system, or the FMUs' answer to it.
    """
    made_from = instances.sources(sources_of(system))
    plan = make_plan(system, made_from)
    known = dict(facts or {})
    plan = replace(plan, warnings=(*plan.warnings, *known.pop("warnings", ())))
    results = MemoryResults()
    with Interruption() as interruption:
        session = Session(plan, made_from, results, interruption, instances)
        try:
            session.prepare(allow_unstable, known)
            session.run(None)
        except RunFailed as failure:
            results.amend(failed_at=failure.time)
        finally:
            session.close()
    return results.run()


def starting_problems(
    system: SystemSpec, sources: Mapping[str, Source], allow_unstable: bool = False
) -> list[Problem]:
    """Return why a system cannot begin; its components are initialised and thrown away.

    Parameters
    ----------
    system : SystemSpec
        Components, connections and times.
    sources : mapping of str to Source
        Components that are made without an FMU file.
    allow_unstable : bool
        Whether steps may be longer than the stable ones.

    Returns
    -------
    list of Problem
        Empty if it can.
    """
    every = {**sources_of(system), **sources}
    slaves: dict[str, Slave] = {}
    try:
        plan = make_plan(system, every)
        with losses_refused(system):
            slaves = instantiate(plan, every)
            buses = Buses(plan)
            initialise(slaves, buses, allow_unstable)
            driver_of(buses, slaves)
    except InputRefused as refusal:
        return refusal.problems
    finally:
        free(slaves.values())
    return []


def _plan(system: SystemSpec, sources: Mapping[str, Source], allow_unstable: bool) -> Plan:
    """Make the plan; of steps that do not fit, components say too what they have against them."""
    try:
        return make_plan(system, sources)
    except InputRefused as refusal:
        more = _against_steps(system, sources, allow_unstable)
        raise InputRefused([*refusal.problems, *more]) from None


def _against_steps(
    system: SystemSpec, sources: Mapping[str, Source], allow_unstable: bool
) -> list[Problem]:
    """Return what components have against the steps of a system whose other times do not fit.

    Nothing if more than these times is wrong with the system.
    """
    longest = max(system.step(name) for name in system.components)
    silent = {
        name: spec.model_copy(update={"record_states": False})
        for name, spec in system.components.items()
    }
    fitting = {
        "components": silent,
        "output_interval": None,
        "state_interval": None,
        "stop_time": system.start_time + longest,
    }
    slaves: dict[str, Slave] = {}
    try:
        plan = make_plan(system.model_copy(update=fitting), sources)
        with losses_refused(system):
            slaves = instantiate(plan, sources)
            initialise(slaves, Buses(plan), allow_unstable)
    except InputRefused as refusal:
        return refusal.problems if slaves else []
    finally:
        free(slaves.values())
    return []


@dataclass
class Session:
    """The slaves of one run and everything around them.

    Attributes
    ----------
    plan, sources, results, interruption, instances
        Of the run.
    keepers : list of Keeper
        Called between exchanges.
    parts : Parts
        From which the state of the run is taken, once it is prepared.
    """

    plan: Plan
    sources: Mapping[str, Source]
    results: RunFolder | MemoryResults
    interruption: Interruption
    instances: FreshInstances | KeptInstances = field(default_factory=FreshInstances)
    keepers: list[Keeper] = field(default_factory=list)
    checkpointing: Checkpointing | None = None
    changes: Sequence[Changing] = ()
    course: Course | None = None
    slaves: dict[str, Slave] = field(default_factory=dict)
    initialised: bool = False
    finished: bool = False
    warnings: list[str] = field(default_factory=list)

    def take_checkpoints(self, checkpointing: Checkpointing) -> None:
        """Take checkpoints during the run, whose instances then are made for that."""
        self.checkpointing = checkpointing
        self.keepers.append(checkpointing)
        if not isinstance(self.instances, SettledInstances):
            self.instances = SettledInstances()

    def begin_with(self, settled: Checkpoint | None, changes: Sequence[Changing] = ()) -> None:
        """Begin with settled states of another process, and with values that change on the way."""
        if settled is not None:
            self.instances = SettledInstances()
            self.instances.know(settled)
        self.changes = changes
        self.keepers[:0] = changes

    def prepare(self, allow_unstable: bool, facts: dict[str, Any]) -> None:
        """Make and initialise the slaves, then open the results.

        Raises
        ------
        InputRefused
            They refuse that.
        ComponentLost
            The process of an isolated one has ended, or does not return.
        """
        with losses_refused(self.plan.system):
            self._prepare(allow_unstable, facts)

    def _prepare(self, allow_unstable: bool, facts: dict[str, Any]) -> None:
        began = time.perf_counter()
        plan = self.plan
        self.journal = Journal(self.results.running, plan)
        self.slaves = self.instances.make(plan, self.sources, self._enter)
        buses = Buses(plan, self.journal.entries)
        if plan.scenario:
            self.course = Course(buses, self.slaves)
            self.keepers.insert(0, self.course)
        initial = self.instances.initialise(self.slaves, buses, allow_unstable, self._enter)
        self.warnings = [*plan.warnings, *initial]
        self.initialised = True
        advised = partial(advice, self.changes)
        self.accounts = Accounts(self.slaves, buses, advised)
        driver = driver_of(buses, self.slaves)
        if self.course is not None:
            self.course.asks_always = not driver.halts
        recorder = Recorder(self.slaves, buses.snapshots, self.accounts, self.results, driver)
        self.watched = buses.watched
        self.texts = buses.texts
        self.master = Master(self.slaves, buses, recorder, driver, self.keepers, advised)
        self.hearing = Hearing(self.slaves)
        self.parts = Parts(self.slaves, buses, self.accounts, recorder, self.master, self.hearing)
        if self.checkpointing is not None:
            self.checkpointing.parts = self.parts
        for change in self.changes:
            change.slaves = self.slaves
        self.journal.legend(buses.operations, plan)
        self.journal.rests()
        self.preparation = time.perf_counter() - began
        known = describe_run(plan, self.sources, self.slaves)
        self.columns = recorder.columns
        self.results.begin(self.columns, {**known, **facts})

    def keep_settled(self, folder: Path) -> None:
        """Write the settled states with which the run begins into its folder, if it has them."""
        if isinstance(self.instances, SettledInstances):
            settled = self.instances.settled()
            if settled is not None:
                write_settled(folder, settled)

    def large_results(self) -> str:
        """Say what the results will take, if that is much; else nothing."""
        names = [name for name, spec in self.plan.system.components.items() if spec.record_states]
        with losses_refused(self.plan.system):
            states = [self.slaves[name].state() for name in names]
        state = sum(len(zlib.compress(content, 1)) for content in states)
        columns = 1 + len(self.columns)
        place = self.results.running or self.results.folder
        return amount_in_words(self.plan.timing, columns, state, place)

    def _enter(self, component: str) -> None:
        """Note that a component is called next; stop here if that was asked for."""
        self.interruption.look()
        self.journal.prepares(component)

    def run(self, progress: Progress | None, files: Callable[[Path], None] | None = None) -> None:
        """Carry out the exchanges and finish the results, also those of a run that fails."""
        failure: RunFailed | None = None
        try:
            if files is not None and self.results.running is not None:
                files(self.results.running)
            self._set_again()
            is_complete = self.master.run(self.interruption, progress)
            status = "complete" if is_complete else "interrupted"
        except RunFailed as error:
            status = "failed"
            failure = error
        except SlaveLost as lost:
            status = "failed"
            failure = RunFailed(lost.name, self.master.reached, lost.what)
        except OSError as error:
            self._give_up(error)
        self._finish(status, failure)
        if failure is not None:
            raise failure

    def _set_again(self) -> None:
        """Set the values that change at the time of a checkpoint from which the run goes on.

        It may be that of a run without them.
        """
        if self.master.exchanges:
            for change in self.changes:
                change.look(self.master.exchanges)

    def _finish(self, status: str, failure: RunFailed | None) -> None:
        self.journal.rests()
        try:
            self.results.finish(
                status,
                self._metrics(),
                error=str(failure) if failure else None,
                **self._facts(),
            )
        except OSError as error:
            self._give_up(error)
        self.finished = True
        self.journal.moved(self.results.folder)

    def _give_up(self, error: OSError) -> NoReturn:
        """Keep what could be written as the results of a run that failed."""
        place = self.results.running
        what = f"cannot be written: {error.strerror or error}; what was computed is in {place}"
        failure = RunFailed(str(error.filename or place), self.master.reached, what)
        with suppress(OSError):
            self.results.give_up(str(failure), **self._facts())
        raise failure from error

    def _facts(self) -> dict[str, Any]:
        """Return what is known of a run at its end."""
        return {
            "ended": datetime.now(UTC).isoformat(),
            "warnings": self._all_warnings(),
            "wall_time": self._wall_time(),
            "cpu_time": {"exchanges": self.master.cpu_time},
            "early_returns": dict(self.master.returned),
            "texts": self.texts.changes,
            **self.master.driver.facts(),
            **({"scenario_events": self.course.events} if self.course else {}),
        }

    def _wall_time(self) -> dict[str, float]:
        """Return the times (s) that the stages of the run took."""
        taken = {
            "preparation": self.preparation,
            "exchanges": self.master.wall_time,
            "recording": self.master.recording_time,
        }
        if self.checkpointing is not None:
            taken["checkpoints"] = self.checkpointing.wall_time
        return taken

    def _all_warnings(self) -> list[str]:
        ended = []
        if self.master.ended_by:
            ended = [f"{self.master.ended_by} has ended the run at t = {self.master.reached:.9g} s"]
        said = self.hearing.warnings(self.master.warned)
        missed = self.course.warnings if self.course else []
        own = self.accounts.warnings + self.master.driver.warnings
        return self.warnings + own + missed + ended + self.texts.cut + said

    def _metrics(self) -> list[Metric]:
        simulated = self.plan.timing.lasts(self.master.exchanges * self.plan.timing.exchange)
        if self.master.ended_by:
            simulated = self.master.reached - self.plan.timing.seconds(0)
        return [
            *(metric for entry in self.watched for metric in self._of_watched(entry)),
            *self.accounts.metrics(),
            Metric("simulated time", simulated, "s"),
            Metric("exchanges", self.master.driver.made(self.master.exchanges)),
            *self.master.driver.metrics(),
            *(
                Metric(f"early returns of {name}", count)
                for name, count in self.master.returned.items()
            ),
            Metric("wall time of the exchanges", self.master.wall_time, "s"),
        ]

    def _of_watched(self, entry: Any) -> Iterator[Metric]:
        """Extremes, their times, and the integral of a watched output."""
        timing = self.plan.timing
        end = self.plan.outputs[entry["place"]]
        unit = end.port.unit_name
        for which, bound in (("maximum", "high"), ("minimum", "low")):
            at = timing.seconds(int(entry[f"{bound}_at"]))
            yield Metric(f"{end.name} {which}", float(entry[bound]), unit)
            yield Metric(f"{end.name} {which} at", at, "s")
        area = float(entry["area"]) * timing.lasts(timing.exchange)
        yield Metric(f"{end.name} integral", area, "s" if unit == "1" else f"{unit}.s")

    def close(self) -> None:
        """End and free all slaves.

        One that has failed beyond repair may not be called any more.
        """
        for name, slave in self.slaves.items():
            self.journal.ends(name)
            if self.initialised and all(status != FATAL for status, _ in slave.messages):
                self._terminate(slave)
        for name, slave in self.slaves.items():
            self.journal.ends(name)
            self.instances.give_back(slave)
        if self.finished:
            warnings = self._all_warnings()
            if warnings != self.results.provenance["warnings"]:
                self.results.amend(warnings=warnings)
            self.journal.close()

    def _terminate(self, slave: Slave) -> None:
        count = sum(counts_of(slave.messages).values())
        status = slave.terminate()
        if not OK <= status <= WARNING and sum(counts_of(slave.messages).values()) == count:
            slave.messages.append((status, f"the end of the run returned {status_name(status)}"))
