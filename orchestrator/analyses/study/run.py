"""Carry out a study: prepare all of its runs, then run them, then tell."""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ...core.errors import AnalysisFailed, InputRefused, Problem, all_causes
from ...core.input_text import shown
from ...core.results.metric import identifier
from ...core.results.reading import read_run
from ...core.system.fields import Value
from ...core.system.names import nearest
from ...core.variants import plan_branching
from ...metrics.percentiles import borne, needed
from ...runs.batch import INTERRUPTED, BranchPoint, Outcome, Task, carry_out, orders_of
from ...runs.building import Note, silent
from ...runs.cluster import Certificates
from ...runs.dask_executor import dask
from ...runs.executors import Crew, number_of_workers, processes
from ...runs.job import file_problems, prepare
from ...runs.kept import FINISHED, KeptRuns
from ...runs.parameters import BranchValues, SystemValues
from ...runs.request import Request, plain
from ...runs.system import System
from ..asked import remembering
from ..frame import StageProgress, counter, no_progress
from .arguments import StudyArguments, varied
from .designs import (
    DESIGNS,
    GRID,
    MOST_POINTS,
    RANDOM,
    SAMPLED,
    SOBOL,
    DesignPoint,
    design_problems,
    points,
)
from .factors import Factor, Levels, Varied, in_si
from .headline import headline_metrics
from .records import (
    MetricName,
    StudyRecords,
    StudyRun,
    by_size,
    common_reasons,
    metrics_by_identifier,
)
from .result import StudyResult
from .statistics import SHARES
from .tables import level_text

_MOST_REASONS = 3
"""Reasons that are told of a study without a result."""
EXTREME = 1e-3
"""Percentile nearest to 0 and to 100 (in percent); no study has enough samples for it."""
StudyTarget = str | Path | Mapping[str, Any] | System
"""A case, a project or system file, the content of a project, or a system of one of them."""


class StudyFailed(AnalysisFailed):
    """No run of a study has a result.

    Attributes
    ----------
    result : StudyResult
        With the reason of each run.
    """

    def __init__(self, result: StudyResult) -> None:
        self.result = result
        reasons = common_reasons(result.records.runs)
        told = "; ".join(f"{text} ({count} of them)" for text, count in reasons[:_MOST_REASONS])
        super().__init__(f"none of the {len(result.records.runs)} runs has a result: {told}")


@dataclass(frozen=True)
class _Plan:
    """Everything that a study runs.

    Attributes
    ----------
    name : str
        Of the system.
    design : str
        Name of the design.
    factors : sequence of Factor
        That vary.
    entries : sequence of (int, DesignPoint, int or None, Task)
        Number of the point, counted from 1, the point, the packing and the run.
    origin : mapping of str to Any
        What is studied.
    """

    name: str
    design: str
    factors: Sequence[Factor]
    entries: Sequence[tuple[int, DesignPoint, int | None, Task]]
    origin: Mapping[str, Any] = field(default_factory=dict)


