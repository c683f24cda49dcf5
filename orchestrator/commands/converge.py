"""The command ``rockshed converge``: sizes of discs and elements of a shed, or exchange steps."""

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ..analyses.convergence.files import DATA
from ..analyses.convergence.run import converge
from ..analyses.exchange_steps import files as exchange_files
from ..analyses.exchange_steps.result import ExchangeStepsResult
from ..analyses.exchange_steps.run import converge_exchange
from ..cases.registry import case, is_case
from ..core.errors import InputRefused, Problem, RunFailed, all_causes
from ..core.system.fields import Value
from ..core.system.quantities import in_si
from ..runs.chosen import is_project_file
from ..runs.job import look_at_target
from ..runs.request import Request
from .analysis import as_json as data_of
from .analysis import kept_if_ended, options_named, show, stages
from .assignments import values_of
from .options import (
    Assignments,
    CouplingScheme,
    Json,
    NoFigures,
    Quiet,
    Target,
    Workers,
    simulated_time,
)
from .results_place import free_folder, look_at_place
from .screen import RUN_FAILED, Screen, opened
from .streams import stdout_for_results

_Packings = Annotated[
    int | None, typer.Option(min=2, help="Packings of the sand for each mesh; default 5.")
]
_Finest = Annotated[
    float | None,
    typer.Option(
        help="How many times finer than the project's the finest discs are; default 2.",
    ),
]
_Exchange = Annotated[
    bool,
    typer.Option(
        "--exchange",
        help="Halve the exchange step also of a project, and not the discs and elements.",
    ),
]
_Step = Annotated[
    float | None, simulated_time("Coarsest exchange step, 1e-5 or 10us; default the system's own.")
]
_Levels = Annotated[
    int | None, typer.Option(help="Exchange steps h, h/2, h/4, ..., three at least; default 4.")
]
_Accuracy = Annotated[
    str | None,
    typer.Option(metavar="1%", help="Error for which an exchange step is recommended; default 1%."),
]
_Watch = Annotated[
    list[str] | None,
    typer.Option(
        metavar="COMPONENT.PORT",
        help="Follow this variable over the exchange steps: largest difference over time, and last "
        "value. May be repeated.",
    ),
]
_Metrics = Annotated[
    list[str] | None,
    typer.Option(
        "--metric",
        metavar="ID",
        help="Follow this metric over the exchange steps (peak_transmitted_force, ...). "
        "May be repeated.",
    ),
]
_StopTime = Annotated[float | None, simulated_time("End of every run over the exchange steps.")]
_OutputInterval = Annotated[
    float | None, simulated_time("Time between two rows of every run over the exchange steps.")
]
_Folder = Annotated[
    Path | None,
    typer.Option(
        help="Folder of the results; default results/NAME-convergence or NAME-exchange-steps."
    ),
]
_TIMES = ("exchange_step", "stop_time", "output_interval")
_OF_STEPS = ("levels", "accuracy", "watch", "metrics", "coupling", "folder")


