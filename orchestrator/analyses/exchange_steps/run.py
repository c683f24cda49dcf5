"""Run a system with finer and finer exchange steps, and find the order of its convergence."""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...core.errors import InputRefused, Problem, RunFailed
from ...core.run import starting_problems
from ...core.system.fields import Value
from ...core.system.names import nearest
from ...runs.batch import COMPLETE
from ...runs.building import Note, silent
from ...runs.job import recorded_names
from ...runs.kept import FINISHED, KeptRuns
from ...runs.outcome import Outcome
from ...runs.request import Request, plain
from ...runs.simulation import simulate
from ...runs.system import System
from ..asked import remembering
from ..frame import StageProgress, counter, no_progress
from .figures import Level, figures, level_of, outcome_of, told_first
from .ladder import ladder
from .orders import FEWEST
from .result import ExchangeStepsResult

MOST_LEVELS = 12
"""Steps that are taken at most; the last one takes as many exchanges as all others together."""
_KEPT = "exchange steps"
"""Tells outcomes that are kept here from those of other analyses."""
ExchangeTarget = str | Path | Mapping[str, Any] | System
"""A case, a project, system file or SSP, the content of a project, or a system."""


def converge_exchange(
    target: ExchangeTarget,
    *,
    levels: int = 4,
    accuracy: float = 0.01,
    watch: Sequence[str] = (),
    metrics: Sequence[str] = (),
    values: Mapping[str, Value] | None = None,
    options: Mapping[str, Any] | None = None,
    coupling: str | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
    note: Note = silent,
) -> ExchangeStepsResult:
    """Run a system with the exchange step h, h/2, h/4, ..., and find the order of convergence.

    Steps of components that divide the exchange step stay as they are, longer ones are halved with
    it. The runs are made one after the other in this process.

    Parameters
    ----------
    target : str, path, mapping or System
        A case, a project, system file or SSP, the content of a project, or a system.
    levels : int
        Number of steps, three at least; four confirm an order.
    accuracy : float
        Error for which a step is recommended, as a part of a figure's size.
    watch : sequence of str
        Variables, ``component.port``, whose largest difference over time and last value are
        followed.
    metrics : sequence of str
        Identifiers of the metrics that are followed; by default, unless variables are watched,
        what a designer asks for first, or of another system the first metrics that vary.
    values : mapping of str to Value, optional
        Other values of the system.
    options : mapping, optional
        Keys of the system: ``exchange_step`` (the coarsest one), ``stop_time``, ...
    coupling : str, optional
        Scheme of exchange of a case, by default its first.
    folder : path, optional
        Where the results are saved; other files stay there. Runs that have ended are kept there
        until all have, if their components are FMU files: a study that was killed or interrupted
        goes on.
    pictures : bool
        Whether the figure is drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    ExchangeStepsResult
        Orders, errors, recommended step, tables and figure.

    Raises
    ------
    InputRefused
        Everything that is wrong with the arguments, and steps that a component refuses; no run was
        begun.
    RunFailed
        A run could not go on; the message names its step.

    Examples
    --------
    >>> import rockshed
    >>> fall = rockshed.System.new("fall", exchange_step=0.02, stop_time=0.1).add(
    ...     "rock", "FallingRock"
    ... )
    >>> rockshed.converge_exchange(fall, watch=["rock.position.y"])
    <ExchangeStepsResult fall: 4 steps, 0 figures with an order, 2 independent of the step>
    """
    files = _files(target)
    asked = {
        "target": files[0] if files else target,
        "levels": levels,
        "accuracy": accuracy,
        "watch": list(watch),
        "metrics": list(metrics),
        "values": values,
        "options": options,
        "coupling": coupling,
        "pictures": pictures,
    }
    place = Path(folder) / FINISHED if folder else None
    with remembering(place, ExchangeStepsResult.kind, asked, files):
        problems = _problems(levels, accuracy)
        found = _system(target, values or {}, options or {}, coupling, problems, note)
        found[0].refuse_empty()
        kept = KeptRuns(place) if place else None
        wanted = (levels, accuracy, watch, metrics)
        made = _carried_out(found, wanted, problems, kept, progress or no_progress, note)
        if folder:
            made.save(folder, pictures=pictures, progress=progress or no_progress)
        if kept is not None:
            kept.clear()
        return made


def _files(target: ExchangeTarget) -> list[Path]:
    """Return the file of a target, absolute; nothing of a case."""
    if isinstance(target, str | Path) and Request(str(target)).is_file:
        return [Path(target).absolute()]
    return []