def study(
    target: StudyTarget,
    vary: Mapping[str, Varied | Sequence[Value]],
    *,
    design: str | None = None,
    samples: int | None = None,
    seeds: int = 1,
    draw: int = 0,
    values: Mapping[str, Value] | None = None,
    options: Mapping[str, Any] | None = None,
    metrics: Sequence[str] = (),
    percentiles: Sequence[float] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    certificates: Certificates | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
    note: Note = silent,
) -> StudyResult:
    """Run a system with values that vary, by levels or by distributions.

    Parameters
    ----------
    target : str, path, mapping or System
        A case, a project file or its content, a system file, or a system of one of these.
    vary : mapping
        Values that vary, by the name of a field of the project, ``component.parameter`` or the name
        of a shared value: a list of levels, an :class:`~rockshed.Interval` or a
        :class:`~rockshed.RandomValue`.
    design : str, optional
        ``grid``, ``oat`` (one at a time), ``random``, ``lhs`` or ``sobol``; by default a grid, with
        a distribution ``random``.
    samples : int, optional
        Number of samples that are drawn; of a Sobol design a power of 2, of which it runs as many
        times (factors + 2).
    seeds : int
        Number of packings of the sand: for each point of a grid; of random samples and those of a
        Latin hypercube, each sample has one of them.
    draw : int
        Seed of the random numbers of the design.
    values : mapping of str to Value, optional
        Other values of the system, which do not vary.
    options : mapping, optional
        Keys of the system: ``stop_time``, ``output_interval``, ...
    metrics : sequence of str
        Identifiers of the metrics that are told; by default forces, penetration, moment,
        deflection and utilisation.
    percentiles : sequence of float, optional
        In percent; by default 5, 50, 90, 95, 99, as far as the sample bears them.
    workers : int, optional
        Number of processes, by default one for each core.
    scheduler : str, optional
        ``local`` or the address of a Dask scheduler, whose workers see the same files.
    certificates : Certificates, optional
        Of a scheduler at ``tls://HOST:PORT``.
    folder : path, optional
        Where the results are saved; other files stay there. Runs that have ended are kept there
        until all have: a study that was killed or interrupted goes on.
    pictures : bool
        Whether figures are drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    StudyResult
        All runs, tables, metrics and figures.

    Raises
    ------
    InputRefused
        Everything that is wrong with arguments, designs or values; nothing was computed.
    StudyFailed
        No run has a result; its attribute ``result`` has the reasons.
    ClusterFailed
        The workers of a scheduler could not go on.

    Examples
    --------
    >>> import rockshed
    >>> found = rockshed.study(
    ...     "lab-impact",
    ...     {"rock.velocity0.y": [-4.0, -8.0]},
    ...     options={"stop_time": 0.002},
    ...     workers=1,
    ... )
    >>> found
    <StudyResult lab-impact: 2 designs, 2 runs>
    >>> found.to_arrow().column("rock.velocity0.y").to_pylist()
    [-4.0, -8.0]
    """
    asked = StudyArguments(
        _request(target, values or {}, options or {}),
        {name: varied(given) for name, given in vary.items()},
        design,
        samples,
        seeds,
        draw,
        tuple(metrics),
        percentiles,
        workers,
        scheduler,
        certificates,
        pictures,
    )
    return carry_out_study(asked, Path(folder) if folder else None, progress or no_progress, note)


def carry_out_study(
    asked: StudyArguments, folder: Path | None, show: StageProgress, note: Note
) -> StudyResult:
    """Carry out a study; with a folder, it can go on in another process when this one is ended.

    Parameters
    ----------
    asked : StudyArguments
        Everything that it follows from.
    folder, show, note
        As :func:`study` has them.

    Raises
    ------
    InputRefused, StudyFailed, ClusterFailed
        As :func:`study` does.
    """
    with all_causes(lambda: _refuse_design(asked)):
        plan = _plan(asked, note)
    shares = _shares(asked.percentiles, plan)
    orders = orders_of([task for *_, task in plan.entries], note)
    opening = _Opening(asked.workers, asked.scheduler, asked.certificates)
    place = folder / FINISHED if folder else None
    kept = KeptRuns(place) if place else None
    with remembering(place, StudyResult.kind, asked.as_data(), asked.files):
        began = time.perf_counter()
        counted = counter(show, "runs")
        outcomes = carry_out(orders, opening.open, note, counted, kept, check_first=True)
        effort = {"wall_time": time.perf_counter() - began, **opening.facts}
        result = _result(plan, outcomes, asked.metrics, shares, effort)
        has_any = bool(result.records.complete)
        if folder:
            result.save(folder, pictures=asked.pictures and has_any, progress=show)
        if not has_any:
            raise StudyFailed(result)
        if kept is not None:
            kept.clear()
    return result


# --- what is run ---


def _request(
    target: StudyTarget, values: Mapping[str, Value], options: Mapping[str, Any]
) -> Request:
    if isinstance(target, System):
        if target.request is None or target.request.in_process:
            text = "runs in processes of its own, which need the FMU files of a system"
            remedy = "give the name of a case or the file of a project or system"
            raise InputRefused([Problem(target.name, text, remedy)])
        found = target.request
    elif isinstance(target, Mapping):
        found = Request("project", project=target)
    else:
        found = Request(str(target))
    return replace(
        found,
        values={**found.values, **plain(values)},
        options={**found.options, **plain(options)},
    )


