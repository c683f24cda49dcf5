"""The command line ``rockshed``: its commands are loaded when they are used."""

import gc
import sys
from functools import partial
from importlib import import_module
from io import TextIOWrapper
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from ..core.supervisor import Ending, supervised

_OBJECTS_BEFORE_COLLECTION = 100_000
"""Objects after which garbage is looked for. Imports make many objects and no garbage.

Every 700 objects, as Python does by itself, takes a twentieth of the start.
"""

COMMANDS = {
    "init": "Write a commented project file; nothing is overwritten.",
    "list": "List all cases and components.",
    "build": "Build FMUs of components, always anew.",
    "info": "Show an FMU, a component or a system: ports, values, connections.",
    "export": "Write a system as TOML with its FMUs, or a run in another format.",
    "run": "Run a case, a project or a system file, compare, draw.",
    "plot": "Draw a run again, also one that failed; or variables of several.",
    "animate": "Animate rock, sand with its force chains, and beam of a run.",
    "report": "Write a report that a reviewer can check: HTML page and PDF.",
    "bench": "Measure speed and price of the coupling.",
    "reproduce": "Carry out the studies of a paper.",
    "calibrate": "Find E_bar of a sand from a spring constant or a load-penetration curve.",
    "converge": "Compare a shed with coarser and finer discs and elements.",
    "rockfall": "Monte Carlo of rockfall on a slope: envelopes, percentiles, end points, replays.",
    "formula": "Impact force by formulas of practice: Japanese handbook, ASTRA, Labiouse, Hertz.",
    "pile": "Wave analysis of a driven pile or rod: set per blow, stresses, bearing graph.",
    "doctor": "Look at kept code, compilers, leftovers of killed runs, and what is slow.",
}
"""Commands by name, each a module of this package, with the first line of its help."""

_STYLE: dict[str, Any] = {
    "add_completion": False,
    "pretty_exceptions_show_locals": False,
    "rich_markup_mode": None,  # its help shows every flag as if it took a value
    "context_settings": {"help_option_names": ["-h", "--help"], "max_content_width": 110},
}


class OnceEach(TyperCommand):
    """A command that takes each option with a value once, unless it collects them."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Refuse an option that is given twice: the last one would hold in silence."""
        _, _, given = self.make_parser(ctx).parse_args(args=list(args))
        for option in given:
            collects = option.param_type_name != "option" or getattr(option, "multiple", False)
            is_flag = getattr(option, "is_flag", False)
            if given.count(option) > 1 and not collects and not is_flag:
                what = f"{option.opts[0]} is given {given.count(option)} times; keep one of them"
                raise typer.BadParameter(what, ctx)
        return super().parse_args(ctx, args)


class LazyCommands(TyperGroup):
    """The commands of :data:`COMMANDS`, imported when one of them is used."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands = dict.fromkeys(COMMANDS)  # type: ignore[assignment]  # made when used

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Import a command and make it for typer; None if there is none of this name."""
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f".{cmd_name}", __package__)
        alone = typer.Typer(**_STYLE)
        alone.command(cmd_name, cls=OnceEach)(module.command)
        return typer.main.get_command(alone)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the list of commands, for which none is imported."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


app = typer.Typer(
    name="rockshed",
    cls=LazyCommands,
    no_args_is_help=True,
    help="Rockfall protection as FMI co-simulation: falling rock, sand cushion and beam as FMUs.",
    epilog="`rockshed run lab-impact` is where to begin; `rockshed COMMAND --help` tells the "
    "options. Exit codes: 0 done, 1 the run failed (what was computed is kept), 2 refused (nothing "
    "was computed or left behind), 3 a check failed or a strict run has warnings, 130 interrupted "
    "with Ctrl-C (what was computed is kept).",
    **_STYLE,
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
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a terminal that knows no Greek shows ? in its place
            stream.reconfigure(errors="replace")
    work = partial(app, prog_name="rockshed")
    if sys.argv[1:2] == ["run"]:  # the code of FMUs may crash
        command = [sys.executable, "-P", "-m", "rockshed", *sys.argv[1:]]
        supervised(work, command, _report_crash)
    else:
        work()


def _report_crash(ending: Ending) -> int:
    from .crash import report_crash  # what crashes has not been imported here

    return report_crash(ending)


if __name__ == "__main__":
    main()
