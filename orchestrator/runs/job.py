"""From a request to a system that can be run: case or file, sizes, FMUs, values.

Everything that is wrong with a request is collected before it is refused.
"""

import os
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockshed.components.catalogue import component
from rockshed.components.common.units import ms

from ..cases.registry import (
    Case,
    ComponentSizes,
    differences,
    model_changes,
    references,
    told_once,
)
from ..cases.sand_models import Changes
from ..core.errors import InputRefused, Problem
from ..core.fmu.slave import Source
from ..core.system.other_values import aliases, with_values
from ..core.system.reading import system_from
from ..core.system.renaming import with_present_names
from ..core.system.system import SystemSpec
from ..metrics.filtering import LOAD_CELL_ROWS
from ..ssp.package import is_ssp
from .building import FmusOf, Note, case_fmus, case_sizes, own_sizes, silent
from .chosen import choose
from .request import AUTO, Request, with_keys
from .scenario import SCENARIO, told
from .system_file import SystemFile
from .values_in_si import case_in_si, file_in_si, shared_in_si, source_in

if TYPE_CHECKING:
    from ..ssp.reading import Imported

__all__ = [
    "Job",
    "Request",
    "file_problems",
    "look_at_target",
    "plan_problems",
    "prepare",
    "recorded_names",
]


@dataclass(frozen=True)
class Job:
    """A system ready to run.

    Attributes
    ----------
    name : str
        Name under which the results go.
    system : SystemSpec
        The system, values and options of the request in it.
    sources : mapping of str to Source
        Components that are made without an FMU file.
    facts : mapping
        For the provenance of the run: case, sizes, request, what differs from the case, references.
    models : mapping of str to str
        Components of the catalogue by component of a case; those of a system file are not known.
    ssp : Imported or None
        The SSP that the system comes from.
    files : callable or None
        Writes further files into the folder of a run.
    file : SystemFile or None
        The file that the system comes from.
    """

    name: str
    system: SystemSpec
    sources: Mapping[str, Source]
    facts: Mapping[str, Any]
    models: Mapping[str, str] = field(default_factory=dict)
    ssp: "Imported | None" = None
    files: Callable[[Path], None] | None = None
    file: SystemFile | None = None

    def placed(self, problems: Sequence[Problem]) -> list[Problem]:
        """Return problems with line and column of what they are about, where a file has it.

        Files of an SSP have their names in it.
        """
        if self.ssp is not None:
            named = self.ssp.package.named
            return [Problem(*map(named, (p.where, p.what, p.remedy))) for p in problems]
        return [*problems] if self.file is None else self.file.placed(problems)

    @property
    def fmus(self) -> dict[str, str]:
        """Names of the FMUs by component, for people: in an SSP those that they have there."""
        named = str if self.ssp is None else self.ssp.package.named
        return {name: named(spec.fmu) for name, spec in self.system.components.items()}

    @contextmanager
    def refused_in_place(self) -> Iterator[None]:
        """Tell what the block refuses with line and column, where a file has it.

        Raises
        ------
        InputRefused
            That of the block.
        """
        try:
            yield
        except InputRefused as refusal:
            raise type(refusal)(self.placed(refusal.problems)) from None

    @property
    def components(self) -> frozenset[str]:
        """Components of the catalogue whose kernels this process compiles if nobody has before."""
        native = self.facts.get("runtime") == "native"
        return frozenset() if native else frozenset(self.models.values())


