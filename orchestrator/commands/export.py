"""The command ``rockshed export``: a system as files or SSP, or a run in other formats."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from ..core.errors import InputRefused, Problem, all_causes
from ..runs.export import refuse_place
from ..runs.formats.choice import refuse_format
from ..runs.request import AUTO, Request
from ..runs.run import read_run
from ..runs.system import System
from .analysis import options_named
from .assignments import sizes_of, values_of
from .options import Assignments, CaseSizes, CouplingScheme, ModelName
from .screen import Screen, opened

_Target = Annotated[
    str,
    typer.Argument(
        metavar="CASE|FILE.toml|SSP|RUN|systems",
        help="A case of `rockshed list`, a project, a system file or an SSP; with --format the "
        "folder of a run; `systems`: the impact systems, for other masters.",
    ),
]
_Folder = Annotated[
    Path | None,
    typer.Argument(
        metavar="[FOLDER|NAME.ssp]", help="Of a system: a new or empty folder, or a new SSP."
    ),
]
_Ssp = Annotated[
    str | None,
    typer.Option(
        "--ssp",
        metavar="1.0|2.0",
        help="Version of an SSP; default 1.0, of a system that was an SSP that of it.",
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
_Format = Annotated[
    str | None,
    typer.Option(
        "--format",
        metavar="csv|mat4|vtk",
        help="Write the time series of a run as CSV or as MAT 4 of Dymola and OpenModelica, or its "
        "recorded states as VTK.",
    ),
]
_Output = Annotated[
    Path | None,
    typer.Option(
        "--output",
        metavar="FILE|FOLDER",
        help="With --format: file, of vtk a folder; default RUN/export/...",
    ),
]

SYSTEMS = "systems"
"""Target that is the suite of impact systems."""
_MOST_TOLD = 3
"""Files of an export that are listed; of more, the first names the others."""
_FAULT_OF_SYSTEM = Problem(
    "export",
    "a system goes into a new folder or SSP, which stands behind its name",
    "rockshed export CASE FOLDER or CASE NAME.ssp; of a run: rockshed export RUN --format csv",
)


def command(
    target: _Target,
    folder: _Folder = None,
    format_: _Format = None,
    output: _Output = None,
    set_: Assignments = None,
    size: CaseSizes = None,
    coupling: CouplingScheme = None,
    model: ModelName = None,
    ssp: _Ssp = None,
    runtime: _Runtime = AUTO,
) -> None:
    """Write a system with its FMUs as TOML or SSP, or a run for others."""
    problems: list[Problem] = []
    with opened() as screen:
        if format_ is not None:
            of_systems = {"--set": set_, "--size": size, "--coupling": coupling}
            of_systems |= {"--model": model, "--ssp": ssp}
            of_systems |= {"--runtime": runtime if runtime != AUTO else None}
            _export_run(Path(target), format_, output, (folder, of_systems), screen)
            return
        if folder is None or output is not None:
            raise InputRefused([_FAULT_OF_SYSTEM])
        if target == SYSTEMS:
            options = (set_, size, coupling, model, ssp, runtime if runtime != AUTO else None)
            _export_systems(folder, any(options), screen)
            return
        values = values_of("--set", set_ or [], problems)
        sizes = sizes_of(size or [], problems)
        request = Request(target, values, sizes, coupling, model=model, runtime=runtime)
        names = ("values", "sizes", "coupling", "model", "ssp", "runtime", "exchange_step")
        place = partial(refuse_place, folder, ssp)
        with options_named((*names, "stop_time"), target), all_causes(place):
            system = System.prepared(request, screen.note, problems)
            made = system.save(folder, ssp=ssp)
        screen.say(str(made))


def _export_run(
    run: Path,
    form: str,
    output: Path | None,
    misplaced: tuple[Path | None, Mapping[str, object]],
    screen: Screen,
) -> None:
    """Write a run in a format; folder and options of the export of a system are misplaced."""
    look = partial(refuse_format, form)
    named = options_named(("format", "output", "state_interval"))
    with named, all_causes(partial(read_run, run), look):
        _check_run(*misplaced)
        files = read_run(run).export(form, output)
    for file in files[:1] if len(files) > _MOST_TOLD else files:
        screen.say(str(file))


def _export_systems(folder: Path, has_options: bool, screen: Screen) -> None:
    """Write the suite of impact systems, which has every kind of FMUs and no options."""
    from ..systems.catalogue import impact_systems  # the components of all of them
    from ..systems.files import export_systems

    with all_causes(partial(refuse_place, folder, None)):
        if has_options:
            what = "has all kinds of FMUs and no options"
            raise InputRefused([Problem(SYSTEMS, what, "leave the options out")])
    screen.say(str(export_systems(impact_systems(), folder, screen.note)))


def _check_run(folder: Path | None, of_systems: Mapping[str, object]) -> None:
    """Refuse with --format what belongs to the export of a system."""
    what = "belongs to the export of a system, not to that of a run"
    problems = [
        Problem(option, what, "leave it out") for option, value in of_systems.items() if value
    ]
    if folder is not None:
        problems.append(Problem(str(folder), what, "name the place with --output"))
    if problems:
        raise InputRefused(problems)
