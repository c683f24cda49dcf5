"""The command ``rockshed pile``."""

from pathlib import Path

from ..analyses.pile.run import pile
from ..runs.building import is_cold
from ..sites.source import site_source
from .analysis import show, stages
from .screen import COLD_START, Screen


def show_pile(
    screen: Screen,
    results: Path,
    site: Path,
    *,
    blows: int | None,
    output_dir: Path | None,
    pictures: bool,
) -> None:
    """Compute the blows on a pile and show their tables or JSON.

    Parameters
    ----------
    screen : Screen
        Of the command.
    results : Path
        Folder of the results that name no other.
    site, blows, output_dir, pictures
        Options of the command.

    Raises
    ------
    InputRefused
        Everything that is wrong with the site.
    """
    folder = output_dir or results / site_source(site).name
    if is_cold(["Hammer", "PileRod"]):
        screen.note(COLD_START)
    with stages(screen) as progress:
        result = pile(site, blows=blows, folder=folder, pictures=pictures, progress=progress)
    show(screen, result)
