"""The command line ``rockshed``. Commands import what they need when they run, so that help is there at once."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from .core.reading import Run
    from .job import Request
    from .screen import Screen

RESULTS = Path("results")
"""Folder of the runs that name no other."""

app = typer.Typer(name="rockshed", no_args_is_help=True, add_completion=False, pretty_exceptions_show_locals=False,
                  context_settings={"help_option_names": ["-h", "--help"]},
                  help="Rockfall protection as FMI co-simulation: falling rock, sand cushion and beam as FMUs.")

Json = Annotated[bool, typer.Option("--json", help="Print the results as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress and no notes: results, warnings and errors only.")]
Set = Annotated[list[str] | None, typer.Option("--set", metavar="COMPONENT.PARAMETER=VALUE",
                                               help="Another value of a parameter or of a shared value. May be repeated.")]
RunSize = Annotated[list[str] | None, typer.Option("--size", metavar="COMPONENT.SIZE=NUMBER",
                                                   help="Build a component in another size. May be repeated.")]


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"rockshed {version('rockshed')}")
        raise typer.Exit


@app.callback()
def _every_command(version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True,
                                                         help="Print the version and end.")] = False) -> None:
    pass


@contextmanager
def _screen(quiet: bool = False, as_json: bool = False) -> "Iterator[Screen]":
    """The screen of a command; refusals and failures become messages and exit codes."""
    from .core.errors import InputRefused
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
    from components.catalogue import NAMES, component

    from .cases.registry import cases
    from .screen import plain_table

    with _screen() as screen:
        table = plain_table("case", "")
        for case in cases().values():
            table.add_row(case.name, case.summary)
        parts = plain_table("component", "", "sizes")
        for name in NAMES:
            found = component(name)
            parts.add_row(name, found.title, ", ".join(f"{size} = {entry.default}" for size, entry in found.sizes.items()))
        screen.show(table, "", parts)


@app.command()
def build(components: Annotated[list[str] | None, typer.Argument(metavar="[COMPONENT]...", help="All of them by default.")] = None,
          size: Annotated[list[str] | None, typer.Option(metavar="NAME=NUMBER", help="A size other than the default. May be "
                                                         "repeated.")] = None,
          output_dir: Annotated[Path | None, typer.Option(help="Folder of the FMUs.")] = None, quiet: Quiet = False) -> None:
    """Build FMUs, always anew."""
    from .building import build_all

    with _screen(quiet) as screen:
        for file in build_all(components or [], size or [], output_dir):
            screen.say(f"{file}  {file.stat().st_size / 1024:.0f} KiB")


@app.command()
def info(target: Annotated[str, typer.Argument(metavar="FMU|CASE|SYSTEM.toml")],
         toml: Annotated[bool, typer.Option("--toml", help="Print the system as a file that `rockshed run` takes.")] = False,
         ) -> None:
    """What is in an FMU or in a system: ports, steps, values, connections."""
    from .export import system_text
    from .inspection import show_fmu, show_system
    from .job import Request, prepare

    with _screen() as screen:
        if target.endswith(".fmu"):
            screen.show(*show_fmu(Path(target)))
        elif toml:
            screen.out.file.write(system_text(prepare(Request(target)).system))
        else:
            screen.show(*show_system(prepare(Request(target))))


@app.command()
def export(target: Annotated[str, typer.Argument(metavar="CASE|SYSTEM.toml")],
           folder: Annotated[Path, typer.Argument(help="A new or empty folder.")],
           set_: Set = None, size: RunSize = None, coupling: Annotated[str | None, typer.Option()] = None) -> None:
    """Write a system as TOML, with its FMUs, to change and run it."""
    from .export import export_system
    from .job import Request, prepare

    with _screen() as screen:
        job = prepare(Request(target, set_ or [], size or [], coupling), screen.note)
        screen.say(str(export_system(job.system, folder)))


@app.command()
def run(target: Annotated[str, typer.Argument(metavar="CASE|SYSTEM.toml", help="A case of `rockshed list`, or a system file.")],
        set_: Set = None, size: RunSize = None,
        output_dir: Annotated[Path | None, typer.Option(help="Folder of the results; default results/CASE.")] = None,
        stop_time: Annotated[float | None, typer.Option(metavar="SECONDS", help="End of the run.")] = None,
        exchange_step: Annotated[float | None, typer.Option(metavar="SECONDS", help="Time between two exchanges.")] = None,
        output_interval: Annotated[float | None, typer.Option(metavar="SECONDS", help="Time between two rows.")] = None,
        state_interval: Annotated[float | None, typer.Option(metavar="SECONDS", help="Time between two recorded states of the "
                                                             "sand.")] = None,
        master: Annotated[str | None, typer.Option(metavar="sequential|jacobi", help="One component after the other, or "
                                                     "all at once.")] = None,
        coupling: Annotated[str | None, typer.Option(metavar="paper|impulse|jacobi", help="Scheme of exchange of a case.")] = None,
        allow_unstable: Annotated[bool, typer.Option("--allow-unstable", help="Run with steps above the stable ones.")] = False,
        in_process: Annotated[bool, typer.Option("--in-process", help="Components without FMUs, in this process.")] = False,
        no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw nothing.")] = False,
        as_json: Json = False, quiet: Quiet = False) -> None:
    """Run a case or a system file, compare, draw; build what is missing."""
    from .job import Request
    from .screen import INTERRUPTED, RUN_FAILED

    options = {"stop_time": stop_time, "exchange_step": exchange_step, "output_interval": output_interval,
               "state_interval": state_interval, "master": master}
    request = Request(target, set_ or [], size or [], coupling, {k: v for k, v in options.items() if v is not None}, in_process)
    with _screen(quiet, as_json) as screen:
        done = _simulate(request, output_dir, allow_unstable, screen)
        _finish(done, screen, not no_figures)
        if done.status == "interrupted":
            screen.warn(f"interrupted at t = {1e3 * done.series['time'][-1]:g} ms; the results until then are kept")
            raise typer.Exit(INTERRUPTED)
        if done.status == "failed":
            screen.fail(str(done.provenance["error"]))
            raise typer.Exit(RUN_FAILED)


def _simulate(request: "Request", output_dir: Path | None, allow_unstable: bool, screen: "Screen") -> "Run":
    """Prepare and carry out a run; one that fails or is interrupted gives what was computed until then."""
    with screen.progress("preparing") as progress:
        from .building import is_cold
        from .core.errors import RunFailed
        from .core.reading import add_figures, read_run
        from .core.run import simulate
        from .headlines import headlines
        from .job import prepare
        from .screen import COLD_START

        job = prepare(request, screen.note)
        folder = output_dir or RESULTS / job.name
        if is_cold():
            progress.describe(COLD_START)
        try:
            done = simulate(job.system, folder, sources=job.sources, allow_unstable=allow_unstable, progress=progress,
                            facts=job.facts)
        except RunFailed:
            done = read_run(folder)  # status and reason are in it
    figures = headlines(done)
    add_figures(folder, figures)
    return replace(done, summary=[*done.summary, *figures])


def _finish(done: "Run", screen: "Screen", with_figures: bool) -> None:
    """Draw the figures, then show the table or its JSON; of a run that failed, only where its results are."""
    from . import comparison

    figures = _draw(done, done.folder / "figures", screen) if with_figures else []
    known, warnings = comparison.known_of(done), comparison.warnings(done)
    for text in warnings:
        screen.warn(text)
    if screen.as_json:
        screen.dump({"status": done.status, "folder": str(done.folder), "error": done.provenance.get("error"),
                     "warnings": warnings, "caption": comparison.caption(done),
                     "figures": comparison.figures_with(done, known), "pictures": [str(file) for file in figures]})
        return
    if done.status != "failed":
        _show_table(done, screen)
    screen.say(f"results in {done.folder}" + (f", {len(figures)} pictures in {figures[0].parent}" if figures else ""))


def _show_table(done: "Run", screen: "Screen") -> None:
    from . import comparison

    known = comparison.known_of(done)
    for line in comparison.caption(done):
        screen.say(line)
    screen.show("", comparison.table(done, known), "")
    for line in comparison.notes(done, known):
        screen.say(line)


def _draw(done: "Run", folder: Path, screen: "Screen") -> list[Path]:
    with screen.busy("drawing"):
        from .pictures import draw_all

        try:
            return draw_all(done, folder, screen.note, screen.warn)
        except KeyboardInterrupt:
            screen.note(f"the results are complete; `rockshed plot {done.folder}` draws the pictures")
            raise


@app.command()
def plot(run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run, finished or not.")],
         output_dir: Annotated[Path | None, typer.Option(help="Folder of the pictures; default RUN/figures.")] = None,
         quiet: Quiet = False) -> None:
    """Draw a run again, also one that failed or was interrupted or killed."""
    with _screen(quiet) as screen:
        from .core.errors import InputRefused, Problem
        from .core.reading import read_run
        from .core.results import running_folder

        found = read_run(run)
        if found.folder.absolute() == run.absolute() and running_folder(run.absolute()).exists():
            screen.warn(f"there is a newer run that has not ended, in {running_folder(run)}")
        if not found.series["time"].size:
            raise InputRefused([Problem(str(found.folder), "the run was ended before its first row was written",
                                        "run it again")])
        if found.status != "complete":
            screen.warn(f"this run is not complete ({found.status}): pictures show what was computed until "
                        f"t = {1e3 * found.series['time'][-1]:g} ms")
        for file in _draw(found, output_dir or found.folder / "figures", screen):
            screen.say(str(file))


@app.command()
def bench(part: Annotated[list[str] | None, typer.Argument(metavar="[discs|coupling|start]...", help="All of them by "
                                                           "default.")] = None,
          rounds: Annotated[int, typer.Option(min=3, help="Rounds in which everything takes its turn.")] = 7,
          as_json: Json = False, quiet: Quiet = False) -> None:
    """Measure speed and price of the coupling, in ratios within interleaved rounds. Takes about two minutes."""
    with _screen(quiet, as_json) as screen:
        from .bench.table import PARTS
        from .core.errors import InputRefused, Problem
        from .screen import CHECK_FAILED, plain_table

        wanted = part or list(PARTS)
        if unknown := [name for name in wanted if name not in PARTS]:
            raise InputRefused([Problem(name, "is no part of the benchmark", f"choose of {', '.join(PARTS)}") for name in unknown])
        rows = []
        for name in wanted:
            with screen.busy(f"measuring: {name}"):
                rows += list(PARTS[name](rounds))
        if as_json:
            screen.dump([asdict(row) for row in rows])
        else:
            table = plain_table("figure", "measured", "unit", "as a multiple of", "goal", right=("measured",))
            for row in rows:
                goal = "" if row.goal is None else f"at most {row.goal:.3g}"
                table.add_row(row.name, f"{row.value:.3g}", row.unit, row.compared_with, goal)
            screen.show(table)
        if any(row.goal is not None and row.value > row.goal for row in rows):
            raise typer.Exit(CHECK_FAILED)


@app.command()
def reproduce(paper: Annotated[str, typer.Argument(metavar="PAPER", help="sonoda1993 or ushiro.")],
              only: Annotated[list[str] | None, typer.Option(metavar="STUDY", help="This study only. May be repeated.")] = None,
              quick: Annotated[bool, typer.Option("--quick", help="One run where the full reproduction has ten seeds.")] = False,
              output_dir: Annotated[Path | None, typer.Option(help="Folder of the results; default results/PAPER.")] = None,
              workers: Annotated[int | None, typer.Option(min=1, help="Processes at a time; default: one for each core.")] = None,
              as_json: Json = False, quiet: Quiet = False) -> None:
    """Run the studies of a paper and set computed beside printed and measured figures: table, JSON, figures, HTML page."""
    from .screen import INTERRUPTED

    with _screen(quiet, as_json) as screen:
        from .studies.report import table
        from .studies.reproduction import reproduce

        folder = output_dir or RESULTS / paper
        with screen.counting("runs") as done:
            made = reproduce(paper, folder, only or [], quick, workers, screen.note, done)
        if as_json:
            screen.dump(made.content)
        else:
            screen.show(table(made.parts))
            for part in made.parts:
                for text in part.study.notes:
                    screen.say(f"{part.study.name}: {text}")
            screen.say(f"results in {folder}: " + ", ".join(file.name for file in made.files)
                       + f", {sum(len(part.figures) for part in made.parts)} figures")
        if made.interrupted:
            screen.warn("interrupted: rows without a figure were not run")
            raise typer.Exit(INTERRUPTED)


@app.command()
def rockfall(site: Annotated[Path, typer.Argument(metavar="PROFILE.toml", help="Rock, profile, ground, search lines, barriers.")],
             trials: Annotated[int | None, typer.Option(min=1, help="Number of trials; default: the file's, or 10,000.")] = None,
             preset: Annotated[str | None, typer.Option(metavar="paper", help="paper: 200 trials.")] = None,
             seed: Annotated[int | None, typer.Option(min=0, help="Another sample.")] = None,
             replay: Annotated[list[int] | None, typer.Option(metavar="TRIAL", help="Animate this trial. May be repeated.")] = None,
             animation: Annotated[str | None, typer.Option(metavar="mp4|gif", help="Default: mp4 if it can be written.")] = None,
             output_dir: Annotated[Path | None, typer.Option(help="Folder of the results; default results/NAME.")] = None,
             workers: Annotated[int | None, typer.Option(min=1, help="Threads; default: one for each core.")] = None,
             no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw nothing.")] = False,
             as_json: Json = False, quiet: Quiet = False) -> None:
    """Monte Carlo of rockfall on a slope: envelopes, percentiles with confidence intervals, end points, replays."""
    with _screen(quiet, as_json) as screen:
        from .rockfall.command import rockfall

        rockfall(screen, RESULTS, site, trials, preset, seed, replay or [], animation, output_dir, workers, not no_figures)


def main() -> None:
    """The entry point of the command ``rockshed``."""
    app()


if __name__ == "__main__":
    main()
