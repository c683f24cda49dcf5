"""The command line ``rockshed``. Commands import what they need when they run, so that help is there at once."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from functools import partial
from io import TextIOWrapper
from pathlib import Path
from shlex import quote as quoted
from typing import TYPE_CHECKING, Annotated

import typer

from ..core.errors import Problem
from ..core.supervisor import announce, supervised

if TYPE_CHECKING:
    from ..core.results.reading import Run
    from ..runs.job import Request
    from .screen import Screen

_OBJECTS_BEFORE_COLLECTION = 100_000
"""Importing makes many objects and no garbage: looking for some every 700 objects takes a twentieth of the start."""

RESULTS = Path("results")
"""Folder of the runs that name no other."""

app = typer.Typer(
    name="rockshed",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_show_locals=False,
    rich_markup_mode=None,  # its help shows every flag as if it took a value
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
    help="Rockfall protection as FMI co-simulation: falling rock, sand cushion and beam as FMUs.",
    epilog="`rockshed run lab-impact` is where to begin; `rockshed COMMAND --help` tells the options. Exit codes: 0 "
    "done, 1 the run failed (what was computed is kept), 2 refused (nothing was computed or left behind), 3 a "
    "check failed, 130 interrupted with Ctrl-C (what was computed is kept).",
)

Json = Annotated[bool, typer.Option("--json", help="Print the results as JSON.")]
Quiet = Annotated[
    bool,
    typer.Option(
        "--quiet", "-q", help="No progress and no notes: results, warnings and errors only."
    ),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="COMPONENT.PARAMETER=VALUE",
        help="Another value of a parameter or of a shared value. May be repeated.",
    ),
]
RunSize = Annotated[
    list[str] | None,
    typer.Option(
        "--size",
        metavar="COMPONENT.SIZE=NUMBER",
        help="Build a component in another size. May be repeated.",
    ),
]
Coupling = Annotated[
    str | None,
    typer.Option(
        metavar="paper|impulse|jacobi",
        help="Scheme of exchange of a case, by default its first; waves or plain for spt.",
    ),
]
Model = Annotated[
    str | None,
    typer.Option(
        metavar="calibrated|literal|one-law",
        help="Model of the sand of a case; default calibrated.",
    ),
]
System = Annotated[
    str,
    typer.Argument(metavar="CASE|SYSTEM.toml", help="A case of `rockshed list`, or a system file."),
]


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"rockshed {version('rockshed')}")
        raise typer.Exit


@app.callback()
def _every_command(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_version, is_eager=True, help="Print the version and end."
        ),
    ] = False,
) -> None:
    pass


@contextmanager
def _screen(quiet: bool = False, as_json: bool = False) -> "Iterator[Screen]":
    """The screen of a command; refusals and failures become messages and exit codes."""
    from ..core.errors import InputRefused
    from .screen import INTERRUPTED, REFUSED, RUN_FAILED, Screen

    screen = Screen(quiet, as_json)
    try:
        yield screen
    except InputRefused as refusal:
        screen.refuse(refusal.problems)
        raise typer.Exit(REFUSED) from None
    except KeyboardInterrupt:
        screen.fail("interrupted")
        raise typer.Exit(INTERRUPTED) from None
    except OSError as error:
        screen.fail(str(error))
        raise typer.Exit(RUN_FAILED) from error


@app.command("list")
def list_() -> None:
    """Cases and components."""
    from rockshed.components.catalogue import NAMES, component

    from ..cases.registry import cases
    from .screen import plain_table

    with _screen() as screen:
        table = plain_table("case", "")
        for case in cases().values():
            table.add_row(" = ".join((case.name, *case.other_names)), case.summary)
        parts = plain_table("component", "", "sizes")
        for name in NAMES:
            found = component(name)
            parts.add_row(
                name,
                found.title,
                ", ".join(f"{size} = {entry.default}" for size, entry in found.sizes.items()),
            )
        screen.show(table, "", parts)


@app.command()
def build(
    components: Annotated[
        list[str] | None, typer.Argument(metavar="COMPONENT", help="All of them by default.")
    ] = None,
    size: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=NUMBER", help="A size other than the default. May be repeated."),
    ] = None,
    runtime: Annotated[
        str | None,
        typer.Option(
            metavar="python|native|both",
            help="FMUs with Python inside, which every "
            "processor runs, or native ones, which need no Python. By default python, "
            "with --fmi 3 native.",
        ),
    ] = None,
    fmi: Annotated[
        int,
        typer.Option(metavar="2|3", help="Version of FMI. That of 3.0 is for native FMUs only."),
    ] = 2,
    platform: Annotated[
        list[str] | None,
        typer.Option(
            metavar="linux64|win64|darwin64",
            help="Of native FMUs; by default this machine's. May be repeated.",
        ),
    ] = None,
    output_dir: Annotated[
        Path | None,
        typer.Option(help="The FMUs go into its folders python, native and native-fmi3."),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Build FMUs, always anew."""
    from ..runs.building import Export, build_all
    from .assignments import sizes_of

    with _screen(quiet) as screen, screen.busy("building"):
        problems = list[Problem]()
        sizes, export = sizes_of(size or [], problems), Export(runtime, platform or [], fmi)
        for file in build_all(components or [], sizes, output_dir, export, problems):
            screen.say(f"{file}  {file.stat().st_size / 1024:.0f} KiB")


