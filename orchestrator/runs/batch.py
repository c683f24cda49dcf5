"""Many runs, in parallel over processes.

Each process keeps its FMUs' code compiled from run to run.
"""

import os
import signal
import time
from _thread import interrupt_main
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.process import BaseProcess
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

from ..core.system.system import SystemSpec
from ..temporary import TemporaryFolder
from .building import FmusOf, Note, case_fmus, each_once, silent
from .job import prepare
from .kept import KeptRuns
from .outcome import Outcome
from .request import Request

if TYPE_CHECKING:
    from ..core.errors import RunFailed
    from ..core.results.reading import StoredRun

COMPLETE = "complete"
FAILED = "failed"
INTERRUPTED = "interrupted"

Counted = Callable[[int, int], None]
"""Called with the number of runs that have ended, and of all."""

COLUMNS = (
    "sand.transmitted_force",
    "sand.rock.force.y",
    "sand.penetration",
    "sand.surface_height",
    "sand.surface_level",
    "sand.stable_step",
    "beam.midspan.deflection",
    "beam.energy.elastic",
    "beam.energy.strain_estimate",
    "beam.box.inertia_force",
    "rock.energy.kinetic",
)
"""Variables that are recorded of a run, besides the energy of its interfaces."""

_MODEL = {
    "sand": (
        "modulus",
        "damping",
        "rotation",
        "stiffness_factor",
        "base",
        "base.shape",
        "beam.disc_mass",
        "rolling_resistance",
        "unloading_ratio",
        "cohesion",
        "packing",
        "disc.spread",
        "solid_fraction",
        "density",
        "density_of",
        "lattice_shift",
        "seed",
        "kinematics",
        "forces",
        "internal_step",
    ),
    "beam": ("deck.mass", "box.mass"),
}
"""Parameters of sand and beam that make up the model."""


def uncounted(ended: int, total: int) -> None:
    """Count nothing: the default of every ``counted``."""


@dataclass(frozen=True)
class Task:
    """Run that a study or a calibration needs.

    Tasks with the same content are one run.

    Attributes
    ----------
    request : Request
        Case, and everything that is changed in it.
    model : str
        Name of the set of model options, for the reader.
    seed : int, optional
        Seed of the sample; None if the lattice is undisturbed.
    allow_unstable : bool
        Whether a step may be longer than the stable one.
    columns : tuple of str
        Variables that are recorded.
    """

    request: Request
    model: str = ""
    seed: int | None = None
    allow_unstable: bool = False
    columns: tuple[str, ...] = COLUMNS

    @property
    def settings(self) -> list[str]:
        """Values and sizes of the request that differ from the case, as ``name=value``."""
        changed = {**self.request.values, **self.request.sizes}
        return [f"{name}={value}" for name, value in changed.items()]

    @property
    def key(self) -> str:
        """Case and everything that is changed in it, on one line."""
        options = [f"{name}={value}" for name, value in self.request.options.items()]
        coupling = [f"coupling={self.request.coupling}"] if self.request.coupling else []
        model = [f"model={self.request.model}"] if self.request.model else []
        unstable = ["unstable"] if self.allow_unstable else []
        return " ".join(
            [self.request.target, *model, *self.settings, *coupling, *options, *unstable]
        )


@dataclass(frozen=True)
class _Order:
    """Run as it is sent to a process.

    Attributes
    ----------
    key : str
        Of the task.
    system : System
        With the recorded variables only.
    allow_unstable : bool
        Whether a step may be longer than the stable one.
    design : Any
        What the results are compared with, of a project.
    """

    key: str
    system: SystemSpec
    allow_unstable: bool
    design: Any = None


