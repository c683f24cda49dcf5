"""The command ``rockshed run``: a case, a project or a system, from its values to its pictures."""

from collections.abc import Mapping
from pathlib import Path
from shlex import quote
from typing import Annotated, Any

import typer

from ..core.ending import true_cause
from ..core.errors import Problem, RunFailed, all_causes, counted
from ..core.supervisor import announce
from ..metrics.width_band import width_band_table
from ..runs.building import is_cold
from ..runs.chosen import has_slope, is_project_file
from ..runs.continuing import stopped_at
from ..runs.request import AUTO, Request
from ..runs.run import Run
from ..runs.simulation import simulate, with_facts
from ..runs.system import System
from .analysis import options_named
from .assignments import sizes_of, values_of
from .drawing import draw
from .options import (
    Assignments,
    CaseSizes,
    CouplingScheme,
    Json,
    ModelName,
    NoFigures,
    Quiet,
    Strict,
    Target,
    simulated_time,
)
from .results_place import look_at_folder, results_folder
from .screen import CHECK_FAILED, COLD_START, INTERRUPTED, RUN_FAILED, Screen, opened
from .streams import stdout_for_results, tell_leftovers

_OF_CASES = ("values", "sizes", "coupling", "model", "load_cell", "runtime", "in_process")
_SIZES = {"discs": "sand disc", "elements": "beam element"}
"""Sizes that tell how long a run takes, in words."""
OPTIONS = (
    *_OF_CASES,
    "folder",
    "stop_time",
    "exchange_step",
    "output_interval",
    "state_interval",
    "master",
    "iteration",
    "adaptive",
    "tolerance",
    "isolate",
    "time_limit",
    "allow_unstable",
    "checkpoint_every",
)
"""Arguments of the library that are options of the command."""

_Folder = Annotated[Path | None, typer.Option(help="Folder of the results; default results/CASE.")]


_StopTime = Annotated[float | None, simulated_time("End of the run.")]
_ExchangeStep = Annotated[
    float | None,
    simulated_time("Time between two exchanges; like all times 1e-5, 10us or a fraction, 1/60."),
]
_OutputInterval = Annotated[float | None, simulated_time("Time between two rows.")]
_StateInterval = Annotated[
    float | None, simulated_time("Time between two recorded states of the sand.")
]
_Master = Annotated[
    str | None,
    typer.Option(
        metavar="sequential|jacobi|implicit",
        help="One component after the other, all at once, or each exchange until it fits together.",
    ),
]
_Iteration = Annotated[
    list[str] | None,
    typer.Option(
        "--iteration",
        metavar="KEY=VALUE",
        help="How the implicit master repeats exchanges, a key of [iteration]: window=4e-4. May be "
        "repeated.",
    ),
]
_Adaptive = Annotated[
    list[str] | None,
    typer.Option(
        "--adaptive",
        metavar="KEY=VALUE",
        help="Let the exchange step follow the error, by keys of [adaptive]: tolerance=1e-4, "
        "largest_step=1.28e-4, control=doubling|ledger. May be repeated.",
    ),
]
_Tolerance = Annotated[
    float | None,
    typer.Option(
        metavar="NUMBER",
        help="Relative tolerance of the solvers in FMUs; default is what each of them proposes.",
    ),
]
_Isolate = Annotated[
    list[str] | None,
    typer.Option(
        "--isolate",
        metavar="COMPONENT|all",
        help="Run the FMU of a component in a process of its own: a crash or hang is told with its "
        "time. May be repeated.",
    ),
]
_TimeLimit = Annotated[
    float | None, simulated_time("Longest time of one call of an isolated FMU; default 600.")
]
_AllowUnstable = Annotated[
    bool, typer.Option("--allow-unstable", help="Run with steps above the stable ones.")
]
_LoadCell = Annotated[
    float | None,
    typer.Option(
        metavar="HERTZ",
        help="Show the peak transmitted force also as a load cell with this cut-off frequency "
        "does.",
    ),
]
_Runtime = Annotated[
    str,
    typer.Option(
        metavar="auto|native|python",
        help="FMUs of a case: native, with Python inside, or native if they are there and up to "
        "date.",
    ),
]
_Band = Annotated[
    bool,
    typer.Option(
        "--band",
        help="Run a project also with the smallest and the largest effective width of all rules, "
        "in two more processes.",
    ),
]
_Checkpoints = Annotated[
    float | None,
    simulated_time(
        "Simulated time between two checkpoints, 2ms, from which `rockshed resume` goes on."
    ),
]
_InProcess = Annotated[
    bool, typer.Option("--in-process", help="Components without FMUs, in this process.")
]


