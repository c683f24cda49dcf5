"""The command ``rockshed info``: the content of an FMU or a system."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from rockshed.components.catalogue import NAMES

from ..cases.registry import cases
from ..core.errors import InputRefused, Problem, all_causes, refusing_unwritable
from ..core.system.names import nearest
from ..files import write_file
from ..runs.export import system_text
from ..runs.inspection import describe_component, describe_fmu
from ..runs.job import look_at_target
from ..runs.request import Request
from ..runs.system import System
from ..runs.target import is_fmu, wrong_target
from .analysis import options_named
from .options import ModelName
from .screen import opened

_Subject = Annotated[
    str,
    typer.Argument(
        metavar="FMU|COMPONENT|CASE|SYSTEM.toml|SSP",
        help="An FMU, also a stranger's, a component such as RBSMBeam, a case, a system file or an "
        "SSP.",
    ),
]
_Toml = Annotated[
    bool, typer.Option("--toml", help="Print the system as a file that `rockshed run` takes.")
]


_Diagram = Annotated[
    Path | None,
    typer.Option(
        "--diagram",
        metavar="FILE.svg",
        help="Draw the system into a new file: components, steps, connections, power bonds.",
    ),
]


def command(
    target: _Subject, toml: _Toml = False, diagram: _Diagram = None, model: ModelName = None
) -> None:
    """Show an FMU, a component or a system: ports, values, connections."""
    with opened() as screen:
        if diagram is not None:
            with all_causes(partial(_look, target)):
                _check_diagram(target, diagram)
        if is_fmu(target):
            screen.overview(describe_fmu(Path(target)))
            return
        if target in NAMES:
            screen.overview(describe_component(target))
            return
        with options_named(("model",), target):
            request = Request(target, model=model)
            if not request.is_file:
                _refuse_unknown(target)
            system = System.prepared(request)
        if toml:
            screen.out.file.write(system_text(system.spec))
        else:
            screen.overview(system.describe())
        if diagram is not None:
            with refusing_unwritable(diagram, "name another file"):
                write_file(diagram, system.diagram())
            screen.note(f"drawn into {diagram}")


def _look(target: str) -> None:
    """Look at what is to be shown, without showing it."""
    if is_fmu(target):
        describe_fmu(Path(target))
    elif target not in NAMES:
        look_at_target(target)


def _check_diagram(target: str, file: Path) -> None:
    """Refuse what cannot be drawn, and a file that is there."""
    if is_fmu(target) or target in NAMES:
        what = "draws a system, and this is one component"
        raise InputRefused([Problem("--diagram", what, "leave it out")])
    if file.suffix.lower() != ".svg":
        raise InputRefused([Problem("--diagram", f"{file} is no .svg", "name a file in .svg")])
    if file.exists():
        raise InputRefused([Problem(str(file), "is there already, and stays", "name a new file")])


def _refuse_unknown(target: str) -> None:
    """Refuse a name that neither a case nor a component has."""
    of_cases = (name for case in cases().values() for name in (case.name, *case.other_names))
    known = [*of_cases, *NAMES]
    if target not in known:
        what = "is no FMU, no component, no case and no system file"
        unknown = Problem(target, what, nearest(target, known))
        raise InputRefused([wrong_target(target) or unknown])
