"""Drawing of a run's pictures with notes on the screen."""

from pathlib import Path

from ..runs.run import Run
from .screen import Screen


def draw(run: Run, folder: Path, screen: Screen) -> list[Path]:
    """Draw every picture that the results allow.

    Parameters
    ----------
    run : Run
        The run.
    folder : Path
        Folder of the pictures.
    screen : Screen
        Shows which pictures there are not, and why.

    Returns
    -------
    list of Path
        The files.
    """
    with screen.busy("drawing"):
        return list(run.figures(folder, note=screen.note, warn=screen.warn).values())
