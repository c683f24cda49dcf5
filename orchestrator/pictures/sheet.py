"""A figure that grows by what stands around its panels, so that no text covers another one."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text
from matplotlib.transforms import ScaledTranslation

LEGEND_SIZE = 8.5
"""Size (point) of the names in a legend."""
_BESIDE = 3.0
"""Width (inch) of a legend beside a panel, at most."""
_EDGE = "edge of a legend"
"""Identifier of the empty line at the upper edge of a legend."""
_NARROWEST = 1.0
"""Width (inch) that a legend may have, however narrow its panel is."""
_CAPTION_SIZE = 6.5
"""Size (point) of the lines below a figure."""
_MOST_LINES = 14
"""Lines below a figure, at most."""
_DPI = 140
_INCH = 72.0
"""Points in an inch."""
_HANDLE, _BETWEEN = 3.2, 2.2
"""Widths of a line in a legend, and between its columns, in sizes of its letters."""
_MOST_COLUMNS = 5
"""Columns of a legend, at most."""
_MARGIN = 0.1
"""Part of an inch that stays free at the right of the lines below a figure."""


@lru_cache(maxsize=4096)
def width_of(text: str, size: float) -> float:
    """Return the width (inch) of a line of letters of this size (point)."""
    font = FontProperties(size=size)
    return float(_ruler().get_text_width_height_descent(text, font, False)[0]) / _DPI


@cache
def _ruler() -> RendererAgg:
    """Return what measures letters as they are drawn, on whole pixels."""
    return RendererAgg(1.0, 1.0, _DPI)


def wrapped(text: str, width: float, size: float) -> list[str]:
    """Break a text into lines that are not wider than they may be.

    Parameters
    ----------
    text : str
        Words; of a word that is longer than a line, the letters go on in the next one.
    width : float
        Of a line (inch).
    size : float
        Of the letters (point).

    Returns
    -------
    list of str
        The lines, one at least.
    """
    plain = " ".join(text.split()) or " "
    whole = width_of(plain, size)
    letters = max(1, int(len(plain) * width / whole)) if whole > width else len(plain)
    lines = wrap(plain, letters)
    while letters > 1 and any(width_of(line, size) > width for line in lines):
        letters = max(1, min(letters - 1, int(0.95 * letters)))
        lines = wrap(plain, letters)
    return lines or [" "]


def shortened(text: str, letters: int) -> str:
    """Return a text, cut where it has more letters than that."""
    return text if len(text) <= letters else f"{text[:letters]}..."


def legend_columns(names: Sequence[str], width: float) -> int:
    """Return the largest number of columns of a legend that is not wider than that (inch).

    Parameters
    ----------
    names : sequence of str
        Names in the legend.
    width : float
        Of the legend (inch).

    Returns
    -------
    int
        One at least.
    """
    em = LEGEND_SIZE / _INCH
    widths = [
        max(width_of(line, LEGEND_SIZE) for line in name.splitlines() or [" "]) for name in names
    ]
    for columns in range(min(len(names), _MOST_COLUMNS), 1, -1):
        parts = np.array_split(widths, columns)  # as matplotlib shares them out
        signs = columns * _HANDLE + (columns - 1) * _BETWEEN
        whole = sum(float(part.max()) for part in parts) + signs * em
        if whole <= width:
            return columns
    return 1


@dataclass(frozen=True)
class _Named:
    """Things that are named above a panel, or beside it."""

    axes: Axes
    handles: Sequence[Any]
    is_beside: bool = False

    def write(self) -> tuple[float, float]:
        """Make the legend; return by how much the figure grows (inch): in width and in height."""
        room = _BESIDE if self.is_beside else max(_width_of_panel(self.axes), _NARROWEST)
        room -= 2.0 * _HANDLE * LEGEND_SIZE / _INCH
        names = ["\n".join(wrapped(str(h.get_label()), room, LEGEND_SIZE)) for h in self.handles]
        if self.is_beside:
            place: dict[str, Any] = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5)}
            box = self.axes.legend(self.handles, names, **place).get_window_extent()
            return float(box.width) / _DPI, 0.0
        return 0.0, self._write_above(names, legend_columns(names, room))

    def _write_above(self, names: Sequence[str], columns: int) -> float:
        """Write a legend above the panel and its title; return its height (inch).

        A panel that gave a legend its room would become narrower, and then too narrow for it: so
        the layout knows no legend, only an empty line at its upper edge.
        """
        axes = self.axes
        title = _height_of_title(axes)
        above = axes.transAxes + ScaledTranslation(0.0, title, axes.figure.dpi_scale_trans)
        made = axes.legend(
            self.handles,
            names,
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            bbox_transform=above,
            ncols=columns,
            borderaxespad=0.2,
        )
        made.set_in_layout(False)
        height = float(made.get_window_extent().height) / _DPI
        for text in [text for text in axes.texts if text.get_gid() == _EDGE]:
            text.remove()
        axes.annotate(
            " ",
            (0.0, 1.0),
            xytext=(0.0, (title + height) * _INCH),
            xycoords="axes fraction",
            textcoords="offset points",
            fontsize=1.0,
            gid=_EDGE,
        )
        return height


class Sheet(Figure):
    """A figure of panels with lines below; legends, labels and lines have room of their own.

    Parameters
    ----------
    lines : sequence of str
        Below the panels.
    width, height : float
        Of the panels with their labels (inch): legends and the lines below come on top.
    colour : str
        Of the lines below.
    """

    def __init__(self, lines: Sequence[str], width: float, height: float, colour: str) -> None:
        super().__init__(figsize=(width, height), layout="constrained", dpi=_DPI)
        self._panel_size = (width, height)
        self._caption_lines = lines
        self._caption_colour = colour
        self._named: dict[Axes, _Named] = {}

    def name(self, axes: Axes, handles: Sequence[Any], is_beside: bool = False) -> None:
        """Name things that are drawn in a panel above it, or beside it, when the figure is fit."""
        self._named[axes] = _Named(axes, handles, is_beside)

    def fit(self) -> None:
        """Give everything its room; called when all is drawn, and again if that has changed."""
        panels = [*self.axes, *_scales(self.axes)]
        for axes in panels:
            _show_single_points(axes)
            for axis in (axes.xaxis, axes.yaxis):
                axis.label.set_parse_math(False)
        self.draw_without_rendering()
        for axes in panels:
            for axis in (axes.xaxis, axes.yaxis):
                _move_power(axis)
        if any([_fit_labels(axes) for axes in panels]):
            self.draw_without_rendering()
        self._grow()
        self.draw_without_rendering()

    def _grow(self) -> None:
        """Write legends and lines, and grow by them; of a row of panels, by its highest legend."""
        width, height = self._panel_size
        rows: dict[int, float] = {}
        for axes, named in self._named.items():
            wider, higher = named.write()
            width = max(width, self._panel_size[0] + wider)
            place = axes.get_subplotspec()
            row = 0 if place is None else place.rowspan.start
            rows[row] = max(rows.get(row, 0.0), higher)
        self.set_size_inches(width, height + sum(rows.values()) + self._write_lines(width))

    def _write_lines(self, width: float) -> float:
        """Write the lines below a figure of this width (inch); return their height (inch)."""
        room = 0.99 * width - _MARGIN
        pieces = [
            line for text in self._caption_lines for line in wrapped(text, room, _CAPTION_SIZE)
        ]
        if len(pieces) > _MOST_LINES:
            pieces = [*pieces[: _MOST_LINES - 1], "... (run.json has the rest)"]
        style: dict[str, Any] = {"fontsize": _CAPTION_SIZE, "color": self._caption_colour}
        self.supxlabel("\n".join(pieces), x=0.01, ha="left", linespacing=1.3, **style)
        return len(pieces) * 1.3 * _CAPTION_SIZE / _INCH


def _scales(panels: Iterable[Axes]) -> Iterator[Any]:
    """Yield the second scales of panels, which are axes without a panel."""
    for axes in panels:
        yield from axes.child_axes


def _show_single_points(axes: Axes) -> None:
    """Draw a curve of one point as a point."""
    for line in axes.get_lines():
        if len(line.get_xdata()) == 1 and line.get_marker() in ("None", "", None):  # type: ignore[arg-type]  # the stubs have any artist's data
            line.set(marker="o", markersize=3.5)


def _move_power(axis: Axis) -> None:
    """Write the power of ten of the numbers at an axis behind its label."""
    power = axis.get_offset_text()
    if power.get_visible() and power.get_text():
        axis.set_label_text(f"{axis.get_label_text()} × {power.get_text()}".strip())
        power.set_visible(False)


def _height_of_title(axes: Axes) -> float:
    """Return the height (inch) of the title of a panel, with the gap below it."""
    words = [loc for loc in ("left", "center", "right") if axes.get_title(loc).strip()]
    return 1.7 * LEGEND_SIZE / _INCH if words else 0.0


def _width_of_panel(axes: Axes) -> float:
    """Return the width (inch) of a panel."""
    return float(axes.get_window_extent().width) / _DPI


def _fit_labels(axes: Axes) -> bool:
    """Break the label and title of a panel that are longer than its sides; tell whether any was."""
    box = axes.get_window_extent()
    sides = (
        (axes.xaxis.label, box.width, False),
        (axes.yaxis.label, box.height, True),
        (axes.title, box.width, False),
        (axes._left_title, box.width, False),  # type: ignore[attr-defined]  # there is no other way to it
    )
    return any([_break_text(text, side / _DPI, upright) for text, side, upright in sides])


def _break_text(text: Text, side: float, upright: bool) -> bool:
    """Break a text that is longer than a side (inch) into lines; tell whether it was."""
    words = text.get_text()
    size = float(text.get_fontsize())
    if all(width_of(line, size) <= side for line in words.splitlines()):
        return False
    lines = [piece for line in words.splitlines() for piece in wrapped(line, side, size)]
    text.set_text("\n".join(lines))
    return True