@app.command()
def info(
    target: Annotated[
        str,
        typer.Argument(
            metavar="FMU|CASE|SYSTEM.toml",
            help="An FMU, also a stranger's, a case, or a system file.",
        ),
    ],
    toml: Annotated[
        bool, typer.Option("--toml", help="Print the system as a file that `rockshed run` takes.")
    ] = False,
    model: Model = None,
) -> None:
    """What is in an FMU or a system: ports, values, connections."""
    from ..runs.export import system_text
    from ..runs.inspection import describe_fmu, describe_system
    from ..runs.job import Request, prepare

    with _screen() as screen:
        if target.endswith(".fmu"):
            screen.overview(describe_fmu(Path(target)))
        elif toml:
            screen.out.file.write(system_text(prepare(Request(target, model=model)).system))
        else:
            screen.overview(describe_system(prepare(Request(target, model=model))))


@app.command()
def export(
    target: System,
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="A new or empty folder.")],
    set_: Set = None,
    size: RunSize = None,
    coupling: Coupling = None,
    model: Model = None,
) -> None:
    """Write a system as TOML, with its FMUs, to change and run it."""
    from ..runs.export import export_system
    from ..runs.job import Request, prepare
    from .assignments import sizes_of, values_of

    with _screen() as screen:
        problems = list[Problem]()
        values, sizes = values_of("--set", set_ or [], problems), sizes_of(size or [], problems)
        request = Request(target, values, sizes, coupling, model=model)
        job = prepare(request, screen.note, problems)
        screen.say(str(export_system(job.system, folder)))


