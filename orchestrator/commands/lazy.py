"""Groups of commands that are imported when they are used."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any, ClassVar

import typer
from typer.core import TyperCommand, TyperGroup

from .words import options_here

STYLE: dict[str, Any] = {
    "add_completion": False,
    "pretty_exceptions_show_locals": False,
    "rich_markup_mode": None,  # its help shows every flag as if it took a value
    "context_settings": {"help_option_names": ["-h", "--help"], "max_content_width": 110},
}
"""Settings of every command and group."""


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

    def invoke(self, ctx: Any) -> Any:
        """Carry the command out; messages are in the words of its options."""
        with options_here({option for each in self.params for option in each.opts}):
            return super().invoke(ctx)


class LazyCommands(TyperGroup):
    """Commands that are modules of this package, imported when one of them is used.

    A module has a function ``command``, or, where the command has subjects, a class ``Subjects``.
    """

    known: ClassVar[Mapping[str, str]] = {}
    """First line of the help of each command by name."""
    prefix: ClassVar[str] = ""
    """Stands before the name of a command in that of its module."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands = dict.fromkeys(self.known)  # type: ignore[assignment]  # made when used

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Import a command and make it for typer; None if there is none of this name."""
        if cmd_name not in self.known:
            return None
        module = import_module(f".{self.prefix}{cmd_name}", __package__)
        if hasattr(module, "Subjects"):
            return _group(cmd_name, module.Subjects, str(module.__doc__))
        alone = typer.Typer(**STYLE)
        alone.command(cmd_name, cls=OnceEach)(module.command)
        return typer.main.get_command(alone)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the list of commands, for which none is imported."""
        with formatter.section("Commands"):
            formatter.write_dl(list(self.known.items()))


def _group(name: str, subjects: type[LazyCommands], text: str) -> Any:
    """Return the group of a command that has subjects."""
    alone = typer.Typer(name=name, cls=subjects, no_args_is_help=True, help=text, **STYLE)
    alone.callback()(lambda: None)
    return typer.main.get_command(alone)
