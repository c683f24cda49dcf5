"""The command ``rockshed calibrate pile``: the soil of a pile from a measured blow."""

from pathlib import Path
from typing import Annotated

import typer

from ..analyses.pile_matching.run import match_pile
from ..core.errors import all_causes
from ..runs.building import is_cold
from .analysis import kept_if_ended, options_named, show, stages
from .options import Json, NoFigures, Quiet
from .results_place import look_at_folder, results_folder
from .screen import COLD_START, opened
from .streams import tell_leftovers

_Measured = Annotated[
    Path,
    typer.Argument(
        metavar="MEASURED.csv",
        help="Blow at the gauge: columns `time (ms)`, `force (kN)`, `velocity (m/s)` or other "
        "units; compression and downwards positive.",
    ),
]
_Site = Annotated[
    Path,
    typer.Argument(
        metavar="PILE.toml",
        help="Pile from the gauge downwards; its [[shaft]] and [toe] are the start.",
    ),
]
_Folder = Annotated[
    Path | None, typer.Option(help="Folder of the results; default results/matching-NAME.")
]


def command(
    measured: _Measured,
    site: _Site,
    output_dir: _Folder = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find soil resistance, quakes and damping from force and velocity at the head of a pile.

    The wave that the soil sends back up is computed until it is that of the measurement.
    """
    with opened(quiet, as_json) as screen, all_causes(look_at_folder(output_dir)):
        origin = {"kind": "pile matching", "measurement": measured.name}
        name = f"matching-{measured.stem}"
        folder = output_dir or results_folder(name, str(measured), origin, screen)
        tell_leftovers(folder, screen)
        if is_cold(["PileRod"]):
            screen.note(COLD_START)
        pictures = not no_figures
        kept = kept_if_ended(screen, folder)
        with kept, options_named(("folder",)), stages(screen) as progress:
            result = match_pile(measured, site, folder=folder, pictures=pictures, progress=progress)
        show(screen, result)
