"""Many runs, in parallel over processes.

Each process keeps its FMUs' code compiled from run to run.
"""

import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..core.errors import InputRefused, Problem, RunFailed
from ..core.system.fields import Value
from ..core.system.names import split_name
from ..core.system.system import SystemSpec
from .building import FmusOf, Note, case_fmus, each_once, silent
from .executors import Crew, Lost, at_end, number_of_workers, processes, running
from .job import prepare
from .kept import KeptRuns
from .outcome import Outcome, digests_of
from .request import Request

if TYPE_CHECKING:
    from ..core.loop.instances import KeptInstances
    from ..core.results.metric import Metric
    from ..core.results.reading import StoredRun
    from ..core.variants import Stem

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
class BranchPoint:
    """Where variants of a run branch off.

    Attributes
    ----------
    run : str
        Folder of the run, absolute.
    at : float
        Time (s) from which on a variant has other values.
    """

    run: str
    at: float


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
    columns : tuple of str, optional
        Variables that are recorded, and are in the outcome; with None those of the system are
        recorded, and the outcome has metrics only.
    label : str
        Names the run in messages.
    branch : BranchPoint, optional
        Where it branches off a run, with the values of the request from then on. The request then
        says what was run, as far as it is known.
    """

    request: Request
    model: str = ""
    seed: int | None = None
    allow_unstable: bool = False
    columns: tuple[str, ...] | None = COLUMNS
    label: str = ""
    branch: BranchPoint | None = None

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
    facts : mapping of str to Any
        For the provenance of the run, whose metrics may depend on them.
    with_series : bool
        Whether the outcome has the recorded columns.
    label : str
        Names the run in messages.
    variant : _Variant, optional
        Of a run that branches off another one on its way.
    """

    key: str
    system: SystemSpec
    allow_unstable: bool
    facts: Mapping[str, Any] = field(default_factory=dict)
    with_series: bool = True
    label: str = ""
    variant: "_Variant | None" = None

    @property
    def about(self) -> dict[str, Any]:
        """Everything besides the system from which the outcome follows."""
        variant = asdict(self.variant) if self.variant else None
        return {
            "design": self.facts.get("design"),
            "series": self.with_series,
            "variant": variant,
        }


@dataclass(frozen=True)
class _Variant:
    """Values that a run has from a time on, when it branches off another one.

    Attributes
    ----------
    point : BranchPoint
        Where it branches off.
    state : str
        SHA-256 of what describes the other run and of its checkpoint, by which it is known.
    values : mapping of str to Value
        By ``component.variable``.
    """

    point: BranchPoint
    state: str
    values: Mapping[str, Value]


Opening = Callable[[int], AbstractContextManager[Crew]]
"""Opens an executor for at most so many runs at a time."""


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
    orders = orders_of(tasks, note)

    def opening(most: int) -> AbstractContextManager[Crew]:
        return processes(min(number_of_workers(workers), most))

    return carry_out(orders, opening, note, counted, kept)


def orders_of(tasks: Sequence[Task], note: Note = silent) -> list[_Order]:
    """Prepare all tasks, each different one once.

    Parameters
    ----------
    tasks : sequence of Task
        Runs.
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    list of order
        For :func:`carry_out`.

    Raises
    ------
    InputRefused
        Tasks that cannot be prepared, with the reasons of all of them.
    """
    fmus_of = each_once()
    parent_of = lru_cache(_parent)
    orders = []
    refused: list[tuple[str, Problem]] = []
    for task in {task.key: task for task in tasks}.values():
        try:
            if task.branch is not None:
                orders.append(_order_of_variant(task, *parent_of(task.branch)))
            else:
                orders.append(_order(task, note, fmus_of))
        except InputRefused as refusal:
            refused += [(task.label, problem) for problem in refusal.problems]
    if refused:
        raise InputRefused(_fewer(_labelled(refused)))
    return orders


_MOST_PROBLEMS = 12
"""Problems of a batch that are told; a bad value is in many of its runs."""


def _labelled(refused: Sequence[tuple[str, Problem]]) -> list[Problem]:
    """Return problems with the names of their runs; one that several have is told once."""
    labels: dict[Problem, list[str]] = {}
    for label, problem in refused:
        labels.setdefault(problem, []).append(label)
    found = []
    for problem, runs in labels.items():
        others = f" and {len(runs) - 1} other runs" if len(runs) > 1 else ""
        before = f"{runs[0]}{others}: " if runs[0] else ""
        found.append(Problem(f"{before}{problem.where}", problem.what, problem.remedy))
    return found


