"""Names of places along the x axis of a panel, in rows at its top where none covers another."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from .sheet import shortened, width_of
from .style import GREY, literal

_SIZE = 7.5
"""Size (point) of the names."""
_ROW = 10.0
"""Height (point) of a row of names."""
_GAP = 8.0
"""Least distance (point) of two names in a row."""
_MOST_ROWS = 6
_LONGEST = 30
"""Letters of a name, at most."""
_INCH = 72.0
"""Points in an inch."""


@dataclass(frozen=True)
class Mark:
    """A place that has a name.

    Attributes
    ----------
    x : float
        Place, in the units of the x axis.
    name : str
        Its name.
    colour : str
        Of the name.
    words : str
        Put behind the name.
    """

    x: float
    name: str
    colour: str = GREY
    words: str = ""

    @property
    def text(self) -> str:
        """Name and words as they are drawn."""
        return shortened(literal(self.name), _LONGEST) + self.words


def name_marks(axes: Axes, marks: Sequence[Mark]) -> None:
    """Name places at the top of a panel that has its size already, and make room for the names.

    Parameters
    ----------
    axes : Axes
        The panel, of a figure that is fit.
    marks : sequence of Mark
        The places. What six rows of names do not hold is counted, not named.
    """
    if not marks:
        return
    points = _INCH / axes.figure.dpi
    box = axes.get_window_extent()
    width, height = box.width * points, box.height * points
    ends: list[float] = []
    unnamed = 0
    for mark in sorted(marks, key=lambda mark: mark.x):
        at = float(axes.transData.transform((mark.x, 0.0))[0] - box.x0) * points
        long = width_of(mark.text, _SIZE) * _INCH
        left = max(min(at + 2.0, width - long), 0.0)
        row = next((row for row, end in enumerate(ends) if end + _GAP <= left), len(ends))
        if row >= _MOST_ROWS:
            unnamed += 1
            continue
        ends[row : row + 1] = [left + long]
        _write(axes, mark.text, (left, -2.0 - row * _ROW), mark.colour)
    rows = len(ends)
    if unnamed:
        _write(axes, f"and {unnamed} more", (0.0, -2.0 - rows * _ROW), GREY)
        rows += 1
    bottom, top = axes.get_ylim()
    axes.set_ylim(top=bottom + (top - bottom) / max(1.0 - (rows * _ROW + 4.0) / height, 0.2))


def _write(axes: Axes, text: str, offset: tuple[float, float], colour: str) -> None:
    """Write a text at an offset (point) from the upper left corner of a panel."""
    place: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points"}
    halo = [withStroke(linewidth=2.0, foreground="white")]
    axes.annotate(
        text,
        (0.0, 1.0),
        xytext=offset,
        va="top",
        fontsize=_SIZE,
        color=colour,
        zorder=7,
        path_effects=halo,
        **place,
    )
