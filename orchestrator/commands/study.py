"""The command ``rockshed study``: a system with values that vary."""

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ..analyses.study.result import StudyResult
from ..analyses.study.run import study
from ..cases.registry import case, is_case
from ..core.errors import InputRefused, Problem, all_causes
from ..core.results.run_folder import RUN
from ..runs.chosen import is_project_file
from ..runs.job import look_at_target
from ..runs.request import Request
from .analysis import kept_if_ended, options_named, show, stages
from .assignments import values_of
from .cluster_options import Authority, Certificate, PrivateKey, Scheduler, certificates_of
from .options import Assignments, Json, NoFigures, Quiet, Target, Workers, simulated_time
from .results_place import free_folder, look_at_place
from .screen import Screen, opened
from .vary import (
    AnotherDraw,
    Design,
    SampleCount,
    ToldMetrics,
    ToldPercentiles,
    Vary,
    percentiles_of,
    varied_of,
)

_OPTIONS = (
    *("vary", "design", "samples", "seeds", "draw", "metrics", "percentiles", "values"),
    *("workers", "scheduler", "certificates", "folder"),
)
"""Arguments of the analysis that are options of the command."""
_Seeds = Annotated[
    int,
    typer.Option(help="Packings of the sand: of each combination; of samples, one each in turn."),
]
_StopTime = Annotated[float | None, simulated_time("End of every run.")]
_Folder = Annotated[
    Path | None, typer.Option(help="Folder of the results; default results/NAME-study.")
]


def command(
    target: Target,
    vary: Vary = None,
    design: Design = None,
    samples: SampleCount = None,
    seeds: _Seeds = 1,
    draw: AnotherDraw = None,
    set_: Assignments = None,
    stop_time: _StopTime = None,
    metric: ToldMetrics = None,
    percentiles: ToldPercentiles = None,
    output_dir: _Folder = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    tls_ca: Authority = None,
    tls_cert: Certificate = None,
    tls_key: PrivateKey = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run a system with values that vary: designs, Monte Carlo, sensitivity.

    What has ended is kept: a study that was killed goes on.
    """
    looks = (partial(look_at_target, target), look_at_place(output_dir))
    with opened(quiet, as_json) as screen, all_causes(*looks):
        asked = {
            **_read(vary, set_, percentiles),
            "design": design,
            "samples": samples,
            "seeds": seeds,
            "draw": draw or 0,
            "options": {} if stop_time is None else {"stop_time": stop_time},
            "metrics": metric or (),
            "workers": workers,
            "scheduler": scheduler,
            "certificates": certificates_of(tls_ca, tls_cert, tls_key),
            "folder": output_dir or _folder(target, screen),
            "pictures": not no_figures,
        }
        show(screen, _studied(target, asked, screen))


def _read(
    vary: Sequence[str] | None, assigned: Sequence[str] | None, percentiles: str | None
) -> dict[str, Any]:
    """Read options that are texts.

    Raises
    ------
    InputRefused
        With all that cannot be read.
    """
    problems: list[Problem] = []
    found = {
        "vary": varied_of(vary or [], problems),
        "values": values_of("--set", assigned or [], problems),
        "percentiles": percentiles_of(percentiles, problems),
    }
    if problems:
        raise InputRefused(problems)
    return found


def _studied(target: str, asked: Mapping[str, Any], screen: Screen) -> StudyResult:
    """Carry out a study; one without a result, or that is interrupted, ends the command."""
    with (
        kept_if_ended(screen, asked["folder"]),
        options_named(_OPTIONS),
        stages(screen) as progress,
    ):
        return study(target, **asked, progress=progress, note=screen.note)


def _folder(target: str, screen: Screen) -> Path:
    """Return the folder of the results of a target that the user has named no folder for."""
    request = Request(target)
    name = Path(target).stem if request.is_file else target
    kind = "project_file" if request.is_file and is_project_file(target) else "system_file"
    of_case = {"case": case(target).name if is_case(target) else target}
    which = {kind: target} if request.is_file else of_case
    return free_folder(f"{name}-study", {"kind": "study", **which}, _content, screen)


def _content(folder: Path) -> Any:
    return json.loads((folder / RUN).read_text(encoding="utf-8"))
