"""The look of all pictures: sizes, colours, a caption of the run, and how a file is written."""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray

from ..core.results.reading import StoredRun
from ..files import whole_file
from ..metrics.caption import caption
from .sheet import LEGEND_SIZE, Sheet, shortened

WIDTH = 7.2
"""Width (inch) of a picture of curves."""
INK, GREY, FAINT = "#222222", "#767676", "#d9d9d9"
TRANSMITTED, ROCK, BEAM, SAND = "#1f5a94", "#c0561a", "#3d7d3f", "#c9a66b"
COLOURS = (TRANSMITTED, ROCK, BEAM, "#8a6d4b", "#6a4c93", "#2a9d8f", "#c04d7e", "#7a7a2a")
"""Colours of curves that are no body; where there are more, it takes a scale of colours."""
REFERENCE_DASHES = "--"
"""Dashes of a line at a value that somebody else has found."""
_LONGEST_NAME = 80
"""Letters of a name in a picture, at most."""
_METADATA = {".png": {"Software": "rockshed"}, ".svg": {"Creator": "rockshed", "Date": None}}
"""Entries in the head of a file, by its ending; equal pictures are equal files."""
_LOOK = {
    "svg.hashsalt": "rockshed",
    "text.parse_math": False,  # names of variables are text, whatever signs are in them
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.labelsize": 9.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "axes.linewidth": 0.7,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": FAINT,
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": LEGEND_SIZE,
    "figure.facecolor": "white",
}


def figure(
    run: StoredRun, file: Path, width: float, height: float
) -> AbstractContextManager[Sheet]:
    """Make a figure with the run's caption below, written to a file whole or not at all.

    Parameters
    ----------
    run : StoredRun
        The run.
    file : Path
        File of the picture.
    width, height : float
        Of the panels (inch).
    """
    return captioned(caption(run), file, width, height)


@contextmanager
def captioned(lines: Sequence[str], file: Path, width: float, height: float) -> Iterator[Sheet]:
    """Make a figure with lines below, written to a file at the end, whole or not at all.

    Parameters
    ----------
    lines : sequence of str
        Below the figure.
    file : Path
        File of the picture.
    width, height : float
        Of the panels (inch).
    """
    with styled(lines, width, height) as made:
        yield made
        made.fit()
        with whole_file(file) as temporary:
            made.savefig(temporary, metadata=_METADATA.get(file.suffix))


@contextmanager
def styled(lines: Sequence[str], width: float, height: float) -> Iterator[Sheet]:
    """Make a figure, its panels of this size (inch), in this look, with these lines below."""
    with matplotlib.rc_context(_LOOK):  # type: ignore[arg-type]  # the stubs know names, not numbers
        yield Sheet(lines, width, height, GREY)


def literal(text: str) -> str:
    """Return what a user has named as a picture shows it: letter for letter, on one line.

    Parameters
    ----------
    text : str
        Any name.

    Returns
    -------
    str
        Without formulas between dollars, control characters, or the _ that hides a label; cut
        where it is longer than a line.
    """
    plain = "".join(letter if letter.isprintable() else " " for letter in text)
    hidden = " " if plain.startswith("_") else ""
    return hidden + shortened(plain, _LONGEST_NAME).replace("$", r"\$")


def reference_line(axes: Axes, value: float, text: str, dashes: str = REFERENCE_DASHES) -> None:
    """Draw a horizontal line at a reference, named in the legend."""
    axes.axhline(value, color=GREY, linewidth=0.9, linestyle=dashes, label=text)


def over_time(axes: Axes, time: NDArray[np.float64]) -> None:
    """Let the axis of time reach from the first to the last row, if there are several."""
    if time[-1] > time[0]:
        axes.set_xlim(time[0], time[-1])


def plain_powers(axis: Axis) -> None:
    """Write the numbers of a logarithmic axis as text: formulas are not set in pictures."""
    axis.set_major_formatter(lambda value, place: f"{value:g}")
    axis.set_minor_formatter(NullFormatter())


def legend(axes: Axes, entries: Sequence[Any] = ()) -> None:
    """Name what is drawn above the panel, where it hides nothing; so the figure does it at its end.

    Parameters
    ----------
    axes : Axes
        The panel; without anything to name it gets no legend.
    entries : sequence of Artist, optional
        What is named, by default everything that has a label.
    """
    if handles := list(entries) or axes.get_legend_handles_labels()[0]:
        _sheet_of(axes).name(axes, handles)


def legend_beside(axes: Axes) -> None:
    """Name what is drawn at the right of the panel, from below upwards."""
    if handles := axes.get_legend_handles_labels()[0]:
        _sheet_of(axes).name(axes, handles[::-1], is_beside=True)


def _sheet_of(axes: Axes) -> Sheet:
    made = axes.get_figure()
    assert isinstance(made, Sheet)
    return made


def second_scale(axes: Axes, factor: float, label: str) -> None:
    """Add a scale of the same values in another unit at the right: ``factor`` * value."""

    def there(y: NDArray[np.float64]) -> NDArray[np.float64]:
        return y * factor

    def back(y: NDArray[np.float64]) -> NDArray[np.float64]:
        return y / factor

    axes.secondary_yaxis("right", functions=(there, back)).set_ylabel(label)  # type: ignore[arg-type]  # the stubs know no arrays