def prepare(
    request: Request,
    note: Note = silent,
    problems: Sequence[Problem] = (),
    fmus_of: FmusOf = case_fmus,
) -> Job:
    """Make the system of a request; FMUs that are missing or out of date are built.

    Parameters
    ----------
    request : Request
        What is asked for.
    note : callable
        Called with a line for each FMU that is built.
    problems : sequence of Problem
        Problems that the caller has with the request, refused together with those seen here.
    fmus_of : callable
        Finds or builds the FMUs of a case.

    Returns
    -------
    Job
        The system, ready to run.

    Raises
    ------
    InputRefused
        Everything that is wrong with the request.
    """
    known = list(problems)
    chosen = choose(request, known)
    request = chosen.request
    warnings: list[str] = []
    if chosen.case is None:
        asked = request
        job, request = _of_file(request, known)
    else:
        asked, warnings = _with_present_names(request, chosen.case)
        known += _follower_problems(asked, chosen.case)
        request = case_in_si(asked, chosen.case, known, warnings)
        job = _from_case(chosen.case, request, known, note, fmus_of)
        request = shared_in_si(request, chosen.case, job.system, known)
    system = _changed(job.system, request, job.sources, known)
    known += _load_cell_problems(request, system)
    if known:
        raise InputRefused(job.placed(known + plan_problems(system, job.sources)))
    _refuse_misfit(job, system)
    if chosen.case is not None:
        system = _with_derived(job.system, system, request, chosen.case, job.facts["sizes"])
        warnings = [*chosen.case.warnings, *warnings]
    asked = replace(asked, values={**chosen.fields, **asked.values})
    differing = told({**chosen.fields, **job.facts["differences"]}, system)
    facts: dict[str, Any] = {
        **chosen.facts,
        **job.facts,
        "differences": differing,
        "request": asked.as_data(),
    }
    if request.load_cell:
        facts["load_cell"] = request.load_cell
    if warnings:
        facts["warnings"] = warnings
    return replace(job, system=system, facts=facts)


def look_at_target(target: str) -> None:
    """Look at the target of a command alone; nothing is built.

    Parameters
    ----------
    target : str
        A case, a project, a system file or an SSP.

    Raises
    ------
    InputRefused
        It can be no system, there is no such case, or its file is refused.
    """
    plain = Request(target)
    if choose(plain, []).case is None:
        _from_file(plain, [])


def _refuse_misfit(job: Job, system: SystemSpec) -> None:
    """Refuse a system file whose scenario does not fit its FMUs, with what else is wrong.

    Other problems alone are told when it is run.
    """
    problems = plan_problems(system, {}) if job.file and system.scenario else []
    if any(problem.where.startswith(f"{SCENARIO}.") for problem in problems):
        raise InputRefused(job.placed(problems))


def _with_present_names(request: Request, chosen: Case) -> tuple[Request, list[str]]:
    """Return the request for a case with the present names of variables, and warnings.

    The FMUs of a system file are asked when the run is planned.
    """
    renamed = {name: component(model).layout.renamed for name, model in chosen.models.items()}
    values, warnings = with_present_names(request.values, renamed)
    return replace(request, values=values), warnings


def _follower_problems(request: Request, chosen: Case) -> list[Problem]:
    """Refuse values that cannot be set apart from what they follow from."""
    return [
        Problem(name, f"follows from {chosen.follows[name]}", "set that")
        for name in request.values
        if name in chosen.follows
    ]


def _of_file(request: Request, problems: list[Problem]) -> tuple[Job, Request]:
    """Return the system of a file, and the request with its values in SI."""
    job = _from_file(request, problems)
    request = file_in_si(request, job.system, problems)
    differing = {**request.values, **request.options}
    return replace(job, facts={**job.facts, "differences": differing}), request


def _from_file(request: Request, problems: list[Problem]) -> Job:
    """Read the system of a file.

    Raises
    ------
    InputRefused
        The request asks for what only cases have, or the file is refused.
    """
    file = None
    if not is_ssp(request.target) and os.path.isfile(request.target):
        # what it is for is not known of one that is no TOML
        file = SystemFile.read(Path(request.target))
    for argument, remedy, asked in (
        ("sizes", "build its FMUs in these sizes", request.sizes),
        ("model", "set the parameters of its sand", request.model),
        ("coupling", "set master, exchange_step and the components' parameters", request.coupling),
        ("in_process", "a system file names FMU files", request.in_process),
        ("runtime", "a system file names FMU files", request.runtime != AUTO),
    ):
        if asked:
            problems.append(Problem(argument, "is for cases only", remedy))
    facts: dict[str, Any] = {}
    try:
        if is_ssp(request.target):
            return _from_ssp(request, facts)
        file = file or SystemFile.read(Path(request.target))
        file = replace(file, replaced={*request.values, *request.options})
        system = file.system(partial(_asked_of, request, problems))
    except InputRefused as refusal:
        raise InputRefused([*problems, *refusal.problems]) from None
    return Job(system.name, system, {}, facts, file=file)


