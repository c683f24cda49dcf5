"""The command ``rockshed branch``: variants of a run, from one of its states."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ..analyses.study.result import StudyResult
from ..analyses.study.variants import branches
from ..core.errors import InputRefused, Problem, RunFailed, all_causes
from ..core.supervisor import announce
from ..runs.continuing import branch
from ..runs.run import Run, read_run
from .analysis import kept_if_ended, options_named, show, stages
from .assignments import values_of
from .options import Json, NoFigures, Quiet, Strict, Workers, simulated_time
from .results_place import free_place, look_at_folder, provenance_in
from .run import show_run
from .screen import Screen, opened
from .streams import stdout_for_results
from .variants import read_variants

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


_Variants = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.csv",
        help="Many variants from the start: the names of the values in the first line, then a line "
        "for each variant. One table for all, in results/NAME-variants.",
    ),
]


def command(
    run: _Parent,
    at: _At = None,
    set_: _Values = None,
    variants: _Variants = None,
    output_dir: _Folder = None,
    checkpoint_every: _Every = None,
    workers: Workers = None,
    strict: Strict = False,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run variants of a run from one of its states.

    Sand that has settled does not settle again.
    """
    if variants is not None:
        alone = {"--at": at, "--set": set_, "--checkpoint-every": checkpoint_every}
        others = [name for name, value in alone.items() if value is not None]
        looks = (
            partial(read_run, run),
            partial(read_variants, variants),
            look_at_folder(output_dir),
        )
        with opened(quiet, as_json) as screen, all_causes(*looks):
            show(screen, _many(run, variants, others, output_dir, workers, not no_figures, screen))
        return
    announce(quiet=quiet, as_json=as_json, figures=not no_figures)
    look = look_at_folder(output_dir)
    with opened(quiet, as_json) as screen, all_causes(partial(read_run, run), look):
        asked = {"at": at, "checkpoint_every": checkpoint_every}
        done = _branched(run, set_ or [], output_dir, asked, screen)
        show_run(done, screen, not no_figures, strict)


def _many(
    folder: Path,
    file: Path,
    others: Sequence[str],
    output_dir: Path | None,
    workers: int | None,
    pictures: bool,
    screen: Screen,
) -> StudyResult:
    """Run the variants of a table.

    Raises
    ------
    InputRefused
        The table cannot be read, or options of a single variant are given too.
    """
    if others:
        what = "is for a single variant, and --variants has many, from the start"
        raise InputRefused([Problem(name, what, "leave one of them out") for name in others])
    variants = read_variants(file)
    parent = read_run(folder)
    place, said = _place(f"{parent.folder.resolve().name}-variants", output_dir)
    with (
        kept_if_ended(screen, place),
        options_named(("workers", "folder", "variants")),
        variants.placed(),
        stages(screen) as progress,
    ):
        found = branches(
            parent,
            variants.values,
            workers=workers,
            folder=place,
            pictures=pictures,
            progress=progress,
            note=screen.note,
        )
    if said:
        screen.warn(said)
    return found


def _place(name: str, output_dir: Path | None) -> tuple[Path, str]:
    """Return the folder of the results, and what is to be said when something is in it."""
    return (
        (output_dir, "") if output_dir else free_place(name, {"never": "the same"}, provenance_in)
    )


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
    place, said = _place(_name(parent), output_dir)
    with stdout_for_results(), screen.progress("preparing") as progress:
        try:
            with options_named(("at", "checkpoint_every")):
                done = branch(
                    parent, values, folder=place, progress=progress, note=screen.note, **asked
                )
        except RunFailed as failure:
            done = failure.run
    if said:
        screen.warn(said)
    return done


def _name(parent: Run) -> str:
    """Return the name of the folder of a variant's results."""
    return f"{parent.folder.resolve().name}-branch"
