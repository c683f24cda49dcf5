"""Drawing of a run's pictures with notes on the screen."""

from pathlib import Path
from typing import TYPE_CHECKING

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.results.own_files import is_foreign_picture
from ..files import whole_file
from ..runs.run import Run
from .screen import Screen

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FORMATS = (".png", ".svg", ".pdf")


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


def refuse_form(file: Path) -> None:
    """Refuse a picture whose name ends in no known format.

    Parameters
    ----------
    file : Path
        Of the picture.

    Raises
    ------
    InputRefused
        With the formats that are known.
    """
    if file.suffix.lower() not in _FORMATS:
        remedy = f"let its name end in one of {', '.join(_FORMATS)}"
        raise InputRefused([Problem(str(file), "is of no known format", remedy)])


def write_picture(figure: "Figure", file: Path) -> Path:
    """Write a picture into a file of its own.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The picture.
    file : Path
        Its ending says the format. A picture of this program that is there already is replaced.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputRefused
        The format is unknown, something else is there, or the file cannot be written.
    """
    refuse_form(file)
    refuse_foreign_file(file)
    metadata = {"Software": "rockshed"} if file.suffix.lower() == ".png" else None
    with refusing_unwritable(file.parent):
        file.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(file) as temporary:
            figure.savefig(temporary, format=file.suffix[1:].lower(), metadata=metadata)
    return file


def refuse_foreign_file(file: Path) -> None:
    """Refuse to replace a file that is no picture of this program.

    Parameters
    ----------
    file : Path
        Where something is to be written.

    Raises
    ------
    InputRefused
        Something else is there.
    """
    if is_foreign_picture(file):
        what = "is there already and stays"
        raise InputRefused([Problem(str(file), what, "remove it or name another file")])