def _asked_of(request: Request, problems: list[Problem], known: SystemSpec) -> SystemSpec:
    """Return what is sound in a file with the values and keys of the request, if they fit."""
    return _changed(known, file_in_si(request, known, problems), {}, problems)


def _from_ssp(request: Request, facts: dict[str, Any]) -> Job:
    """Read the system of an SSP; its exchange step may be given by the request alone."""
    from ..ssp.reading import read_ssp  # lxml, which systems of other kinds do not need

    read = read_ssp(Path(request.target), request.options)
    named = read.package.named
    facts["fmus"] = {name: named(spec.fmu) for name, spec in read.system.components.items()}
    if read.warnings:
        facts["warnings"] = list(read.warnings)
    return Job(read.system.name, read.system, {}, facts, ssp=read)


def _from_case(
    chosen: Case, request: Request, problems: list[Problem], note: Note, fmus_of: FmusOf
) -> Job:
    """Make the system of a case in the sizes of the request, with the model of the sand.

    Raises
    ------
    InputRefused
        Coupling, runtime, model or sizes that are not to be had.
    """
    coupling = request.coupling or chosen.coupling or next(iter(chosen.couplings))
    problems += _coupling_problems(chosen, coupling) + _runtime_problems(request)
    model = model_changes(chosen, request.model, request.values)
    sizes = case_sizes(chosen, {**model.sizes, **request.sizes}, problems)
    if problems:
        raise InputRefused(problems)
    sources: dict[str, Source] = {}
    facts: dict[str, Any] = {
        **chosen.facts,
        "coupling": coupling,
        "coupling_words": chosen.couplings[coupling],
        "sizes": sizes,
    }
    if request.model:
        facts["model"] = request.model
    if request.in_process:
        files = {name: f"{made} (in process)" for name, made in chosen.models.items()}
        sources = _in_process(chosen, sizes)
    else:
        fmus = fmus_of(chosen, sizes, note, request.runtime)
        facts |= {"runtime": fmus.runtime, "runtime_reason": fmus.reason}
        files = dict(fmus.files)
    base = chosen.make(files, sizes, coupling)
    request = shared_in_si(request, chosen, base, [])  # its problems are told by the caller
    given = {**request.values, **request.options}
    differing = differences(chosen, base, given, sizes, own_sizes(chosen, model.sizes))
    differing = told_once(chosen, base, differing, [*request.values, *request.sizes])
    facts["differences"] = differing
    facts["references"] = references(chosen, differing).as_data()
    system = _with_model(base, model)
    return Job(chosen.name, system, sources, facts, chosen.models, files=chosen.files)


def _coupling_problems(chosen: Case, coupling: str) -> list[Problem]:
    if coupling in chosen.couplings:
        return []
    choice = f"choose one of {', '.join(chosen.couplings)}"
    return [Problem("coupling", f"{coupling!r} is unknown", choice)]


def _runtime_problems(request: Request) -> list[Problem]:
    known = (AUTO, "native", "python")
    if request.runtime not in known:
        choice = f"choose one of {', '.join(known)}"
        return [Problem("runtime", f"{request.runtime!r} is unknown", choice)]
    if request.in_process and request.runtime != AUTO:
        return [
            Problem(
                "runtime",
                "is for FMUs, and in_process=True runs without them",
                "leave one of them out",
            )
        ]
    return []


def _with_model(system: SystemSpec, model: Changes) -> SystemSpec:
    return system_from(
        {**with_values(system, model.values).model_dump(), **model.options}, system.name
    )


