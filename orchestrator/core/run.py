"""Run a system from its data to its results: the one function that an application needs."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from .errors import RunFailed
from .fmu.fmu_slave import FmuFile
from .fmu.slave import FATAL, Slave, Source
from .loop.exchange import State, make_driver
from .loop.initialisation import free, initialise, instantiate
from .loop.journal import Journal
from .loop.ledger import Accounts
from .loop.master import Interruption, Master, Progress
from .loop.recording import Recorder
from .results.metric import Metric
from .results.provenance import describe_run
from .results.reading import Run, read_run
from .results.run_folder import RunFolder
from .system.clock import to_seconds
from .system.plan import Plan, make_plan
from .system.system import System


def sources_of(system: System) -> dict[str, Source]:
    """The FMU files of a system."""
    return {name: FmuFile(Path(spec.fmu)) for name, spec in system.components.items()}


def simulate(
    system: System,
    folder: Path,
    *,
    sources: Mapping[str, Source] | None = None,
    allow_unstable: bool = False,
    plain: bool = False,
    progress: Progress | None = None,
    facts: Mapping[str, Any] | None = None,
) -> Run:
    """Run a system and write its results into ``folder``. Ctrl-C ends the run and keeps what was computed.

    sources: what to make components from instead of their FMU files.
    plain: call the slaves one by one from Python instead of in the compiled loop.
    facts: added to the run's provenance.

    Raises:
        InputRefused: the system, the FMUs' answer to it, or the folder; nothing is left behind.
        RunFailed: the run began and could not go on; the results until then are in the folder.
    """
    made_from = {**sources_of(system), **(sources or {})}
    plan = make_plan(system, made_from)
    with Interruption() as interruption, RunFolder(folder) as results:
        session = _Session(plan, made_from, results, plain)
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
    plain: bool
    slaves: dict[str, Slave] = field(default_factory=dict)
    initialised: bool = False

    def prepare(self, allow_unstable: bool, facts: dict[str, Any]) -> None:
        """Make and initialise the slaves, then open the results."""
        began = time.perf_counter()
        self.journal = Journal(self.results.running, self.plan.order)
        self.slaves = instantiate(self.plan, self.sources, self.journal.prepares)
        state = State(self.plan, self.journal.entries)
        self.warnings = [
            *facts.get("warnings", ()),
            *self.plan.warnings,
            *initialise(self.plan, self.slaves, state, allow_unstable, self.journal.prepares),
        ]
        self.initialised = True
        self.accounts = Accounts(self.plan, self.slaves, state)
        recorder = Recorder(self.plan, self.slaves, state.snapshots, self.accounts, self.results)
        self.watched = state.watched
        self.master = Master(
            self.plan, self.slaves, state, make_driver(state, self.slaves, self.plain), recorder
        )
        self.journal.legend(
            state.operations,
            self.plan.timing.start,
            self.plan.timing.exchange,
            self.plan.schedule.period,
        )
        self.preparation = time.perf_counter() - began
        self.results.begin(
            recorder.columns, {**describe_run(self.plan, self.sources, self.slaves), **facts}
        )

    def run(self, interruption: Interruption, progress: Progress | None) -> None:
        """Carry out the exchanges and finish the results, also those of a run that fails."""
        failure: RunFailed | None = None
        try:
            status = "complete" if self.master.run(interruption, progress) else "interrupted"
        except RunFailed as error:
            status, failure = "failed", error
        self.journal.close()
        self.results.finish(
            status,
            self._figures(),
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

    def _figures(self) -> list[Metric]:
        timing, figures = self.plan.timing, list[Metric]()
        for entry in self.watched:
            end = self.plan.outputs[entry["place"]]
            for which, bound in (("maximum", "high"), ("minimum", "low")):
                figures += [
                    Metric(f"{end.name} {which}", float(entry[bound]), end.port.unit_name),
                    Metric(
                        f"{end.name} {which} at", timing.seconds(int(entry[bound + "_at"])), "s"
                    ),
                ]
            figures.append(
                Metric(
                    f"{end.name} integral",
                    float(entry["area"]) * to_seconds(timing.exchange),
                    "s" if end.port.unit_name == "1" else f"{end.port.unit_name}.s",
                )
            )
        simulated = to_seconds(self.master.exchanges * timing.exchange)
        return [
            *figures,
            *self.accounts.figures(),
            Metric("simulated time", simulated, "s"),
            Metric("exchanges", self.master.exchanges),
            Metric("wall time of the exchanges", self.master.wall_time, "s"),
        ]

    def close(self) -> None:
        """End and free all slaves; one that has failed beyond repair may not be called any more."""
        for slave in self.slaves.values():
            if self.initialised and all(status != FATAL for status, _ in slave.messages):
                slave.terminate()
        free(self.slaves.values())