@app.command()
def run(
    target: System,
    set_: Set = None,
    size: RunSize = None,
    output_dir: Annotated[
        Path | None, typer.Option(help="Folder of the results; default results/CASE.")
    ] = None,
    stop_time: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="End of the run.")
    ] = None,
    exchange_step: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="Time between two exchanges.")
    ] = None,
    output_interval: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="Time between two rows.")
    ] = None,
    state_interval: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="Time between two recorded states of the sand."),
    ] = None,
    master: Annotated[
        str | None,
        typer.Option(
            metavar="sequential|jacobi", help="One component after the other, or all at once."
        ),
    ] = None,
    model: Model = None,
    coupling: Coupling = None,
    allow_unstable: Annotated[
        bool, typer.Option("--allow-unstable", help="Run with steps above the stable ones.")
    ] = False,
    load_cell: Annotated[
        float | None,
        typer.Option(
            metavar="HERTZ",
            help="Show the peak transmitted force also as a load "
            "cell with this cut-off frequency does.",
        ),
    ] = None,
    runtime: Annotated[
        str,
        typer.Option(
            metavar="auto|native|python",
            help="FMUs of a case: native, with Python inside, or "
            "native if they are there and up to date.",
        ),
    ] = "auto",
    in_process: Annotated[
        bool, typer.Option("--in-process", help="Components without FMUs, in this process.")
    ] = False,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw nothing.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run a case or a system file, compare, draw.

    FMUs of a case that are missing are built.
    """
    from ..runs.job import Request
    from .assignments import sizes_of, values_of
    from .screen import INTERRUPTED, RUN_FAILED

    problems = list[Problem]()
    options = {
        "stop_time": stop_time,
        "exchange_step": exchange_step,
        "output_interval": output_interval,
        "state_interval": state_interval,
        "master": master,
    }
    request = Request(
        target,
        values_of("--set", set_ or [], problems),
        sizes_of(size or [], problems),
        coupling,
        {k: v for k, v in options.items() if v is not None},
        in_process,
        load_cell,
        model,
        runtime,
    )
    with _screen(quiet, as_json) as screen:
        done = _simulate(request, problems, output_dir, allow_unstable, screen)
        if (
            done.status == "failed"
        ):  # said before drawing, which takes its time and may be interrupted
            screen.fail(str(done.provenance["error"]))
        if done.status == "interrupted":
            screen.warn(
                f"interrupted at t = {1e3 * done.series['time'][-1]:g} ms; the results until then are kept"
            )
        drawn = _finish(done, screen, not no_figures)
        if done.status == "failed":
            raise typer.Exit(RUN_FAILED)
        if done.status == "interrupted" or not drawn:
            raise typer.Exit(INTERRUPTED)


def _simulate(
    request: "Request",
    problems: "list[Problem]",
    output_dir: Path | None,
    allow_unstable: bool,
    screen: "Screen",
) -> "Run":
    """Prepare and carry out a run; one that fails or is interrupted gives what was computed until then."""
    with screen.progress("preparing") as progress:
        from ..core.errors import RunFailed
        from ..core.results.metric import Metrics
        from ..core.results.reading import add_metrics, read_run
        from ..core.run import simulate
        from ..metrics import comparison
        from ..runs.building import is_cold
        from ..runs.job import prepare
        from .screen import COLD_START

        job = prepare(request, screen.note, problems)
        if "runtime" in job.facts:
            screen.note(f"{job.facts['runtime']} FMUs ({job.facts['runtime_reason']})")
        folder = output_dir or RESULTS / job.name
        if is_cold(job.components):
            progress.describe(COLD_START)
        try:
            announce(folder)
            done = simulate(
                job.system,
                folder,
                sources=job.sources,
                allow_unstable=allow_unstable,
                progress=progress,
                facts=job.facts,
            )
        except RunFailed:
            done = read_run(folder)  # status and reason are in it
    figures = comparison.figures(done, comparison.known_of(done))
    add_metrics(folder, figures)
    return replace(done, metrics=Metrics([*done.metrics.values(), *figures]))


def _report_crash(folder: Path | None, reason: str) -> int:
    """Say which component has crashed, and keep what was computed; return the exit code."""
    from ..core.loop.journal import last_entry
    from ..core.results.run_folder import keep_crashed, running_folder
    from .screen import RUN_FAILED

    with _screen() as screen:
        if folder is None or not running_folder(folder).is_dir():
            screen.fail(f"the command crashed ({reason})")
            return RUN_FAILED
        error = last_entry(running_folder(folder), reason)
        kept = keep_crashed(folder, error, warnings=[])
        screen.fail(error)
        screen.say(f"results in {folder}" if kept else "nothing was computed")
    return RUN_FAILED


def _finish(done: "Run", screen: "Screen", with_figures: bool) -> bool:
    """Draw the figures, then show the table or its JSON; of a run that failed, only where its results are.

    False if Ctrl-C has ended the drawing; the results are shown all the same.
    """
    from ..metrics import comparison

    figures, drawn = list[Path](), True
    try:
        figures = _draw(done, done.folder / "figures", screen) if with_figures else []
    except KeyboardInterrupt:
        screen.warn(
            f"drawing was interrupted; `rockshed plot {quoted(str(done.folder))}` draws the pictures"
        )
        drawn = False
    warnings = comparison.warnings(done)
    for text in warnings:
        screen.warn(text)
    if screen.as_json:
        screen.dump(
            {
                "status": done.status,
                "folder": str(done.folder),
                "error": done.provenance.get("error"),
                "warnings": warnings,
                "caption": comparison.caption(done),
                "figures": [figure.as_entry() for figure in done.metrics.values()],
                "pictures": [str(file) for file in figures],
            }
        )
        return drawn
    if done.status != "failed":
        _show_table(done, screen)
    screen.say(
        f"results in {done.folder}"
        + (f", {len(figures)} pictures in {figures[0].parent}" if figures else "")
    )
    return drawn


def _show_table(done: "Run", screen: "Screen") -> None:
    from ..metrics import comparison

    known = comparison.known_of(done)
    for line in comparison.caption(done):
        screen.say(line)
    screen.show("", comparison.table(done, known), "")
    for line in comparison.notes(done, known):
        screen.say(line)


def _draw(done: "Run", folder: Path, screen: "Screen") -> list[Path]:
    with screen.busy("drawing"):
        from ..pictures import draw_all

        return draw_all(done, folder, screen.note, screen.warn)


@app.command()
def plot(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run, finished or not.")],
    output_dir: Annotated[
        Path | None, typer.Option(help="Folder of the pictures; default RUN/figures.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Draw a run again, also one that failed or was killed."""
    with _screen(quiet) as screen:
        from ..core.errors import InputRefused, Problem
        from ..core.results.reading import read_run
        from ..core.results.run_folder import running_folder

        found = read_run(run)
        if found.folder.absolute() == run.absolute() and running_folder(run.absolute()).exists():
            screen.warn(f"there is a newer run that has not ended, in {running_folder(run)}")
        if not found.series["time"].size:
            raise InputRefused(
                [
                    Problem(
                        str(found.folder),
                        "the run was ended before its first row was written",
                        "run it again",
                    )
                ]
            )
        if found.status != "complete":
            screen.warn(
                f"this run is not complete ({found.status}): pictures show what was computed until "
                f"t = {1e3 * found.series['time'][-1]:g} ms"
            )
        for file in _draw(found, output_dir or found.folder / "figures", screen):
            screen.say(str(file))


