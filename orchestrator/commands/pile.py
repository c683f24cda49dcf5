"""The command ``rockshed pile``: blows on a driven pile or rod."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from ..analyses.pile.run import pile
from ..core.errors import all_causes
from ..runs.building import is_cold
from ..sites.source import site_source
from .analysis import options_named, show, stages
from .options import Json, NoFigures, Quiet
from .results_place import folder_of_site, look_at_folder
from .screen import COLD_START, opened
from .streams import tell_leftovers

_Site = Annotated[
    Path,
    typer.Argument(metavar="PILE.toml", help="Hammer, cushion, rod, soil, blows, bearing graph."),
]
_Blows = Annotated[
    int | None, typer.Option(min=1, help="Number of blows; default: the file's, or 1.")
]
_Folder = Annotated[Path | None, typer.Option(help="Folder of the results; default results/NAME.")]


def command(
    site: _Site,
    blows: _Blows = None,
    output_dir: _Folder = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Wave analysis of a driven pile or rod: set per blow, stresses, bearing graph.

    Residual stresses between blows are computed where the file asks for them.
    """
    looks = (partial(site_source, site), look_at_folder(output_dir))
    with opened(quiet, as_json) as screen, all_causes(*looks):
        folder = output_dir or folder_of_site(site, "pile", screen)
        tell_leftovers(folder, screen)
        if is_cold(["Hammer", "PileRod"]):
            screen.note(COLD_START)
        pictures = not no_figures
        with options_named(("blows", "folder")), stages(screen) as progress:
            result = pile(site, blows=blows, folder=folder, pictures=pictures, progress=progress)
        show(screen, result)
