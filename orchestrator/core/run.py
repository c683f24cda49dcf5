"""Run a system from its data to its results: the one function that an application needs."""

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from .errors import RunFailed
from .fmu.fmu_slave import FmuFile
from .fmu.slave import FATAL, Slave, Source
from .loop.buses import Buses
from .loop.initialisation import free, initialise, instantiate
from .loop.journal import Journal
from .loop.ledger import Accounts
from .loop.master import Interruption, Master, Progress
from .loop.recording import Recorder
from .results.metric import Metric
from .results.provenance import describe_run
from .results.reading import StoredRun, read_run
from .results.run_folder import RunFolder
from .system.clock import to_seconds
from .system.plan import Plan
from .system.planning import make_plan
from .system.system import SystemSpec


def sources_of(system: SystemSpec) -> dict[str, Source]:
    """Return the FMU files of a system by component."""
    return {name: FmuFile(Path(spec.fmu)) for name, spec in system.components.items()}


def simulate(
    system: SystemSpec,
    folder: Path,
    *,
    sources: Mapping[str, Source] | None = None,
    allow_unstable: bool = False,
    progress: Progress | None = None,
    facts: Mapping[str, Any] | None = None,
) -> StoredRun:
    """Run a system and write its results into a folder.

    Ctrl-C ends the run and keeps what was computed. Everything happens in the calling process:
    code of an FMU that crashes takes it along (the command ``rockshed run`` does not die of it).

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
    progress : callable, optional
        Called now and then with the time reached and the stop time (s).
    facts : mapping, optional
        Added to the provenance of the run.

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
    plan = make_plan(system, made_from)
    with Interruption() as interruption, RunFolder(folder) as results:
        session = _Session(plan, made_from, results)
        try:
            session.prepare(allow_unstable, dict(facts or {}))
            session.run(interruption, progress)
        finally:
            session.close()
    return read_run(folder)


@dataclass
class _Session:
    """The slaves of one run and everything around them."""

    plan: Plan
    sources: Mapping[str, Source]
    results: RunFolder
    slaves: dict[str, Slave] = field(default_factory=dict)
    initialised: bool = False

    def prepare(self, allow_unstable: bool, facts: dict[str, Any]) -> None:
        """Make and initialise the slaves, then open the results."""
        began = time.perf_counter()
        plan = self.plan
        self.journal = Journal(self.results.running, plan.order)
        self.slaves = instantiate(plan, self.sources, self.journal.prepares)
        buses = Buses(plan, self.journal.entries)
        initial = initialise(self.slaves, buses, allow_unstable, self.journal.prepares)
        self.warnings = [*plan.warnings, *initial]
        self.initialised = True
        self.accounts = Accounts(self.slaves, buses)
        recorder = Recorder(self.slaves, buses.snapshots, self.accounts, self.results)
        self.watched = buses.watched
        self.master = Master(self.slaves, buses, recorder)
        self.journal.legend(buses.operations, plan.timing.start, plan.schedule)
        self.preparation = time.perf_counter() - began
        known = describe_run(plan, self.sources, self.slaves)
        self.results.begin(recorder.columns, {**known, **facts})

    def run(self, interruption: Interruption, progress: Progress | None) -> None:
        """Carry out the exchanges and finish the results, also those of a run that fails."""
        failure: RunFailed | None = None
        try:
            status = "complete" if self.master.run(interruption, progress) else "interrupted"
        except RunFailed as error:
            status = "failed"
            failure = error
        self.journal.close()
        self.results.finish(
            status,
            self._metrics(),
            error=str(failure) if failure else None,
            ended=datetime.now(UTC).isoformat(),
            warnings=self.warnings + self.accounts.warnings,
            wall_time={
                "preparation": self.preparation,
                "exchanges": self.master.wall_time,
                "recording": self.master.recording_time,
            },
            cpu_time={"exchanges": self.master.cpu_time},
        )
        if failure is not None:
            raise failure

    def _metrics(self) -> list[Metric]:
        simulated = to_seconds(self.master.exchanges * self.plan.timing.exchange)
        return [
            *(metric for entry in self.watched for metric in self._of_watched(entry)),
            *self.accounts.metrics(),
            Metric("simulated time", simulated, "s"),
            Metric("exchanges", self.master.exchanges),
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
        area = float(entry["area"]) * to_seconds(timing.exchange)
        yield Metric(f"{end.name} integral", area, "s" if unit == "1" else f"{unit}.s")

    def close(self) -> None:
        """End and free all slaves.

        One that has failed beyond repair may not be called any more.
        """
        for slave in self.slaves.values():
            if self.initialised and all(status != FATAL for status, _ in slave.messages):
                slave.terminate()
        free(self.slaves.values())