def run_all(
    tasks: Sequence[Task],
    workers: int | None = None,
    note: Note = silent,
    counted: Counted = uncounted,
    kept: KeptRuns | None = None,
) -> dict[str, Outcome]:
    """Carry out all tasks, each different one once.

    Parameters
    ----------
    tasks : sequence of Task
        Runs. Ctrl-C ends them; those without a result are interrupted.
    workers : int, optional
        Number of processes, by default that of the cores.
    note : callable
        Called with a line for each FMU that is built.
    counted : callable
        Called with the number of runs that have ended, and of all.
    kept : KeptRuns, optional
        Runs that have ended before, which are not carried out again, and to which others are added.

    Returns
    -------
    dict of str to Outcome
        By the key of the task. A run that fails is an outcome too.

    Raises
    ------
    InputRefused
        A task cannot be prepared.
    """
    fmus_of = each_once()
    orders = [_order(task, note, fmus_of) for task in {task.key: task for task in tasks}.values()]
    outcomes = _ended(orders, kept)
    if outcomes:
        note(f"{len(outcomes)} of {len(orders)} runs have ended before, and are not run again")
    waiting = {order.key: order for order in orders if order.key not in outcomes}
    processes = min(workers or os.cpu_count() or 1, max(len(waiting), 1))
    try:
        for outcome in _carry_out(list(waiting.values()), processes):
            outcomes[outcome.key] = outcome
            _keep(kept, waiting[outcome.key], outcome)
            counted(len(outcomes), len(orders))
    except KeyboardInterrupt:
        note("interrupted: what was computed is reported")
    return {
        order.key: outcomes.get(order.key, Outcome(order.key, INTERRUPTED, "not run"))
        for order in orders
    }


def _ended(orders: Sequence[_Order], kept: KeptRuns | None) -> dict[str, Outcome]:
    """Return the outcomes of the runs that have ended before."""
    if kept is None:
        return {}
    found = {
        order.key: kept.find(order.key, order.system, order.allow_unstable) for order in orders
    }
    return {key: outcome for key, outcome in found.items() if outcome is not None}


def run_here(task: Task, note: Note = silent, kept: KeptRuns | None = None) -> Outcome:
    """Carry out one task in this process.

    Parameters
    ----------
    task : Task
        The run.
    note : callable
        Called with a line for each FMU that is built.
    kept : KeptRuns, optional
        Where the run is looked for, and kept when it is complete.

    Returns
    -------
    Outcome
        Also of a run that fails.

    Raises
    ------
    InputRefused
        The task cannot be prepared.
    """
    order = _order(task, note)
    outcome = _ended([order], kept).get(order.key)
    if outcome is None:
        outcome = run_one(order)
        _keep(kept, order, outcome)
    return outcome


def _keep(kept: KeptRuns | None, order: _Order, outcome: Outcome) -> None:
    """Keep the outcome of a run that is complete."""
    if kept and outcome.status == COMPLETE:
        kept.keep(order.system, order.allow_unstable, outcome)


def _order(task: Task, note: Note, fmus_of: FmusOf = case_fmus) -> _Order:
    """Return the system of a task, with the recorded variables only and no states."""
    job = prepare(task.request, note, fmus_of=fmus_of)
    system, design = slim(job.system, task.columns), job.facts.get("design")
    return _Order(task.key, system, task.allow_unstable, design)


def slim(system: SystemSpec, recorded: tuple[str, ...] = COLUMNS) -> SystemSpec:
    """Return a system that records some variables and no states.

    Parameters
    ----------
    system : SystemSpec
        The system.
    recorded : tuple of str
        Variables, of components that it may not have.
    """
    components = {
        name: spec.model_copy(update={"record_states": False})
        for name, spec in system.components.items()
    }
    changes = {
        "components": components,
        "record": [column for column in recorded if column.partition(".")[0] in components],
        "state_interval": None,
    }
    return system.model_copy(update=changes)


def _carry_out(orders: Sequence[_Order], workers: int) -> Iterator[Outcome]:
    """Yield outcomes in the order in which they come.

    An FMU may take its process with it: runs that are lost so are made again, each alone.
    """
    if not orders:
        return
    lost = []
    with _processes(workers) as pool:
        futures = {pool.submit(run_one, order): order for order in orders}
        for future in as_completed(futures):
            if isinstance(future.exception(), BrokenProcessPool):
                lost.append(futures[future])
            else:
                yield future.result()
    for order in lost:
        with _processes(1) as pool:
            yield _alone(pool.submit(run_one, order), order)


