"""The command ``rockshed calibrate rockfall``: the ground from where rocks came to rest."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from ..analyses.back_analysis.run import calibrate_rockfall
from ..core.errors import InputRefused, Problem, all_causes
from ..core.input_text import shown
from ..core.system.quantities import finite_number
from ..input_files.csv_table import read_csv
from ..runs.building import is_cold
from ..sites.source import site_source
from .analysis import kept_if_ended, options_named, show, stages
from .options import Json, NoFigures, Quiet
from .results_place import folder_of_site, look_at_folder
from .screen import COLD_START, opened

_OPTIONS = ("fit", "forecast", "scatter", "trials", "steps", "seed", "workers", "folder")
"""Arguments of the analysis that are options of the command."""

_Site = Annotated[Path, typer.Argument(metavar="PROFILE.toml", help="Slope of the released rocks.")]
_Ends = Annotated[
    Path,
    typer.Argument(
        metavar="ENDPOINTS.csv",
        help="Measured end points, a column `x (m)`; and of search lines `LINE.speed (m/s)`, "
        "`LINE.height (m)`, `LINE.energy (kJ)`.",
    ),
]
_Fit = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=LOW..HIGH",
        help="Infer this quantity within this range (SI): soil.strength=1e5..1e7, "
        "soil.roughness.mean=0.02..0.8. May be repeated. Default: strength or coefficients of "
        "restitution, roughness and undulation of every material.",
    ),
]
_Forecast = Annotated[
    Path | None,
    typer.Option(metavar="OTHER.toml", help="Forecast this slope, with materials of these names."),
]
_Scatter = Annotated[
    float, typer.Option(help="By how many metres end points may lie beside computed ones.")
]
_Trials = Annotated[int, typer.Option(help="Trials for each set of parameters.")]
_Steps = Annotated[int, typer.Option(help="Steps of each walker of the sampler.")]
_Seed = Annotated[int, typer.Option(min=0, help="Of the sampler.")]
_Workers = Annotated[int | None, typer.Option(min=1, help="Threads; default: one for each core.")]
_Folder = Annotated[Path | None, typer.Option(help="Folder of the results; default results/NAME.")]


def command(
    site: _Site,
    endpoints: _Ends,
    fit: _Fit = None,
    forecast: _Forecast = None,
    scatter: _Scatter = 1.0,
    trials: _Trials = 400,
    steps: _Steps = 300,
    seed: _Seed = 1,
    workers: _Workers = None,
    output_dir: _Folder = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Infer the ground of a slope from where rocks came to rest; forecast another.

    Parameters have intervals, from samples of their posterior.
    """
    with opened(quiet, as_json) as screen:
        read = (site_source, site), (read_csv, endpoints), (site_source, forecast)
        looks = (partial(look, file) for look, file in read if file is not None)
        with all_causes(*looks, look_at_folder(output_dir)):
            ranges = _ranges(fit or [])
            folder = output_dir or folder_of_site(site, "rockfall-calibration", screen)
        if is_cold(["SlopeRockfall"]):
            screen.note(COLD_START)
        kept = kept_if_ended(screen, folder)
        with kept, options_named(_OPTIONS), stages(screen) as progress:
            result = calibrate_rockfall(
                site,
                endpoints,
                fit=ranges,
                forecast=forecast,
                scatter=scatter,
                trials=trials,
                steps=steps,
                seed=seed,
                workers=workers,
                folder=folder,
                pictures=not no_figures,
                progress=progress,
            )
        show(screen, result)


def _ranges(texts: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Return the range by name of texts ``NAME=LOW..HIGH``.

    Raises
    ------
    InputRefused
        With all texts that are none, and names that are given twice.
    """
    found: dict[str, tuple[float, float]] = {}
    problems = []
    for text in texts:
        name, _, ends = (part.strip() for part in text.partition("="))
        low, high = map(finite_number, ends.partition("..")[::2])
        if not name or low is None or high is None:
            what = f"{shown(text)} is no range of a quantity"
            remedy = "write NAME=LOW..HIGH, as soil.strength=1e5..1e7"
            problems.append(Problem("--fit", what, remedy))
        elif name in found:
            problems.append(Problem(f"--fit {name}", "is given twice", "keep one of them"))
        else:
            found[name] = (low, high)
    if problems:
        raise InputRefused(problems)
    return found