@app.command()
def bench(
    part: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="discs|coupling|exchange|start|rockfall|cluster", help="All of them by default."
        ),
    ] = None,
    rounds: Annotated[
        int, typer.Option(min=3, help="Rounds in which everything takes its turn.")
    ] = 7,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Measure speed and price of the coupling.

    All figures are ratios within interleaved rounds. Takes some minutes.
    """
    with _screen(quiet, as_json) as screen:
        from ..bench.table import PARTS
        from ..core.errors import InputRefused, Problem
        from .screen import CHECK_FAILED, plain_table

        wanted = part or list(PARTS)
        if unknown := [name for name in wanted if name not in PARTS]:
            raise InputRefused(
                [
                    Problem(name, "is no part of the benchmark", f"choose of {', '.join(PARTS)}")
                    for name in unknown
                ]
            )
        rows = []
        for name in wanted:
            with screen.busy(f"measuring: {name}"):
                rows += list(PARTS[name](rounds))
        if as_json:
            screen.dump([asdict(row) for row in rows])
        else:
            table = plain_table(
                "figure", "measured", "unit", "as a multiple of", "goal", right=("measured",)
            )
            for row in rows:
                goal = "" if row.goal is None else f"at most {row.goal:.3g}"
                table.add_row(
                    row.name,
                    "-" if row.value is None else f"{row.value:.3g}",
                    row.unit,
                    row.compared_with,
                    goal,
                )
            screen.show(table)
        if any(row.is_missed for row in rows):
            raise typer.Exit(CHECK_FAILED)


@app.command()
def reproduce(
    paper: Annotated[
        str, typer.Argument(metavar="PAPER", help="sonoda1993, mogami1973 or ushiro.")
    ],
    only: Annotated[
        list[str] | None, typer.Option(metavar="STUDY", help="This study only. May be repeated.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="One run where the full reproduction has ten seeds.")
    ] = False,
    output_dir: Annotated[
        Path | None, typer.Option(help="Folder of the results; default results/PAPER.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes at a time; default: one for each core.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Carry out the studies of a paper.

    Computed figures stand beside printed and measured ones: table, JSON, figures, HTML page.
    """
    from .screen import INTERRUPTED

    with _screen(quiet, as_json) as screen:
        from ..papers.reproduction import reproduce

        folder = output_dir or RESULTS / paper
        with screen.counting("runs") as done:
            made = reproduce(paper, folder, only or [], quick, workers, screen.note, done)
        if as_json:
            screen.dump(made.content)
        else:
            screen.show(*made.tables())
            for part in made.parts:
                for text in part.study.notes:
                    screen.say(f"{part.study.name}: {text}")
            screen.say(
                f"results in {folder}: "
                + ", ".join(file.name for file in made.files)
                + f", {sum(len(part.figures) for part in made.parts)} figures"
            )
        if made.interrupted:
            screen.warn("interrupted: rows without a figure were not run")
            raise typer.Exit(INTERRUPTED)