def command(
    target: Target,
    exchange: _Exchange = False,
    exchange_step: _Step = None,
    levels: _Levels = None,
    accuracy: _Accuracy = None,
    watch: _Watch = None,
    metric: _Metrics = None,
    stop_time: _StopTime = None,
    output_interval: _OutputInterval = None,
    coupling: CouplingScheme = None,
    packings: _Packings = None,
    finest: _Finest = None,
    set_: Assignments = None,
    output_dir: _Folder = None,
    workers: Workers = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compare finer and finer exchange steps, or meshes of a shed.

    Of a case or system: order and recommended exchange step. Of a project: coarser and finer
    discs and elements, each mesh with several packings; with --exchange the steps.
    """
    of_meshes = _given({"packings": packings, "finest": finest, "workers": workers})
    of_steps = {
        "levels": levels,
        "accuracy": accuracy,
        "watch": watch,
        "metrics": metric,
        "coupling": coupling,
        "exchange_step": exchange_step,
        "stop_time": stop_time,
        "output_interval": output_interval,
    }
    with opened(quiet, as_json) as screen:
        shown = {"pictures": not no_figures, "folder": output_dir}
        _carry_out((target, exchange), (of_meshes, _given(of_steps)), set_ or [], shown, screen)


def _carry_out(
    what: tuple[str, bool],
    options: tuple[dict[str, Any], dict[str, Any]],
    assigned: Sequence[str],
    shown: Mapping[str, Any],
    screen: Screen,
) -> None:
    """Carry out the study that is asked for.

    Of a target, and whether its exchange steps are wanted in any case, with the options of meshes
    and those of steps.
    """
    target, exchange = what
    of_meshes, of_steps = options
    problems: list[Problem] = []
    values = values_of("--set", assigned, problems)
    if "accuracy" in of_steps:
        of_steps["accuracy"] = _share(of_steps["accuracy"], problems)
    asks_for_meshes = not exchange and is_project_file(target)
    problems += _misplaced(of_steps if asks_for_meshes else of_meshes, asks_for_meshes)
    with all_causes(partial(look_at_target, target), look_at_place(shown["folder"])):
        if problems:
            raise InputRefused(problems)
    if asks_for_meshes:
        _meshes(Path(target), {**shown, "values": values, **of_meshes}, screen)
    else:
        times = {name: of_steps.pop(name) for name in _TIMES if name in of_steps}
        _steps(target, {**shown, "values": values, **of_steps, "options": times}, screen)


def _given(options: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value not in (None, [])}


def _misplaced(options: Mapping[str, Any], asks_for_meshes: bool) -> list[Problem]:
    """Return options that the study that is asked for does not have."""
    what = "is for exchange steps" if asks_for_meshes else "is for discs and elements of a project"
    remedy = "add --exchange" if asks_for_meshes else "leave it out"
    spelt = {"metrics": "--metric"}
    return [
        Problem(spelt.get(name, f"--{name.replace('_', '-')}"), what, remedy) for name in options
    ]


def _share(text: str, problems: list[Problem]) -> float | None:
    """Read a part of a whole, ``1%`` or ``0.01``."""
    number, percent, rest = text.strip().partition("%")
    try:
        value = in_si(number.strip(), "1")
    except ValueError:
        value, rest = 0.0, text
    if rest:
        problems.append(Problem("--accuracy", f"{text!r} is no percentage", "write 1% or 0.01"))
        return None
    return value / 100.0 if percent else value


def _meshes(project: Path, asked: Mapping[str, Any], screen: Screen) -> None:
    """Carry out the study of discs and elements of a project."""
    origin = {"project_file": str(project)}
    folder = asked["folder"] or free_folder(
        f"{project.stem}-convergence", origin, _reader(DATA), screen
    )
    named = options_named(("packings", "finest", "folder"))
    with kept_if_ended(screen, folder), named, stages(screen) as progress:
        result = converge(
            project, **{**asked, "folder": folder}, progress=progress, note=screen.note
        )
    show(screen, result)


def _steps(target: str, asked: Mapping[str, Any], screen: Screen) -> None:
    """Carry out the study of exchange steps of a system."""
    folder = asked["folder"] or _folder_of_steps(target, screen)
    try:
        given = {*_OF_STEPS, *asked["options"]}
        named = options_named((*_OF_STEPS, *_TIMES), target, given)
        kept = kept_if_ended(screen, folder)
        with kept, named, stages(screen) as progress, stdout_for_results():
            result: ExchangeStepsResult = converge_exchange(
                target, **{**asked, "folder": folder}, progress=progress, note=screen.note
            )
    except RunFailed as failure:
        screen.fail(str(failure))
        raise typer.Exit(RUN_FAILED) from None
    if screen.as_json:
        screen.dump({**data_of(result), "study": exchange_files.as_data(result)})
        return
    show(screen, result)


def _folder_of_steps(target: str, screen: Screen) -> Path:
    """Return the folder of the results of a target that the user has named no folder for."""
    request = Request(target)
    name = Path(target).stem if request.is_file else target
    kind = "project_file" if request.is_file and is_project_file(target) else "system_file"
    of_case: dict[str, Value] = {"case": case(target).name if is_case(target) else target}
    which = {kind: target} if request.is_file else of_case
    return free_folder(
        f"{name}-exchange-steps",
        {"kind": "exchange-steps", **which},
        _reader(exchange_files.DATA),
        screen,
    )


def _reader(file: str) -> Any:
    return lambda folder: json.loads((folder / file).read_text(encoding="utf-8"))
