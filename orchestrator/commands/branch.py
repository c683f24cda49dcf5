"""The command ``rockshed branch``: variants of a run, from one of its states."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
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
from .results_place import free_place, look_at_folder, look_at_place, provenance_in
from .run import show_run
from .screen import Screen, opened
from .streams import stdout_for_results
from .variants import read_variants
from .vary import (
    AnotherDraw,
    Design,
    SampleCount,
    ToldMetrics,
    ToldPercentiles,
    percentiles_of,
    varied_of,
)

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
        help="Many variants: the names of the values in the first line, then a line for each "
        "variant. One table for all, in results/NAME-variants.",
    ),
]
_Vary = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=HOW",
        help="Many variants, as those of `rockshed study --vary`: levels A,B,C, a range "
        "LOW..HIGH:LEVELS or a distribution of what --set takes. May be repeated.",
    ),
]
_OPTIONS = (
    *("at", "vary", "values", "design", "samples", "draw", "metrics", "percentiles"),
    *("workers", "folder", "variants"),
)
"""Arguments of the analysis of many variants that are options of the command."""
_DRAWN = ("design", "samples", "draw")
"""Options of variants that vary, and do not stand in a table."""


def command(
    run: _Parent,
    at: _At = None,
    set_: _Values = None,
    vary: _Vary = None,
    variants: _Variants = None,
    design: Design = None,
    samples: SampleCount = None,
    draw: AnotherDraw = None,
    metric: ToldMetrics = None,
    percentiles: ToldPercentiles = None,
    output_dir: _Folder = None,
    checkpoint_every: _Every = None,
    workers: Workers = None,
    strict: Strict = False,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run variants of a run from one of its states.

    Sand that has settled does not settle again. Many variants have one table, and go on when they
    are killed.
    """
    drawn = {"design": design, "samples": samples, "draw": draw}
    told = {"metrics": metric, "percentiles": percentiles, "workers": workers}
    alone = {"checkpoint_every": checkpoint_every, "strict": strict or None}
    asked = _Asked(run, at, set_ or [], vary or [], variants, output_dir)
    if vary or variants is not None:
        look = partial(_read, asked, {**drawn, **told})
        with opened(quiet, as_json) as screen, all_causes(look, *asked.looks_of_many):
            _refuse(alone, "is for a single variant, and these are many")
            show(screen, _run_many(asked, {**drawn, **told}, not no_figures, screen))
        return
    announce(quiet=quiet, as_json=as_json, figures=not no_figures)
    with opened(quiet, as_json) as screen, all_causes(*asked.looks):
        what = "is for many variants, and this is one"
        _refuse({**drawn, **told}, what, "add --vary or --variants, or ")
        conduct = {"at": at, "checkpoint_every": checkpoint_every}
        show_run(_branched(asked, conduct, screen), screen, not no_figures, strict)


@dataclass(frozen=True)
class _Asked:
    """Options of one variant as of many.

    Attributes
    ----------
    run, at, assigned, vary, variants, folder
        As the user has given them.
    """

    run: Path
    at: float | None
    assigned: Sequence[str]
    vary: Sequence[str]
    variants: Path | None
    folder: Path | None

    @property
    def looks(self) -> list[Callable[[], object] | None]:
        """Looks at the inputs of one variant, each alone."""
        return [partial(read_run, self.run), look_at_folder(self.folder)]

    @property
    def looks_of_many(self) -> list[Callable[[], object] | None]:
        """Looks at the inputs of many variants, each alone."""
        table = None if self.variants is None else partial(read_variants, self.variants)
        return [partial(read_run, self.run), table, look_at_place(self.folder)]

    def place(self, ending: str) -> tuple[Path, str]:
        """Return the folder of the results, and what is to be said when something is in it."""
        if self.folder:
            return self.folder, ""
        name = f"{self.run.resolve().name}-{ending}"
        return free_place(name, {"never": "the same"}, provenance_in)


def _refuse(options: Mapping[str, object], what: str, remedy: str = "") -> None:
    """Refuse options that are given and mean nothing here.

    Raises
    ------
    InputRefused
        With each of them.
    """
    with options_named(("metrics", *options)):
        given = [name for name, value in options.items() if value is not None]
        if given:
            raise InputRefused([Problem(name, what, f"{remedy}leave it out") for name in given])


def _run_many(
    asked: _Asked, options: Mapping[str, Any], pictures: bool, screen: Screen
) -> StudyResult:
    """Run the variants of a table, or those that vary.

    Raises
    ------
    InputRefused
        Texts or the table cannot be read, or options that do not go together.
    """
    read = _read(asked, options)
    table = None if asked.variants is None else read_variants(asked.variants)
    parent = read_run(asked.run)
    place, said = asked.place("variants")
    with (
        kept_if_ended(screen, place),
        options_named(_OPTIONS),
        nullcontext() if table is None else table.placed(),
        stages(screen) as progress,
    ):
        found = branches(
            parent,
            **{"variants": table.values if table else None, **read},
            at=asked.at,
            folder=place,
            pictures=pictures,
            progress=progress,
            note=screen.note,
        )
    if said:
        screen.warn(said)
    return found


def _read(asked: _Asked, options: Mapping[str, Any]) -> dict[str, Any]:
    """Read options that are texts.

    Raises
    ------
    InputRefused
        With all that cannot be read, and options that do not go together.
    """
    problems: list[Problem] = []
    found = {**options, "percentiles": percentiles_of(options["percentiles"], problems)}
    found["values"] = values_of("--set", asked.assigned, problems)
    if asked.variants is None:
        found["variants"] = varied_of(asked.vary, problems)
    else:
        drawn = {"--vary": asked.vary or None, **{f"--{n}": options[n] for n in _DRAWN}}
        what = "means nothing beside --variants, whose table has the values of each variant"
        problems += [Problem(n, what, "leave one of them out") for n, v in drawn.items() if v]
    if problems:
        raise InputRefused(problems)
    return {name: value for name, value in found.items() if value is not None}


def _branched(asked: _Asked, conduct: Mapping[str, Any], screen: Screen) -> Run:
    """Run a variant; one that fails or is interrupted gives what was computed until then."""
    problems: list[Problem] = []
    values = values_of("--set", asked.assigned, problems)
    if not values and not problems:
        what = "is missing: a variant has another value of something"
        remedy = "write --set component.name=value, or --vary for many variants"
        problems.append(Problem("--set", what, remedy))
    if problems:
        raise InputRefused(problems)
    parent = read_run(asked.run)
    place, said = asked.place("branch")
    with stdout_for_results(), screen.progress("preparing") as progress:
        try:
            with options_named(("at", "checkpoint_every")):
                done = branch(
                    parent, values, folder=place, progress=progress, note=screen.note, **conduct
                )
        except RunFailed as failure:
            done = failure.run
    if said:
        screen.warn(said)
    return done
