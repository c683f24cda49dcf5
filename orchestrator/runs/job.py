"""From what a person asks for to a system that can be run: case or file, sizes, FMUs, values.

Everything that is wrong with a request is collected before it is refused.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rockshed.components.common.units import ms

from ..cases.registry import Case, case, model_changes
from ..cases.sand_models import Changes
from ..core.errors import InputRefused, Problem
from ..core.fmu.slave import Source
from ..core.system.system import System, Value, load_system, system_from, with_values
from ..metrics.headlines import LOAD_CELL_ROWS
from .building import AUTO, Note, assignments, case_fmus, case_sizes


@dataclass(frozen=True)
class Request:
    """What is asked for.

    target: name of a case, or path of a system file (TOML).
    settings: ``component.parameter=value``; sizes: ``component.size=value``.
    options: keys of the system that are replaced, ``stop_time`` for instance.
    model: of the sand, for cases; what is set otherwise goes before it.
    load_cell: cut-off frequency (Hz) of a load cell through which the transmitted force is to be seen as well.
    runtime: of the FMUs of a case: python, native, or auto for native ones where they are there and up to date.
    """

    target: str
    settings: Sequence[str] = ()
    sizes: Sequence[str] = ()
    coupling: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    in_process: bool = False
    load_cell: float | None = None
    model: str | None = None
    runtime: str = AUTO


@dataclass(frozen=True)
class Job:
    """A system ready to run.

    name: under which its results go. sources: components that are made without an FMU. facts: for the provenance of the run.
    """

    name: str
    system: System
    sources: Mapping[str, Source]
    facts: Mapping[str, Any]

    @property
    def components(self) -> frozenset[str]:
        """Components of the catalogue whose kernels this process will compile if they have never been; those of a system file are
        not known."""
        is_native = self.facts.get("runtime") == "native"
        return (
            frozenset()
            if is_native or "case" not in self.facts
            else frozenset(case(self.facts["case"]).models.values())
        )


def is_file(target: str) -> bool:
    """Whether a target is meant as a system file and not as the name of a case."""
    return target.endswith(".toml") or "/" in target or "\\" in target


def prepare(request: Request, note: Note = lambda text: None) -> Job:
    """Find the system, build its FMUs where that is needed, apply what the request changes.

    Raises:
        InputRefused: everything that is wrong with the request.
    """
    if request.target.endswith(".fmu"):
        raise InputRefused(
            [
                Problem(
                    request.target,
                    "is an FMU, and a run takes a case or a system file",
                    "look into it with "
                    "`rockshed info`, and name it in a system file; `rockshed info lab-impact --toml` shows one",
                )
            ]
        )
    problems: list[Problem] = []
    values = assignments("--set", request.settings, problems)
    numbers = assignments("--size", request.sizes, problems)
    if is_file(request.target):
        problems += [
            Problem(option, "is for cases only", reason)
            for option, reason, given in (
                ("--size", "build the FMUs with `rockshed build --size`", request.sizes),
                ("--model", "set the parameters of its sand", request.model),
                (
                    "--coupling",
                    "set --master, --exchange-step and the components' parameters",
                    request.coupling,
                ),
                ("--in-process", "a system file names FMU files", request.in_process),
                ("--runtime", "a system file names FMU files", request.runtime != AUTO),
            )
            if given
        ]
        if problems:
            raise InputRefused(problems)
        name = Path(request.target).stem
        system = load_system(Path(request.target))
        sources, facts = dict[str, Source](), dict[str, Any](system_file=request.target)
    else:
        name = case(request.target).name
        system, sources, facts = _from_case(
            case(request.target), request, values, numbers, problems, note
        )
    system = _changed(system, request, values, problems)
    problems += _load_cell_problems(request, system)
    if problems:
        raise InputRefused(problems + plan_problems(system, sources))
    if "case" in facts:
        system = with_values(
            system,
            {
                name: value
                for name, value in case(facts["case"]).derived(system, facts["sizes"]).items()
                if name not in values
            },
        )
    seen = {"load_cell": request.load_cell} if request.load_cell else {}
    return Job(name, system, sources, {**facts, **seen, "changed": {**values, **request.options}})


def _load_cell_problems(request: Request, system: System) -> list[Problem]:
    """A load cell whose cut-off is no frequency, or faster than the rows of the results can show."""
    if request.load_cell is None:
        return []
    interval = system.output_interval or system.exchange_step
    fastest = 1.0 / (LOAD_CELL_ROWS * interval)
    if 0.0 < request.load_cell <= fastest * (1.0 + 1e-9):
        return []
    return [
        Problem(
            "--load-cell",
            f"{request.load_cell:g} Hz: rows every {interval / ms:g} ms carry a cut-off above 0 and up to "
            f"{fastest:.4g} Hz, {LOAD_CELL_ROWS:g} rows for each period",
            "give a lower one"
            + (
                f", or --output-interval {1.0 / (LOAD_CELL_ROWS * request.load_cell):.2g} or less"
                if request.load_cell > 0.0
                else ""
            ),
        )
    ]


def plan_problems(system: System, sources: Mapping[str, Source]) -> list[Problem]:
    """What the FMUs find wrong with a system."""
    from ..core.run import sources_of
    from ..core.system.plan import make_plan

    try:
        make_plan(system, {**sources_of(system), **sources})
    except InputRefused as refusal:
        return refusal.problems
    return []


def _from_case(
    chosen: Case,
    request: Request,
    values: Mapping[str, Value],
    numbers: Mapping[str, Value],
    problems: list[Problem],
    note: Note,
) -> tuple[System, dict[str, Source], dict[str, Any]]:
    coupling = request.coupling or next(iter(chosen.couplings))
    if coupling not in chosen.couplings:
        problems.append(
            Problem(
                "--coupling",
                f"{coupling!r} is unknown",
                f"choose one of {', '.join(chosen.couplings)}",
            )
        )
    problems += _runtime_problems(request)
    model = model_changes(chosen, request.model, values)
    sizes = case_sizes(chosen, {**model.sizes, **numbers}, problems)
    if problems:
        raise InputRefused(problems)
    facts: dict[str, Any] = {"case": chosen.name, "coupling": coupling, "sizes": sizes}
    if request.model:
        facts["model"] = request.model
    if request.in_process:
        here = {name: f"{made} (in process)" for name, made in chosen.models.items()}
        return (
            _with_model(chosen.make(here, sizes, coupling), model),
            _in_process(chosen, sizes),
            facts,
        )
    fmus = case_fmus(chosen, sizes, note, request.runtime)
    facts |= {"runtime": fmus.runtime, "runtime_reason": fmus.reason}
    return _with_model(chosen.make(fmus.files, sizes, coupling), model), {}, facts


def _with_model(system: System, model: Changes) -> System:
    return system_from(
        {**with_values(system, model.values).model_dump(), **model.options}, system.name
    )


def _runtime_problems(request: Request) -> list[Problem]:
    known = (AUTO, "native", "python")
    if request.runtime not in known:
        return [
            Problem(
                "--runtime", f"{request.runtime!r} is unknown", f"choose one of {', '.join(known)}"
            )
        ]
    if request.in_process and request.runtime != AUTO:
        return [
            Problem(
                "--runtime",
                "is for FMUs, and --in-process runs without them",
                "leave one of them out",
            )
        ]
    return []


def _in_process(chosen: Case, sizes: Mapping[str, Mapping[str, int]]) -> dict[str, Source]:
    from rockshed.components.catalogue import component
    from rockshed.fmus.in_process import InProcess

    return {name: InProcess(component(model), sizes[name]) for name, model in chosen.models.items()}


def _changed(
    system: System, request: Request, values: Mapping[str, Value], problems: list[Problem]
) -> System:
    """The system with other values and other keys, as far as they have the right form."""
    try:
        system = with_values(system, values)
    except InputRefused as refusal:
        problems += refusal.problems
        for name, value in values.items():
            with suppress(InputRefused):  # told already
                system = with_values(system, {name: value})
    try:
        return system_from({**system.model_dump(), **request.options}, request.target)
    except InputRefused as refusal:
        problems += refusal.problems
        return system
