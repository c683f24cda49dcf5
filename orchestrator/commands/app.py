"""The command line ``rockshed``: its commands are loaded when they are used."""

import atexit
import gc
import sys
from functools import partial
from io import TextIOWrapper
from typing import Annotated

import typer

from ..core.supervisor import Ending, supervised
from .lazy import STYLE, LazyCommands

_OBJECTS_BEFORE_COLLECTION = 200_000
"""Objects after which garbage is looked for. Imports make many objects and no garbage.

Every 700 objects, as Python does by itself, takes a twentieth of the start.
"""

COMMANDS = {
    "init": "Write a commented project file; nothing is overwritten.",
    "list": "List all cases and components.",
    "build": "Build FMUs of components, always anew.",
    "info": "Show an FMU, a component or a system: ports, values, connections.",
    "simulate": "Simulate one FMU alone, with its inputs from a CSV file.",
    "check": "Check any FMU: description, life cycle, steps, states, wrong values.",
    "export": "Write a system with its FMUs as TOML or SSP, or a run for others.",
    "run": "Run a case, a project or a system file, compare, draw.",
    "resume": "Let a run or an analysis that was ended go on.",
    "branch": "Run variants of a run from one of its states.",
    "verify": "Run a run again and compare every bit of its results.",
    "plot": "Draw a run again, also one that failed; or variables of several.",
    "animate": "Animate rock, sand with its force chains, and beam of a run; trials of a campaign.",
    "report": "Write a report that a reviewer can check: HTML page and PDF.",
    "page": "Write a page that computes an impact in the browser.",
    "bench": "Measure speed and price of the coupling.",
    "reproduce": "Carry out the studies of a paper.",
    "calibrate": "Find parameters from measurements, of a sand by default.",
    "converge": "Compare finer and finer exchange steps, or meshes of a shed.",
    "study": "Run a system with values that vary: designs, Monte Carlo, sensitivity.",
    "rockfall": "Monte Carlo of rockfall on a slope: envelopes, percentiles, end points, replays.",
    "formula": "Impact force by formulas of practice: Japanese handbook, ASTRA, Labiouse, Hertz.",
    "pile": "Wave analysis of a driven pile or rod: set per blow, stresses, bearing graph.",
    "doctor": "Look at kept code, compilers, leftovers of killed runs, and what is slow.",
}
"""Commands by name, each a module of this package, with the first line of its help."""


_DRIVING = ("run", "resume", "branch", "verify", "simulate")
"""Commands in whose process the code of FMUs runs."""


class Rockshed(LazyCommands):
    """All commands of the program, those of :data:`COMMANDS`."""

    known = COMMANDS


app = typer.Typer(
    name="rockshed",
    cls=Rockshed,
    no_args_is_help=True,
    help="Rockfall protection as FMI co-simulation: falling rock, sand cushion and beam as FMUs.",
    epilog="`rockshed run lab-impact` is where to begin; `rockshed COMMAND --help` tells the "
    "options. Exit codes: 0 done, 1 the run failed (what was computed is kept), 2 refused (nothing "
    "was computed or left behind), 3 a check failed or a strict run has warnings, 130 interrupted "
    "with Ctrl-C (what was computed is kept).",
    **STYLE,
)


def _version(wanted: bool) -> None:
    if wanted:
        from .. import __version__

        typer.echo(f"rockshed {__version__}")
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


def main() -> None:
    """Run the command ``rockshed`` of the words that it was started with."""
    gc.set_threshold(_OBJECTS_BEFORE_COLLECTION)
    atexit.register(gc.freeze)  # the end would look for garbage among all that was imported
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a terminal that knows no Greek shows ? in its place
            stream.reconfigure(errors="replace")
    work = partial(app, prog_name="rockshed")
    if sys.argv[1:2] and sys.argv[1] in _DRIVING:  # the code of FMUs may crash
        command = [sys.executable, "-P", "-m", "rockshed", *sys.argv[1:]]
        supervised(work, command, _report_crash)
    else:
        work()


def _report_crash(ending: Ending) -> int:
    from .crash import report_crash  # what crashes has not been imported here

    return report_crash(ending)


if __name__ == "__main__":
    main()