def _carried_out(
    found: tuple[System, dict[str, Any]],
    wanted: tuple[int, float, Sequence[str], Sequence[str]],
    problems: list[Problem],
    kept: KeptRuns | None,
    progress: StageProgress,
    note: Note,
) -> ExchangeStepsResult:
    """Run a system, of some origin, with all steps, and find the orders."""
    system, origin = found
    levels, accuracy, watch, metrics = wanted
    watched = tuple(dict.fromkeys(watch))
    steps = ladder(system, levels, watched) if levels >= FEWEST else [system]
    _refuse(steps, watched, problems)
    runs = list(_levels(steps, watched, kept, progress, note))
    _refuse_unknown(metrics, runs)
    names = list(metrics) or ([] if watched else told_first(runs))
    followed = figures(runs, watched, names)
    return ExchangeStepsResult(system.name, runs, followed, accuracy, origin)


def _system(
    target: ExchangeTarget,
    values: Mapping[str, Value],
    options: Mapping[str, Any],
    coupling: str | None,
    problems: Sequence[Problem],
    note: Note,
) -> tuple[System, dict[str, Any]]:
    """Return the system that is run, and what it is of."""
    if isinstance(target, System):
        changed = target.with_values(values) if values else target
        system = changed.with_options(**options) if options else changed
    else:
        content = target if isinstance(target, Mapping) else None
        request = Request(
            str(target) if content is None else "project",
            plain(values),
            coupling=coupling,
            options=plain(options),
            project=content,
        )
        try:
            system = System.prepared(request, note)
        except InputRefused as refusal:
            raise InputRefused([*problems, *refusal.problems]) from None
    facts = system.job.facts
    keys = ("case", "project_file", "system_file")
    return system, {key: facts[key] for key in keys if key in facts}


def _problems(levels: int, accuracy: float) -> list[Problem]:
    """Return what is wrong with numbers of a ladder."""
    problems = []
    if not FEWEST <= levels <= MOST_LEVELS:
        what = f"{levels} is not in the range from {FEWEST} to {MOST_LEVELS}"
        remedy = "three steps give one order, and four confirm it"
        problems.append(Problem("levels", what, remedy))
    if not 0.0 < accuracy < 1.0:
        what = f"{accuracy:g} is no part of a figure between 0 and 1"
        problems.append(Problem("accuracy", what, "1 % is 0.01"))
    return problems


def _refuse(steps: Sequence[System], watch: Sequence[str], problems: list[Problem]) -> None:
    """Refuse arguments, variables that are not there, and steps that do not fit or are refused.

    Components are initialised with each step before the first run begins.
    """
    first = steps[0]
    plain_spec = first.spec.model_copy(update={"record": ["*"]})
    try:
        known = recorded_names(replace(first.job, system=plain_spec))
    except InputRefused as refusal:
        raise InputRefused([*problems, *refusal.problems]) from None
    problems += [
        Problem(f"watch {name}", "is no output that is a number", nearest(name, known))
        for name in watch
        if name not in known
    ]
    if problems:
        raise InputRefused(problems)
    told: dict[Problem, float] = {}
    for step in steps:
        for problem in starting_problems(step.spec, step.job.sources):
            told.setdefault(problem, step.spec.exchange_step)
    if told:
        raise InputRefused(
            [
                Problem(f"with an exchange step of {step:.6g} s: {p.where}", p.what, p.remedy)
                for p, step in told.items()
            ]
        )


def _levels(
    steps: Sequence[System],
    watch: Sequence[str],
    kept: KeptRuns | None,
    progress: StageProgress,
    note: Note,
) -> Iterator[Level]:
    """Carry out the runs that are not kept, and yield the level of each."""
    count = counter(progress, "exchange steps")
    count(0, len(steps))
    for number, step in enumerate(steps, 1):
        outcome = kept.find("", step.spec, False, _KEPT) if kept else None
        if outcome is None:
            outcome = _outcome(step, watch)
            if kept:
                kept.keep_or_tell(step.spec, False, outcome, note, _KEPT)
        own = {name: part.step for name, part in step.spec.components.items() if part.step}
        yield level_of(outcome, {"": step.spec.exchange_step, **own})
        count(number, len(steps))


def _outcome(step: System, watch: Sequence[str]) -> Outcome:
    """Carry out the run of one step."""
    began = time.perf_counter()
    try:
        run = simulate(step)
    except RunFailed as failure:
        what = str(failure).partition(": ")[2]
        text = f"{what} (with an exchange step of {step.spec.exchange_step:.6g} s)"
        raise RunFailed(failure.component, failure.time, text) from None
    if run.status != COMPLETE:
        raise KeyboardInterrupt
    return outcome_of(run, watch, time.perf_counter() - began)


def _refuse_unknown(metrics: Sequence[str], found: Sequence[Level]) -> None:
    """Refuse metrics that no run has."""
    known = list(dict.fromkeys(name for level in found for name in level.values))
    problems = [
        Problem(f"metrics {name}", "is no metric of this system", nearest(name, known))
        for name in metrics
        if name not in known
    ]
    if problems:
        raise InputRefused(problems)
