"""The part ``systems`` of the command ``rockshed bench``: impact systems in every master."""

from pathlib import Path

from ..core.errors import refusing_unwritable
from ..files import write_file
from ..systems.catalogue import impact_systems
from ..systems.measuring import QUICK, SuiteRuns, measure
from ..systems.results import overview
from .screen import Screen

DATA, FIGURE = "systems.json", "systems.png"


def bench_systems(folder: Path, quick: bool, rounds: int, screen: Screen) -> SuiteRuns:
    """Run the impact systems in every master, show one table, and keep data and figure.

    Parameters
    ----------
    folder : Path
        Of the results.
    quick : bool
        Three systems, two exchange steps each, without other kinds of FMUs.
    rounds : int
        Runs with the stated exchange step.
    screen : Screen
        Of the command.

    Returns
    -------
    SuiteRuns

    Raises
    ------
    InputRefused
        The folder cannot be written, or FMUs cannot be built.
    """
    from ..systems.pictures import draw  # matplotlib is of no use to the other parts

    with refusing_unwritable(folder):
        folder.mkdir(parents=True, exist_ok=True)
    measured = measure(impact_systems(QUICK if quick else ()), quick, rounds, screen.note)
    with refusing_unwritable(folder):
        write_file(folder / DATA, measured.as_text().encode())
        draw(measured, folder / FIGURE)
    screen.show(overview(measured), f"data and figure in {folder}")
    return measured