def _plan(asked: StudyArguments, note: Note) -> _Plan:
    """Return the runs of a study.

    Raises
    ------
    InputRefused
        Everything that is wrong with what varies, and with the design.
    """
    subject = _subject(asked, note)
    seeds = asked.seeds
    known = subject.known
    request = subject.request
    factors, problems = _factors(asked.vary, known)
    chosen = asked.design or (RANDOM if any(f.is_distribution for f in factors) else GRID)
    problems += [*_argument_problems(asked), *_seed_problems(seeds, asked.vary, known)]
    problems += [] if problems else design_problems(chosen, factors, asked.samples)
    problems += subject.problems
    if problems:
        raise InputRefused(problems)
    found = points(chosen, factors, asked.samples or 0, asked.draw)
    if not _in_turn(chosen) and len(found) * seeds > MOST_POINTS:
        text = f"{len(found)} points of {shown(seeds)} packings; {MOST_POINTS:,} runs are most"
        raise InputRefused([Problem("seeds", text, "give fewer")])
    entries = [
        (number, point, seed, _task(request, point, seeded, number, factors, asked.branch))
        for number, point in enumerate(found, 1)
        for seed, seeded in _packings(known, seeds, number - 1, point, chosen)
    ]
    origin = {"draw": asked.draw, "samples": asked.samples, "seeds": seeds}
    given = {"values": dict(request.values), "options": dict(request.options)}
    return _Plan(subject.name, chosen, factors, entries, {**subject.origin, **origin, **given})


@dataclass(frozen=True)
class _Subject:
    """Something that is run with values that vary.

    Attributes
    ----------
    name : str
        Of the system.
    request : Request
        With the values that do not vary.
    known : SystemValues or BranchValues
        Values that there are.
    origin : mapping of str to Any
        For the provenance.
    problems : sequence of Problem
        What is wrong with it, whatever varies.
    """

    name: str
    request: Request
    known: SystemValues | BranchValues
    origin: Mapping[str, Any]
    problems: Sequence[Problem] = ()


_KINDS = ("case", "project_file", "system_file", "request")
"""Entries of the provenance of a run that say what was run; the first one counts."""


def _subject(asked: StudyArguments, note: Note) -> _Subject:
    """Return what is run: a system, or a run on its way.

    Raises
    ------
    InputRefused
        It cannot be prepared, or is no longer there.
    """
    if asked.branch is not None:
        return _run_on_its_way(asked.request, asked.branch)
    job = prepare(asked.request, note)
    problems = file_problems(job, asked.vary)
    return _Subject(job.name, asked.request, SystemValues(job), _kind_of(job.facts), problems)


def _kind_of(facts: Mapping[str, Any]) -> dict[str, Any]:
    return {kind: facts[kind] for kind in [k for k in _KINDS if k in facts][:1]}


def _run_on_its_way(request: Request, point: BranchPoint) -> _Subject:
    """Return a run whose variants have other values from a time on."""
    parent = read_run(Path(point.run))
    problems: list[Problem] = []
    known = BranchValues(plan_branching(parent, point.at, problems))
    values: dict[str, Value] = {}
    for name, value in request.values.items():
        refusal = known.refusal(name)
        if refusal is not None:
            problems.append(replace(refusal, where=f"values {name}"))
            continue
        try:
            values[name] = known.read(name, value)
            fault = known.fault(name, values[name])
        except ValueError as error:
            fault = str(error)
        if fault:
            problems.append(Problem(f"values {name}", f"{shown(value)}: {fault}"))
    origin = {**_kind_of(parent.provenance), "branch": {"of": point.run, "at": point.at}}
    return _Subject(request.target, replace(request, values=values), known, origin, problems)