def _with_derived(
    own: SystemSpec, system: SystemSpec, request: Request, chosen: Case, sizes: ComponentSizes
) -> SystemSpec:
    """Return the system with what follows from others where it is not given, and described so."""
    derived = chosen.derived(system, sizes)
    given = {other for name in request.values for other in aliases(system, name)}
    made = with_values(system, {name: derived[name] for name in derived if name not in given})
    if "description" in request.options:
        return made
    return made.model_copy(update={"description": chosen.described(own, made, sizes)})


def _in_process(chosen: Case, sizes: ComponentSizes) -> dict[str, Source]:
    from rockshed.fmus.in_process import InProcess  # imports pythonfmu, which FMU files do not need

    return {name: InProcess(component(model), sizes[name]) for name, model in chosen.models.items()}


def _changed(
    system: SystemSpec, request: Request, sources: Mapping[str, Source], problems: list[Problem]
) -> SystemSpec:
    """Return the system with other values and keys, as far as they have the right form."""
    try:
        system = with_values(system, request.values)
    except InputRefused as refusal:
        problems += refusal.problems
        for name, value in request.values.items():
            with suppress(InputRefused):  # told already
                system = with_values(system, {name: value})
    try:
        keys = with_keys(system.model_dump(), request.options)
        return system_from(keys, request.target, source_in(sources))
    except InputRefused as refusal:
        problems += refusal.problems
        return system


def _load_cell_problems(request: Request, system: SystemSpec) -> list[Problem]:
    """Refuse a cut-off that is no frequency, or faster than the rows of the results can show."""
    if request.load_cell is None:
        return []
    interval = system.output_interval or system.exchange_step
    fastest = 1.0 / (LOAD_CELL_ROWS * interval)
    if 0.0 < request.load_cell <= fastest * (1.0 + 1e-9):
        return []
    remedy = "give a lower one"
    if request.load_cell > 0.0:
        longest = 1.0 / (LOAD_CELL_ROWS * request.load_cell)
        remedy += f", or output_interval={longest:.2g} or less"
    return [
        Problem(
            "load_cell",
            f"{request.load_cell:g} Hz: rows every {interval / ms:g} ms carry a cut-off above 0 "
            f"and up to {fastest:.4g} Hz, {LOAD_CELL_ROWS:g} rows for each period",
            remedy,
        )
    ]


def plan_problems(system: SystemSpec, sources: Mapping[str, Source]) -> list[Problem]:
    """Return what the FMUs have against a system.

    Parameters
    ----------
    system : SystemSpec
        Components, connections, values.
    sources : mapping of str to Source
        Components that are made without an FMU file.

    Returns
    -------
    list of Problem
        Empty if the system can be run.
    """
    from ..core.run import sources_of
    from ..core.system.planning import problems_with

    return problems_with(system, {**sources_of(system), **sources})


def file_problems(job: Job, varied: Collection[str]) -> list[Problem]:
    """Return what the FMUs of a system have against its file, with line and column.

    Parameters
    ----------
    job : Job
        The system.
    varied : collection of str
        Names of values that take the place of those in the file.

    Returns
    -------
    list of Problem
        Empty of a system that comes from no file.
    """
    if job.file is None:
        return []
    file = replace(job.file, replaced={*job.file.replaced, *varied})
    problems = plan_problems(job.system, job.sources)
    return [problem for problem in file.placed(problems) if problem not in problems]


def recorded_names(job: Job) -> list[str]:
    """Return the names of the numbers that a run records, without the energy of its interfaces.

    Parameters
    ----------
    job : Job
        The system.

    Raises
    ------
    InputRefused
        The system does not fit its FMUs.
    """
    from ..core.run import sources_of
    from ..core.system.planning import make_plan

    with job.refused_in_place():
        plan = make_plan(job.system, {**sources_of(job.system), **job.sources})
    return [end.name for end in plan.recorded]
