"""The command ``rockshed branch``: a variant of a run, from one of its states."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..core.errors import InputRefused, Problem, RunFailed
from ..core.supervisor import announce
from ..runs.continuing import branch
from ..runs.run import Run, read_run
from .analysis import options_named
from .assignments import values_of
from .options import Json, NoFigures, Quiet, Strict, simulated_time
from .results_place import free_folder, provenance_in
from .run import show_run
from .screen import Screen, opened
from .streams import stdout_for_results

_Parent = Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run with checkpoints.")]
_At = Annotated[
    float | None,
    simulated_time(
        "Simulated time from which the values hold, 5ms; default: the start of the run."
    ),
]
_Values = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="Another value: from the start of anything that `rockshed run --set` takes, from a "
        "later time of tunable parameters and of inputs that nothing feeds. May be repeated.",
    ),
]
_Folder = Annotated[
    Path | None, typer.Option(help="Folder of the results; default results/NAME-branch.")
]
_Every = Annotated[
    float | None, simulated_time("Simulated time between two checkpoints of the variant.")
]


def command(
    run: _Parent,
    at: _At = None,
    set_: _Values = None,
    output_dir: _Folder = None,
    checkpoint_every: _Every = None,
    strict: Strict = False,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run a variant of a run from one of its states.

    Sand that has settled does not settle again.
    """
    announce(quiet=quiet, as_json=as_json, figures=not no_figures)
    with opened(quiet, as_json) as screen:
        asked = {"at": at, "checkpoint_every": checkpoint_every}
        done = _branched(run, set_ or [], output_dir, asked, screen)
        show_run(done, screen, not no_figures, strict)


def _branched(
    folder: Path, texts: list[str], output_dir: Path | None, asked: dict[str, Any], screen: Screen
) -> Run:
    """Run a variant; one that fails or is interrupted gives what was computed until then."""
    problems: list[Problem] = []
    values = values_of("--set", texts, problems)
    if not values and not problems:
        what = "is missing: a variant has another value of something"
        problems.append(Problem("--set", what, "write --set component.name=value"))
    if problems:
        raise InputRefused(problems)
    parent = read_run(folder)
    place = output_dir or free_folder(_name(parent), {"never": "the same"}, provenance_in, screen)
    with stdout_for_results(), screen.progress("preparing") as progress:
        try:
            with options_named(("at", "checkpoint_every")):
                return branch(
                    parent, values, folder=place, progress=progress, note=screen.note, **asked
                )
        except RunFailed as failure:
            done: Run = failure.run
            return done


def _name(parent: Run) -> str:
    """Return the name of the folder of a variant's results."""
    return f"{parent.folder.resolve().name}-branch"