def _refuse_design(asked: StudyArguments) -> None:
    """Refuse a design that is unknown, whatever the system is."""
    if asked.design is not None and asked.design not in DESIGNS:
        raise InputRefused(design_problems(asked.design, [], asked.samples))


def _argument_problems(asked: StudyArguments) -> Iterator[Problem]:
    """Yield what is wrong with the arguments of a study, whatever the system is."""
    if not asked.vary:
        yield Problem("vary", "nothing varies", "name a value and its levels")
    for name in asked.vary:
        if name in asked.request.values:
            text = "has a value too, in values"
            yield Problem(f"vary {name}", text, "leave one of them out")
    if asked.draw < 0:
        text = f"{asked.draw} is below 0"
        yield Problem("draw", text, "give a whole number from 0 on")


def _factors(
    vary: Mapping[str, Varied], known: SystemValues | BranchValues
) -> tuple[list[Factor], list[Problem]]:
    """Return what varies with numbers in SI, and what is wrong with it."""
    factors = []
    problems = []
    for name, how in vary.items():
        refusal = known.refusal(name)
        if refusal is not None:
            problems.append(replace(refusal, where=f"vary {name}"))
            continue

        def read(value: Value, name: str = name) -> Value:
            return known.read(name, value)

        factor, wrong = in_si(name, how, known.unit(name) or "1", read)
        factors.append(factor)
        problems += wrong or _level_faults(how, factor, known)
    return factors, problems


def _level_faults(
    how: Varied, factor: Factor, known: SystemValues | BranchValues
) -> Iterator[Problem]:
    """Yield the levels that the system does not take, as they were given."""
    given = how.values if isinstance(how, Levels) else factor.levels()
    for text, value in zip(given, factor.levels(), strict=True):
        if fault := known.fault(factor.name, value):
            yield Problem(f"vary {factor.name}", f"{shown(text)}: {fault}", "give another value")


def _seed_problems(
    seeds: int, vary: Mapping[str, Any], known: SystemValues | BranchValues
) -> list[Problem]:
    if seeds < 1:
        return [Problem("seeds", f"{seeds} packings are no study", "give one at least")]
    if seeds == 1:
        return []
    if known.seed is None:
        text = "no component of this system has packings that are numbered"
        return [Problem("seeds", text, "leave it out")]
    if known.seed in vary:
        return [Problem("seeds", f"and vary {known.seed} are one thing", "leave one of them out")]
    return []


def _packings(
    known: SystemValues | BranchValues, seeds: int, place: int, point: DesignPoint, design: str
) -> Iterator[tuple[int | None, dict[str, Value]]]:
    """Yield the packings of a point, and the value that makes each.

    A point of a grid or of a Sobol design has all of them; samples have one each, in turn.
    """
    if known.seed is None:
        yield None, {}
    elif known.seed in point.values:
        yield int(point.values[known.seed]), {}
    elif seeds == 1:
        yield known.first_seed, {}
    else:
        for i in [place % seeds] if _in_turn(design) else range(seeds):
            yield known.first_seed + i, {known.seed: known.first_seed + i}


def _in_turn(design: str) -> bool:
    """Tell whether each point of a design has one packing, and the next point the next one."""
    return design in SAMPLED and design != SOBOL


def _task(
    request: Request,
    point: DesignPoint,
    seeded: Mapping[str, Value],
    number: int,
    factors: Sequence[Factor],
    branch: BranchPoint | None,
) -> Task:
    units = {factor.name: factor.unit for factor in factors}
    told = ", ".join(f"{n} = {level_text(v, units[n])}" for n, v in point.values.items())
    return Task(
        replace(request, values={**request.values, **seeded, **point.values}),
        columns=None,
        label=f"in design {number} ({told})" if told else f"in design {number}",
        branch=branch,
    )


# --- what is told ---