def _fewer(problems: Sequence[Problem]) -> list[Problem]:
    """Return the first problems, and the number of the others."""
    found = list(problems[:_MOST_PROBLEMS])
    if rest := len(problems) - len(found):
        found.append(Problem("other runs", f"have {rest} more problems", "correct these first"))
    return found


def carry_out(
    orders: Sequence[_Order],
    opening: Opening,
    note: Note = silent,
    counted: Counted = uncounted,
    kept: KeptRuns | None = None,
    check_first: bool = False,
) -> dict[str, Outcome]:
    """Carry out prepared runs.

    Parameters
    ----------
    orders : sequence of order
        As :func:`orders_of` makes them. Ctrl-C ends them; those without a result are interrupted.
    opening : callable
        Opens the executor; it is not called if there is nothing to do.
    note : callable
        Called with a line on runs that have ended before.
    counted : callable
        Called with the number of runs that have ended, and of all.
    kept : KeptRuns, optional
        Runs that have ended before, which are not carried out again, and to which others are added.
    check_first : bool
        Whether the FMUs are asked about the values of all runs before the first one begins.

    Returns
    -------
    dict of str to Outcome
        By the key of the task. A run that fails is an outcome too.

    Raises
    ------
    InputRefused
        With ``check_first``, values that FMUs refuse.
    """
    outcomes = _ended(orders, kept)
    if outcomes:
        note(f"{len(outcomes)} of {len(orders)} runs have ended before, and are not run again")
    waiting = [order for order in orders if order.key not in outcomes]
    by_key = {order.key: order for order in waiting}
    tell = _once(note)
    try:
        counted(len(outcomes), len(orders))
        for outcome in _carry_out(waiting, opening, check_first):
            outcomes[outcome.key] = outcome
            _keep(kept, by_key[outcome.key], outcome, tell)
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
        order.key: kept.find(order.key, order.system, order.allow_unstable, order.about)
        for order in orders
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
        _keep(kept, order, outcome, note)
    return outcome


def _keep(kept: KeptRuns | None, order: _Order, outcome: Outcome, note: Note) -> None:
    """Keep the outcome of a run that is complete."""
    if kept and outcome.status == COMPLETE:
        kept.keep_or_tell(order.system, order.allow_unstable, outcome, note, order.about)


def _once(note: Note) -> Note:
    """Return a function that passes each text on once."""
    said: set[str] = set()

    def tell(text: str) -> None:
        if text not in said:
            said.add(text)
            note(text)

    return tell


def _order(task: Task, note: Note, fmus_of: FmusOf = case_fmus) -> _Order:
    """Return the system of a task, with the recorded variables only and no states."""
    job = prepare(task.request, note, fmus_of=fmus_of)
    return _Order(
        task.key,
        slim(job.system, task.columns),
        task.allow_unstable,
        job.facts,
        task.columns is not None,
        task.label,
    )


def _parent(point: BranchPoint) -> tuple[SystemSpec, str]:
    """Return the system of the run that variants branch off, and what its state is known by."""
    from ..core.results.reading import read_run
    from ..core.variants import digest_of_state, system_of

    parent = read_run(Path(point.run))
    return system_of(parent), digest_of_state(parent, point.at)


def _order_of_variant(task: Task, system: SystemSpec, state: str) -> _Order:
    """Return the system of a run that branches off another one, and its values from then on."""
    assert task.branch is not None
    return _Order(
        task.key,
        slim(system, task.columns),
        task.allow_unstable,
        with_series=task.columns is not None,
        label=task.label,
        variant=_Variant(task.branch, state, task.request.values),
    )


def slim(system: SystemSpec, recorded: tuple[str, ...] | None = COLUMNS) -> SystemSpec:
    """Return a system that records some variables and no states.

    Parameters
    ----------
    system : SystemSpec
        The system.
    recorded : tuple of str, optional
        Variables, of components that it may not have; with None those that it records itself.
    """
    components = {
        name: spec.model_copy(update={"record_states": False})
        for name, spec in system.components.items()
    }
    changes: dict[str, Any] = {"components": components, "state_interval": None}
    if recorded is not None:
        known = [column for column in recorded if split_name(column, components)[0] in components]
        changes["record"] = known
    return system.model_copy(update=changes)


def _carry_out(
    orders: Sequence[_Order], opening: Opening, check_first: bool = False
) -> Iterator[Outcome]:
    """Yield outcomes in the order in which they come.

    An FMU may take its process with it: a run that is lost so is made again, once.
    """
    if not orders:
        return
    with opening(len(orders)) as executor:
        if check_first:
            _refuse(orders, executor)
        for number, outcome in executor.each(run_one, orders):
            key = orders[number].key
            yield _lost(key) if isinstance(outcome, Lost) else outcome