def command(
    target: Target,
    set_: Assignments = None,
    size: CaseSizes = None,
    output_dir: _Folder = None,
    stop_time: _StopTime = None,
    exchange_step: _ExchangeStep = None,
    output_interval: _OutputInterval = None,
    state_interval: _StateInterval = None,
    master: _Master = None,
    iteration: _Iteration = None,
    adaptive: _Adaptive = None,
    tolerance: _Tolerance = None,
    isolate: _Isolate = None,
    time_limit: _TimeLimit = None,
    model: ModelName = None,
    coupling: CouplingScheme = None,
    allow_unstable: _AllowUnstable = False,
    load_cell: _LoadCell = None,
    runtime: _Runtime = AUTO,
    in_process: _InProcess = False,
    checkpoint_every: _Checkpoints = None,
    band: _Band = False,
    strict: Strict = False,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run a case, a project or a system file, compare, draw.

    FMUs of a case that are missing are built.
    """
    problems = _without_band(band, target)
    values, sizes = values_of("--set", set_ or [], problems), sizes_of(size or [], problems)
    options = _chosen(stop_time=stop_time, exchange_step=exchange_step, master=master)
    options |= _chosen(output_interval=output_interval, state_interval=state_interval)
    options |= _tables(problems, iteration=iteration, adaptive=adaptive)
    options |= _chosen(tolerance=tolerance, isolate=isolate or None, time_limit=time_limit)
    asked = Request(target, values, sizes, coupling, options, in_process, load_cell, model, runtime)
    announce(quiet=quiet, as_json=as_json, figures=not no_figures)
    with opened(quiet, as_json) as screen, all_causes(look_at_folder(output_dir)):
        conduct = {"allow_unstable": allow_unstable, "checkpoint_every": checkpoint_every}
        done = _simulate(asked, problems, output_dir, conduct, screen)
        show_run(_with_band(band, done, asked, screen), screen, not no_figures, strict)


def _without_band(band: bool, target: str) -> list[Problem]:
    """Return what is wrong with a band that was asked for."""
    if not band or is_project_file(target):
        return []
    return [Problem("--band", "is for projects: other systems have no width to choose")]


def _with_band(band: bool, done: Run, request: Request, screen: Screen) -> Run:
    """Return a complete run of a project with the band of the effective width, if it is wanted."""
    if not band or done.status != "complete":
        return done
    from ..analyses.shed.band import width_band  # processes are started for it alone

    with screen.counting("other effective widths") as counted:
        found = width_band(done, request, note=screen.note, counted=counted)
    return with_facts(done, {"band": found})


def _chosen(**options: Any) -> dict[str, Any]:
    """Return the options that are given."""
    return {name: value for name, value in options.items() if value is not None}


def _tables(problems: list[Problem], **texts: list[str] | None) -> dict[str, Any]:
    """Return the tables whose keys are given."""
    return {
        name: values_of(f"--{name}", given, problems, "key")
        for name, given in texts.items()
        if given
    }


def _given(request: Request) -> set[str]:
    """Return the arguments of a request that are other than their defaults."""
    plain = Request(request.target)
    given = (name for name in _OF_CASES if getattr(request, name) != getattr(plain, name))
    return {*given, *request.options}


def _simulate(
    request: Request,
    problems: list[Problem],
    output_dir: Path | None,
    conduct: Mapping[str, Any],
    screen: Screen,
) -> Run:
    """Carry out a run; one that fails or is interrupted gives what was computed until then."""
    with stdout_for_results(), screen.progress("preparing") as progress:
        if has_slope(request.target) and is_cold(["SlopeRockfall"]):
            progress.describe(COLD_START)
        with options_named(OPTIONS, request.target, _given(request)):
            system = System.prepared(request, screen.note, problems)
        facts = system.job.facts
        if "runtime" in facts:
            reason = facts["runtime_reason"]
            screen.note(f"{facts['runtime']} FMUs ({reason})")
        if size := _size_in_words(system):
            screen.note(size)
        folder = output_dir or _folder(system, screen)
        if is_cold(system.job.components):
            progress.describe(COLD_START)
        tell_leftovers(folder, screen)
        try:
            with options_named(OPTIONS, given={*request.options, "checkpoint_every"}):
                return simulate(system, folder, progress=progress, note=screen.warn, **conduct)
        except RunFailed as failure:
            done: Run = failure.run
            return done


def _size_in_words(system: System) -> str:
    """Return how large a run of a case or project will be; empty of a system file."""
    of_components = system.job.facts.get("sizes", {})
    sizes = {size: number for told in of_components.values() for size, number in told.items()}
    spec = system.spec
    words = [counted(sizes[size], word) for size, word in _SIZES.items() if size in sizes]
    exchanges = round(spec.stop_time / spec.exchange_step)
    until = f"{exchanges:,} exchanges until {1e3 * spec.stop_time:g} ms"
    return f"size: {', '.join([*words, until])}" if words else ""


def _folder(system: System, screen: Screen) -> Path:
    """Return the folder of the results of a system that the user has named no folder for."""
    facts = system.job.facts
    which = next(key for key in ("case", "project_file", "system_file") if key in facts)
    place = system.name if which == "case" else facts[which]
    return results_folder(system.name, place, {which: facts[which]}, screen)


def show_run(done: Run, screen: Screen, with_figures: bool, strict: bool = False) -> None:
    """Draw and show a run; one that is not complete gives its exit code.

    Why a run failed is said before drawing, which takes its time and may be interrupted.

    Parameters
    ----------
    done : Run
        Complete or not.
    screen : Screen
        Of the command.
    with_figures : bool
        Whether pictures are drawn.
    strict : bool
        Whether a run may have no warnings.

    Raises
    ------
    typer.Exit
        The run is not complete, drawing was interrupted, or a strict run has warnings.
    """
    if done.status == "failed":
        screen.fail(str(done.error))
    if done.status == "interrupted":
        reached = (
            f"interrupted at t = {1e3 * done.time[-1]:g} ms" if done.time.size else "interrupted"
        )
        screen.warn(f"{reached}; the results until then are kept")
    pictures: list[Path] = []
    drawn = True
    try:
        with true_cause(OSError, MemoryError):
            if with_figures:
                pictures = draw(done, done.folder / "figures", screen)
    except KeyboardInterrupt:
        again = f"rockshed plot {quote(str(done.folder))}"
        screen.warn(f"drawing was interrupted; `{again}` draws the pictures")
        drawn = False
    _show_results(done, pictures, screen)
    if done.status == "failed":
        raise typer.Exit(RUN_FAILED)
    if done.status == "interrupted" or not drawn:
        raise typer.Exit(INTERRUPTED)
    if strict and done.warnings:
        screen.fail(f"strict: the run has {counted(len(done.warnings), 'warning')}")
        raise typer.Exit(CHECK_FAILED)


def _show_results(done: Run, pictures: list[Path], screen: Screen) -> None:
    """Show the table of a run or its JSON; of a run that failed, only where its results are."""
    for text in done.warnings:
        screen.warn(text)
    if screen.as_json:
        screen.dump(_as_data(done, pictures))
        return
    if done.status != "failed":
        for line in done.caption:
            screen.say(line)
        screen.show("", done.table(), "")
        for line in done.notes:
            screen.say(line)
        for table in (done.formulas(), width_band_table(done)):
            if len(table):
                screen.show(table, "")
    drawn = f", {counted(len(pictures), 'picture')} in {pictures[0].parent}" if pictures else ""
    screen.say(f"results in {done.folder}{drawn}")
    if done.status != "complete" and stopped_at(done.folder) is not None:
        screen.say(f"`rockshed resume {quote(str(done.folder))}` goes on from its last checkpoints")


def _as_data(done: Run, pictures: list[Path]) -> dict[str, Any]:
    return {
        "status": done.status,
        "folder": str(done.folder),
        "error": done.error,
        "warnings": done.warnings,
        "caption": done.caption,
        "formulas": done.provenance.get("formulas", []),
        "band": done.provenance.get("band", {}),
        "metrics": [metric.as_entry() for metric in done.metrics.values()],
        "pictures": [str(file) for file in pictures],
    }