def _shares(percentiles: Sequence[float] | None, plan: _Plan) -> list[float]:
    """Return the parts whose percentiles are told.

    Raises
    ------
    InputRefused
        There is no such percentile, the design has no sample, or it does not bear them.
    """
    if percentiles is None:
        return borne(SHARES, _sample_size(plan))
    problems = []
    for percent in percentiles:
        where = f"percentiles {percent:g}"
        if not EXTREME <= percent <= 100.0 - EXTREME:
            text = f"lies not between {EXTREME:g} and {100.0 - EXTREME:g}"
            problems.append(Problem(where, text, "give 95 for 95 %"))
        elif list(percentiles).count(percent) > 1:
            problems.append(Problem(where, "is given twice", "give it once"))
        elif plan.design not in SAMPLED:
            text = f"a design {plan.design} is no sample, and has no percentiles"
            problems.append(Problem(where, text, 'draw samples, with design="lhs"'))
        elif needed(0.01 * percent) > _sample_size(plan):
            text = (
                f"{_sample_size(plan)} samples do not bear it: its 95 % interval has two bounds "
                f"from {needed(0.01 * percent)} on"
            )
            problems.append(Problem(where, text, "give more samples, or leave it out"))
    if problems:
        raise InputRefused(problems)
    return [0.01 * percent for percent in percentiles]


def _sample_size(plan: _Plan) -> int:
    """Return the number of independent runs of a design that draws them."""
    if plan.design not in SAMPLED:
        return 0
    return sum(point.role in ("", "A", "B") for _, point, _, _ in plan.entries)


def _result(
    plan: _Plan,
    outcomes: Mapping[str, Outcome],
    metrics: Sequence[str],
    shares: Sequence[float],
    effort: Mapping[str, Any],
) -> StudyResult:
    """Return the result of runs that have all ended.

    Raises
    ------
    KeyboardInterrupt
        Some have not: they were interrupted.
    InputRefused
        The runs have no such metrics.
    """
    if any(outcome.status == INTERRUPTED for outcome in outcomes.values()):
        raise KeyboardInterrupt
    records = _records(plan, outcomes)
    told = _told(metrics, records) if records.complete else []
    return StudyResult(plan.name, records, told, shares, plan.origin, effort)


def _records(plan: _Plan, outcomes: Mapping[str, Outcome]) -> StudyRecords:
    runs = []
    names: dict[str, MetricName] = {}
    for number, point, seed, task in plan.entries:
        outcome = outcomes[task.key]
        found = metrics_by_identifier(outcome)
        for words, unit in outcome.units.items():
            if identifier(words) in found:
                names.setdefault(identifier(words), MetricName(words, unit))
        runs.append(
            StudyRun(
                number,
                point.role,
                seed,
                point.values,
                outcome.status,
                outcome.error,
                outcome.warnings,
                found,
            )
        )
    return by_size(StudyRecords(plan.design, plan.factors, runs, names))


def _told(metrics: Sequence[str], records: StudyRecords) -> list[str]:
    """Return the metrics that are told.

    Raises
    ------
    InputRefused
        The runs have no such metrics; they are kept.
    """
    unknown = [name for name in metrics if name not in records.names]
    if unknown:
        known = list(records.names)
        text = "no run has such a metric; the runs are kept"
        raise InputRefused([Problem(f"metrics {n}", text, nearest(n, known)) for n in unknown])
    return list(metrics) or headline_metrics(records)


class _Opening:
    """Opens processes or the workers of a scheduler.

    Attributes
    ----------
    facts : mapping of str to Any
        About the executor; empty while nothing had to be run.
    """

    def __init__(
        self, workers: int | None, scheduler: str | None, certificates: Certificates | None
    ) -> None:
        if scheduler is None and certificates is not None:
            text = "are for a running scheduler"
            raise InputRefused([Problem("certificates", text, "name it with scheduler=...")])
        number_of_workers(workers)
        self._workers = workers
        self._scheduler = scheduler
        self._certificates = certificates
        self.facts: Mapping[str, Any] = {}

    def open(self, most: int) -> AbstractContextManager[Crew]:
        """Open an executor for at most so many runs at a time."""
        if self._scheduler is not None:
            self.facts = {"scheduler": self._scheduler, "workers": self._workers}
            return dask(self._scheduler, self._workers, self._certificates)
        workers = min(number_of_workers(self._workers), most)
        self.facts = {"workers": workers}
        return processes(workers)