def _alone(future: "Future[Outcome]", order: _Order) -> Outcome:
    try:
        return future.result()
    except BrokenProcessPool:
        return Outcome(order.key, FAILED, "the process of the run ended without a result")


@contextmanager
def _processes(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Yield processes that start afresh; left early, runs that have not begun are dropped."""
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_begin_process)
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        _end(active_children())
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _end(children: Sequence[BaseProcess]) -> None:
    """Interrupt the runs of processes, and kill those that do not hear it.

    Only a terminal tells Ctrl-C to all processes. A kernel that prepares a large layer hears
    nothing for minutes.
    """
    for child in children:
        with suppress(OSError):
            os.kill(child.pid or 0, signal.SIGINT)
    last = time.monotonic() + _DEAF
    for child in children:
        child.join(max(last - time.monotonic(), 0.0))
        if child.is_alive():
            child.kill()


def _begin_process() -> None:
    """Ignore Ctrl-C between two runs, and end when the parent does.

    Ctrl-C reaches every process: a run takes it for itself while it goes on, between runs the
    parent. A parent that is killed tells nothing: its end is waited for.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is not None:
        Thread(target=_end_with, args=(parent,), daemon=True).start()


_RUNNING = Event()
"""Whether this process carries out a run."""
_DEAF = 5.0
"""Time (s) after which a process that was interrupted and goes on is killed."""
_LONGEST_END = 20.0
"""Time (s) after which a run that has been interrupted is no longer waited for."""


def _end_with(parent: Any) -> None:
    """Wait for the end of the parent; then interrupt the run, so that it tidies up, and end."""
    parent.join()
    last = time.monotonic() + _LONGEST_END
    while _RUNNING.is_set() and time.monotonic() < last:
        interrupt_main()  # not heard before the run has begun
        time.sleep(0.5)
    os._exit(1)


def run_one(order: _Order) -> Outcome:
    """Carry out one run in the process in which this is called."""
    began = time.perf_counter()
    _RUNNING.set()
    try:
        return _run(order, began)
    finally:
        _RUNNING.clear()


def _run(order: _Order, began: float) -> Outcome:
    from ..core.errors import InputRefused, RunFailed
    from ..core.results.reading import read_run
    from ..core.run import simulate

    with TemporaryFolder("rockshed-") as folder:
        place = folder / "run"
        failure = None
        try:
            facts = {"design": order.design} if order.design else {}
            run = simulate(order.system, place, allow_unstable=order.allow_unstable, facts=facts)
        except RunFailed as reason:
            failure = reason
            run = read_run(place)
        except InputRefused as refusal:
            wall_time = time.perf_counter() - began
            return Outcome(order.key, FAILED, str(refusal), wall_time=wall_time)
        return _outcome(order.key, run, failure, began)


def _outcome(key: str, run: "StoredRun", failure: "RunFailed | None", began: float) -> Outcome:
    components = run.provenance["components"]
    return Outcome(
        key,
        run.status,
        str(failure) if failure else "",
        failure.time if failure else None,
        metrics_of(run) if run.status == COMPLETE else {},
        dict(run.series),
        _options(components),
        {name: str(facts["sha256"]) for name, facts in components.items()},
        time.perf_counter() - began,
    )


def metrics_of(run: "StoredRun") -> dict[str, float]:
    """Return the numbers of a run by the names of the metrics."""
    from ..metrics.headlines import headlines
    from ..metrics.reported import reported

    declared = (entry.metric for entry in reported(run))
    known = [*run.metrics.values(), *headlines(run), *declared]
    return {m.name: float(m.value) for m in known if not isinstance(m.value, str)}


def _options(components: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of :data:`_MODEL` that a run has; the sand's without its name."""
    return {
        name if owner == "sand" else f"{owner}.{name}": components[owner]["parameters"][name][
            "value"
        ]
        for owner, names in _MODEL.items()
        if owner in components
        for name in names
        if name in components[owner]["parameters"]
    }