def _lost(key: str) -> Outcome:
    return Outcome(key, FAILED, "the process of the run ended without a result")


def _refuse(orders: Sequence[_Order], executor: Crew) -> None:
    """Refuse runs whose values the FMUs refuse by their descriptions."""
    found = dict(executor.each(check_one, orders))
    refused = [
        (order.label, problem)
        for number, order in enumerate(orders)
        if not isinstance(found[number], Lost)
        for problem in found[number]
    ]
    if refused:
        raise InputRefused(_fewer(_labelled(refused)))


# --- in a process ---

_of_thread = threading.local()
"""Instances of FMUs, and the run up to its branching, that the runs of a thread use one after the
other."""


def _instances() -> "KeptInstances":
    """Return the instances of this thread."""
    from ..core.loop.instances import KeptInstances

    found: KeptInstances | None = getattr(_of_thread, "instances", None)
    if found is None:
        found = _of_thread.instances = KeptInstances()
        at_end(found.close)
    return found


def check_one(order: _Order) -> list[Problem]:
    """Return what the FMUs of a run have against its values, by their descriptions.

    Parameters
    ----------
    order : order
        Of :func:`orders_of`.
    """
    from ..core.run import plan_of
    from ..core.variants import refuse_values

    try:
        if order.variant is None:
            plan_of(order.system, _instances())
        else:
            with running():
                refuse_values(_stem(order, order.variant), order.variant.values)
    except InputRefused as refusal:
        return refusal.problems
    except RunFailed as failure:
        what = f"the run does not come to the time of its branching: {failure}"
        return [Problem("at", what, "see the run itself, or branch at an earlier time")]
    return []


def _stem(order: _Order, variant: _Variant) -> "Stem":
    """Return the run up to the time at which a variant branches off; it is run there once."""
    from ..core.results.reading import read_run
    from ..core.variants import grow_stem

    key = (variant.point, variant.state)
    known, found = getattr(_of_thread, "stem", (None, None))
    if found is None or known != key:
        parent = read_run(Path(variant.point.run))
        found = grow_stem(parent, variant.point.at, order.system, _instances())
        _of_thread.stem = (key, found)
    return found


def run_one(order: _Order) -> Outcome:
    """Carry out one run in the thread in which this is called.

    Parameters
    ----------
    order : order
        Of :func:`orders_of`.

    Returns
    -------
    Outcome
        Also of a run that fails.
    """
    began = time.perf_counter()
    with running():
        try:
            return _outcome(order, _run(order), began)
        except InputRefused as refusal:
            reason = "; ".join(map(str, refusal.problems))
        except RunFailed as failure:  # before the variant branches off
            reason = str(failure)
        except KeyboardInterrupt:
            return Outcome(order.key, INTERRUPTED, "not run")
        except (OSError, MemoryError, RuntimeError, ArithmeticError) as error:
            reason = f"{type(error).__name__}: {error}"
        return Outcome(order.key, FAILED, reason, wall_time=time.perf_counter() - began)


def _run(order: _Order) -> "StoredRun":
    """Carry out one run in memory."""
    from ..core.run import simulate_in_memory
    from ..core.variants import run_variant

    if order.variant is not None:
        return run_variant(_stem(order, order.variant), order.variant.values, _instances())
    return simulate_in_memory(
        order.system, _instances(), allow_unstable=order.allow_unstable, facts=order.facts
    )


def _outcome(order: _Order, run: "StoredRun", began: float) -> Outcome:
    from ..metrics.comparison import warnings

    components = run.provenance["components"]
    failed = run.status == FAILED
    found = {} if failed else {metric.name: metric for metric in _numbers(run)}
    complete = found if run.status == COMPLETE else {}
    return Outcome(
        order.key,
        run.status,
        str(run.error) if failed else "",
        run.provenance.get("failed_at"),
        {name: float(metric.value) for name, metric in complete.items()},
        dict(run.series) if order.with_series else {},
        _options(components),
        digests_of(run),
        time.perf_counter() - began,
        {name: metric.unit for name, metric in complete.items()},
        tuple(warnings(run)) if complete and not order.with_series else (),
    )


def _numbers(run: "StoredRun") -> "list[Metric]":
    """Return all metrics of a run that are numbers."""
    from ..metrics.headlines import headlines

    known = [*run.metrics.values(), *headlines(run)]
    return [metric for metric in known if not isinstance(metric.value, str)]


def metrics_of(run: "StoredRun") -> dict[str, float]:
    """Return the numbers of a run by the names of the metrics."""
    return {metric.name: float(metric.value) for metric in _numbers(run)}


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