@app.command()
def calibrate(
    target: Annotated[
        str | None,
        typer.Argument(
            metavar="[CURVE.csv|sonoda1993]",
            show_default=False,
            help="Measured "
            "load-penetration curve, columns `penetration (cm)` and `load (kgf)` "
            "or other units; or table 4 of the paper.",
        ),
    ] = None,
    stiffness: Annotated[
        str | None,
        typer.Option(
            metavar="'NUMBER UNIT'",
            help="Measured secant spring constant at 4 cm instead: '39.1 kgf/cm', '38.3 kN/m'.",
        ),
    ] = None,
    rotation: Annotated[
        str,
        typer.Option(
            metavar="locked|free|fit",
            help="Rotation model of the sand; fit: the one that has the curve.",
        ),
    ] = "locked",
    set_: Set = None,
    seeds: Annotated[int, typer.Option(min=2, help="Samples of the sand for each E_bar.")] = 5,
    output_dir: Annotated[
        Path | None, typer.Option(help="Folder of the results; default results/calibration.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes at a time; default: one for each core.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find E_bar of a sand from a measured spring constant or load-penetration curve, by the static test."""
    from .screen import RUN_FAILED

    with _screen(quiet, as_json) as screen:
        from ..core.errors import InputRefused, RunFailed
        from .assignments import values_of
        from .calibrate import show_calibration

        problems = list[Problem]()
        values = values_of("--set", set_ or [], problems)
        if problems:
            raise InputRefused(problems)
        try:
            show_calibration(
                screen,
                RESULTS,
                target,
                stiffness=stiffness,
                rotation=rotation,
                values=values,
                seeds=seeds,
                output_dir=output_dir,
                workers=workers,
            )
        except RunFailed as failure:
            screen.fail(str(failure))
            raise typer.Exit(RUN_FAILED) from None


@app.command()
def rockfall(
    site: Annotated[
        Path,
        typer.Argument(
            metavar="PROFILE.toml", help="Rock, profile, ground, search lines, barriers."
        ),
    ],
    trials: Annotated[
        int | None, typer.Option(min=1, help="Number of trials; default: the file's, or 10,000.")
    ] = None,
    preset: Annotated[str | None, typer.Option(metavar="paper", help="paper: 200 trials.")] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Another sample.")] = None,
    replay: Annotated[
        list[int] | None, typer.Option(metavar="TRIAL", help="Animate this trial. May be repeated.")
    ] = None,
    animation: Annotated[
        str | None, typer.Option(metavar="mp4|gif", help="Default: mp4 if it can be written.")
    ] = None,
    output_dir: Annotated[
        Path | None, typer.Option(help="Folder of the results; default results/NAME.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1, help="Threads, or processes of --scheduler local; default: one for each core."
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="local|tcp://HOST:PORT",
            help="Compute on Dask: on processes "
            "of this computer, or on the workers of a running scheduler.",
        ),
    ] = None,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw nothing.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Monte Carlo of rockfall on a slope: envelopes, percentiles with confidence intervals, end points, replays."""
    from .screen import RUN_FAILED

    with _screen(quiet, as_json) as screen:
        from ..analyses.rockfall.campaign import CampaignFailed
        from .rockfall import show_rockfall

        try:
            show_rockfall(
                screen,
                RESULTS,
                site,
                trials=trials,
                preset=preset,
                seed=seed,
                replays=replay or [],
                animation=animation,
                output_dir=output_dir,
                workers=workers,
                scheduler=scheduler,
                pictures=not no_figures,
            )
        except CampaignFailed as failure:
            screen.fail(str(failure))
            raise typer.Exit(RUN_FAILED) from None


@app.command()
def pile(
    site: Annotated[
        Path,
        typer.Argument(
            metavar="PILE.toml", help="Hammer, cushion, rod, soil, blows, bearing graph."
        ),
    ],
    blows: Annotated[
        int | None, typer.Option(min=1, help="Number of blows; default: the file's, or 1.")
    ] = None,
    output_dir: Annotated[
        Path | None, typer.Option(help="Folder of the results; default results/NAME.")
    ] = None,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw nothing.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Wave analysis of a driven pile or rod: set per blow, stresses, bearing graph, residual stress."""
    with _screen(quiet, as_json) as screen:
        from .pile import show_pile

        show_pile(
            screen, RESULTS, site, blows=blows, output_dir=output_dir, pictures=not no_figures
        )


def main() -> None:
    """The entry point of the command ``rockshed``."""
    gc.set_threshold(_OBJECTS_BEFORE_COLLECTION)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a terminal that knows no Greek shows ? in its place
            stream.reconfigure(errors="replace")
    work = partial(app, prog_name="rockshed")
    if sys.argv[1:2] == ["run"]:  # the code of FMUs may crash
        supervised(work, [sys.executable, "-m", f"{__package__}.app", *sys.argv[1:]], _report_crash)
    else:
        work()


if __name__ == "__main__":
    main()
