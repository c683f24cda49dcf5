"""Runs of studies, in parallel over processes. Each process keeps its FMUs' code compiled from run to run."""

import os
import signal
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..core.system.system import System
from .building import Note
from .job import prepare
from .request import Request

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ..core.results.reading import Run

COMPLETE, FAILED, INTERRUPTED = "complete", "failed", "interrupted"


@dataclass(frozen=True)
class Task:
    """A run that a study needs. Studies share runs: two tasks with the same content are carried out once.

    model: name of the set of model options, for the reader.
    seed: that of the random lattice shift; None if the lattice is undisturbed.
    """

    request: Request
    model: str = ""
    seed: int | None = None
    allow_unstable: bool = False

    @property
    def settings(self) -> list[str]:
        """Values of the request that differ from the case, as ``name=value``."""
        return [f"{name}={value}" for name, value in self.request.values.items()]

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
class Outcome:
    """What a run gave. A run that failed has the rows until then, and no figures.

    figures: summary and headlines (SI) by name. series: columns of the results by name. fmus: SHA-256 by component.
    options: parameters of sand and beam that make up the model. failed_at: time (s) of a failure in the run.
    """

    key: str
    status: str
    error: str = ""
    failed_at: float | None = None
    figures: Mapping[str, float] = field(default_factory=dict)
    series: "Mapping[str, NDArray[np.float64]]" = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    fmus: Mapping[str, str] = field(default_factory=dict)
    wall_time: float = 0.0


Done = Callable[[int, int], None]
"""Told the number of runs that have ended, and of all."""

COLUMNS = (
    "sand.transmitted_force",
    "sand.rock.force.y",
    "sand.penetration",
    "sand.surface_height",
    "sand.stable_step",
    "beam.midspan.deflection",
    "beam.energy.elastic",
    "beam.energy.strain_estimate",
    "rock.energy.kinetic",
)
"""What is recorded of a run, besides the energy of its interfaces."""
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
        "unit_weight",
        "unit_weight_of",
        "lattice_shift",
        "seed",
        "kinematics",
        "forces",
        "internal_step",
    ),
    "beam": ("deck.mass", "box.mass"),
}
"""Parameters of sand and beam that say which model was computed."""


@dataclass(frozen=True)
class _Order:
    """A run as it is sent to a process."""

    key: str
    system: System
    allow_unstable: bool


def run_all(
    tasks: Sequence[Task], workers: int | None, note: Note, done: Done
) -> dict[str, Outcome]:
    """Carry out all tasks, each different one once; outcomes by key. A run that fails is an outcome too.

    workers: number of processes, by default that of the cores. Ctrl-C ends the runs; those without a result are "interrupted".

    Raises:
        InputRefused: a task that cannot be prepared.
    """
    orders = [_order(task, note) for task in {task.key: task for task in tasks}.values()]
    found: dict[str, Outcome] = {}
    try:
        for outcome in _carry_out(orders, min(workers or os.cpu_count() or 1, max(len(orders), 1))):
            found[outcome.key] = outcome
            done(len(found), len(orders))
    except KeyboardInterrupt:
        note("interrupted: what was computed is reported")
    return {
        order.key: found.get(order.key, Outcome(order.key, INTERRUPTED, "not run"))
        for order in orders
    }


def run_here(task: Task, note: Note = lambda text: None) -> Outcome:
    """Carry out one task in this process.

    Raises:
        InputRefused: a task that cannot be prepared.
    """
    return run_one(_order(task, note))


def _order(task: Task, note: Note) -> _Order:
    """The system of a task with a short output and no states."""
    system = prepare(task.request, note).system
    parts = {
        name: spec.model_copy(update={"record_states": False})
        for name, spec in system.components.items()
    }
    short = {
        "components": parts,
        "record": [c for c in COLUMNS if c.partition(".")[0] in parts],
        "state_interval": None,
    }
    return _Order(task.key, system.model_copy(update=short), task.allow_unstable)


def _carry_out(orders: Sequence[_Order], workers: int) -> Iterator[Outcome]:
    """Outcomes in the order in which they come. An FMU may take its process with it: what is lost so is run again, alone."""
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
    """Processes that start afresh; left early, runs that have not begun are dropped."""
    pool = ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_leave_interrupts_to_the_run
    )
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def _leave_interrupts_to_the_run() -> None:
    """Ctrl-C reaches every process: a run takes it for itself while it goes on, between two runs the parent does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def run_one(order: _Order) -> Outcome:
    """One run, in the process in which this is called."""
    from ..core.errors import InputRefused, RunFailed
    from ..core.results.reading import read_run
    from ..core.run import simulate

    began = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="rockshed-") as folder:
        place = Path(folder) / "run"
        try:
            run, error, at = (
                simulate(order.system, place, allow_unstable=order.allow_unstable),
                "",
                None,
            )
        except RunFailed as failure:
            run, error, at = read_run(place), str(failure), failure.time
        except InputRefused as refusal:
            return Outcome(order.key, FAILED, str(refusal), wall_time=time.perf_counter() - began)
        return _outcome(order.key, run, error, at, began)


def _outcome(key: str, run: "Run", error: str, failed_at: float | None, began: float) -> Outcome:
    from ..metrics.headlines import headlines

    complete = run.status == COMPLETE
    figures = (
        {
            f.name: float(f.value)
            for f in [*run.metrics.values(), *headlines(run)]
            if not isinstance(f.value, str)
        }
        if complete
        else {}
    )
    components = run.provenance["components"]
    return Outcome(
        key,
        run.status,
        error,
        failed_at,
        figures,
        dict(run.series),
        _options(components),
        {name: str(facts["sha256"]) for name, facts in components.items()},
        time.perf_counter() - began,
    )


def _options(components: Mapping[str, Any]) -> dict[str, Any]:
    """What of :data:`_MODEL` a run has; parameters of the sand without its name."""
    return {
        name if owner == "sand" else f"{owner}.{name}": components[owner]["parameters"][name][
            "value"
        ]
        for owner, names in _MODEL.items()
        if owner in components
        for name in names
        if name in components[owner]["parameters"]
    }
