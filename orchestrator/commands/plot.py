"""The command ``rockshed plot``: pictures of a run, drawn again, and any variables of runs."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from ..analyses.saved import saved_result
from ..core.errors import InputRefused, Problem, all_causes
from ..core.results.own_files import FILES, add_files, read_data
from ..core.results.run_folder import RUN, running_folder
from ..input_files.csv_table import read_csv
from ..runs.overlay import Overlay, overlay
from ..runs.run import Run, read_run
from .analysis import options_named, stages
from .drawing import draw, refuse_form, write_picture
from .options import Json, Quiet
from .screen import Screen, opened

_Folders = Annotated[
    list[Path],
    typer.Argument(
        metavar="RUN...",
        help="Folder of a run, finished or not, or of `study`, `rockfall` or `pile`; of several "
        "runs with --variable.",
    ),
]
_Pictures = Annotated[
    Path | None, typer.Option(help="Folder of the pictures; default RUN/figures.")
]
_Variables = Annotated[
    list[str] | None,
    typer.Option(
        "--variable",
        metavar="NAME",
        help="Draw this recorded variable over time; * stands for any text. May be repeated.",
    ),
]
_Measured = Annotated[
    Path | None,
    typer.Option(
        "--csv",
        metavar="FILE",
        help="Measured curves to draw too, and to tell the errors against: a column `time (ms)`, "
        "and others like `force (kN)`.",
    ),
]
_Output = Annotated[
    Path | None,
    typer.Option(
        "--output",
        metavar="FILE",
        help="Picture of the variables (.png, .svg, .pdf); default RUN/figures/variables.png.",
    ),
]
_SideBySide = Annotated[
    bool, typer.Option("--side-by-side", help="A column of panels for each run.")
]


def command(
    runs: _Folders,
    output_dir: _Pictures = None,
    variable: _Variables = None,
    csv: _Measured = None,
    output: _Output = None,
    side_by_side: _SideBySide = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a run again, also one that failed; or variables of several."""
    with opened(quiet, as_json) as screen, options_named(("folder", "variable")):
        looks = _looks(runs, csv, output) if variable else [partial(_look_at_result, runs[0])]
        with all_causes(*looks):
            _check(runs, variable, output_dir, {"--csv": csv, "--output": output})
        if variable:
            with all_causes(*looks):
                found = [_read(folder, screen) for folder in runs]
                laid = overlay(found, variable, csv)
            with screen.busy("drawing"):
                file = _write(laid, found[0], output, side_by_side)
            _show(laid, file, screen)
            return
        files = _draw_again(runs[0], output_dir, screen)
        if as_json:
            screen.dump({"pictures": [str(file) for file in files]})
            return
        for file in files:
            screen.say(str(file))


def _looks(runs: list[Path], csv: Path | None, output: Path | None) -> list[Callable[[], object]]:
    """Return looks at runs, at measured curves and at the place of a picture."""
    looks: list[Callable[[], object]] = [partial(read_run, folder) for folder in runs]
    looks += [] if csv is None else [partial(read_csv, csv)]
    return looks if output is None else [*looks, partial(refuse_form, output)]


def _look_at_result(folder: Path) -> None:
    """Look at a folder of results."""
    if saved_result(folder) is None:
        read_run(folder)


def _check(
    runs: list[Path],
    variables: list[str] | None,
    output_dir: Path | None,
    of_variables: dict[str, Path | None],
) -> None:
    """Refuse options that do not go together."""
    problems = []
    if not variables:
        what = "belongs to --variable, which is not given"
        remedy = "name a variable: --variable sand.rock.force.y"
        problems = [Problem(option, what, remedy) for option, file in of_variables.items() if file]
        if len(runs) > 1:
            what = "all pictures are drawn of one run at a time"
            problems.append(Problem(str(runs[1]), what, remedy))
    elif output_dir is not None:
        what = "is for all pictures of a run; with --variable there is one"
        problems.append(Problem("--output-dir", what, "name its file with --output"))
    if problems:
        raise InputRefused(problems)


def _draw_again(folder: Path, output_dir: Path | None, screen: Screen) -> list[Path]:
    """Draw all pictures of a run or of an analysis."""
    result = saved_result(folder)
    if result is not None:
        with stages(screen) as progress:
            place = output_dir or folder / result.picture_folder
            files = result.write_pictures(place, progress)
        # the campaign of a shed lies in the folder of a run, which has the list of all its files
        for owner in (folder, folder.parent):
            if FILES in read_data(owner / RUN):
                add_files(owner, files)
        return files
    found = _read(folder, screen)
    return draw(found, output_dir or found.folder / "figures", screen)


def _read(folder: Path, screen: Screen) -> Run:
    """Read a run that has rows; say what is not as one would expect."""
    found = read_run(folder)
    if found.folder.absolute() == folder.absolute() and running_folder(folder.absolute()).exists():
        screen.warn(f"there is a newer run that has not ended, in {running_folder(folder)}")
    if not found.time.size:
        reason = "the run was ended before its first row was written"
        raise InputRefused([Problem(str(found.folder), reason, "run it again")])
    if found.status != "complete":
        screen.warn(
            f"this run is not complete ({found.status}): pictures show what was computed until "
            f"t = {1e3 * found.time[-1]:g} ms"
        )
    return found


def _write(laid: Overlay, run: Run, output: Path | None, side_by_side: bool) -> Path:
    figure = laid.figure(side_by_side)
    if output is not None:
        return write_picture(figure, output)
    file = write_picture(figure, run.folder / "figures" / "variables.png")
    add_files(run.folder, [file])
    return file


def _show(laid: Overlay, file: Path, screen: Screen) -> None:
    if screen.as_json:
        agreements = [entry.as_data() for entry in laid.agreements]
        screen.dump({"pictures": [str(file)], "agreements": agreements})
        return
    if laid.curves:
        screen.table(laid.table())
        screen.say("")
    screen.say(str(file))
