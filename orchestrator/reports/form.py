"""Form of a report as data, whatever it is about and however it is written.

A run, a campaign and a pile become chapters; a page in HTML and a PDF are written of them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..tables import Table

CurveValues = NDArray[np.float64]
"""Numbers of a curve, shape (n,)."""
Drawer = Callable[[Path], None]
"""Draws a picture into a file; its ending, ``.png`` or ``.svg``, tells the format."""


@dataclass(frozen=True)
class ChartCurve:
    """A curve of a chart.

    Attributes
    ----------
    label : str
        Its name in the legend.
    x, y : array of float, shape (n,)
        In the units of the axes.
    colour : str
        Hexadecimal, ``#1f5a94``.
    dash : str
        ``solid``, ``dash``, ``dot`` or ``dashdot``.
    layer : bool
        Whether it is a layer that lies on the layers before it.
    markers : bool
        Whether its points are marked.
    """

    label: str
    x: CurveValues
    y: CurveValues
    colour: str
    dash: str = "solid"
    layer: bool = False
    markers: bool = False


@dataclass(frozen=True)
class Chart:
    """Curves over one pair of axes.

    Attributes
    ----------
    x_label, y_label : str
        Quantity and unit of the axes.
    curves : sequence of ChartCurve
        At least one.
    downwards : bool
        Whether the vertical axis points down.
    note : str
        A line below the chart.
    """

    x_label: str
    y_label: str
    curves: Sequence[ChartCurve]
    downwards: bool = False
    note: str = ""


@dataclass(frozen=True)
class Film:
    """Recorded states of a cushion one after the other.

    Attributes
    ----------
    component : str
        Name of the cushion.
    facts : mapping
        Plain data: ranges, number of discs, texts of the frames.
    arrays : mapping of str to ndarray
        Numbers of all frames, see :mod:`rockshed.reports.film`.
    """

    component: str
    facts: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class Illustration:
    """A picture of a report, as far as possible in a form that one can move through.

    Attributes
    ----------
    title : str
        Shown above it.
    charts : sequence of Chart
        The same as curves; empty where there is only the drawn picture.
    film : Film or None
        The states from which it was drawn.
    draw : Drawer or None
        Draws it for print; None if it is shown in the page alone.
    on_page : bool
        Whether the page shows it: a film shows what several pictures show.
    printed : str
        Ending of the drawn file for print, ``.svg`` where lines are to stay sharp.
    shown : str
        Ending of the drawn file for the page.
    """

    title: str
    charts: Sequence[Chart] = ()
    film: Film | None = None
    draw: Drawer | None = None
    on_page: bool = True
    printed: str = ".png"
    shown: str = ".png"

    def drawn_into(self, file: Path) -> str:
        """Draw the picture into a file.

        Parameters
        ----------
        file : Path
            Its ending tells the format.

        Returns
        -------
        str
            Why it could not be drawn; empty if it was.
        """
        if self.draw is None:
            return "It is drawn in the page alone."
        try:
            self.draw(file)
        except Exception as error:  # the rest of the report is told even if a picture fails
            return f"It could not be drawn ({type(error).__name__}: {error})."
        return ""


@dataclass(frozen=True)
class Chapter:
    """A part of a report.

    Attributes
    ----------
    title : str
        Its heading.
    paragraphs : sequence of str
        A sentence or a few each.
    tables : sequence of Table
        Below the paragraphs.
    listing : str
        Text of a file or of commands, shown letter for letter.
    illustrations : sequence of Illustration
        Below the tables.
    folded : bool
        Whether the page shows it only when it is asked for.
    alarm : bool
        Whether it has to be read before all others.
    """

    title: str
    paragraphs: Sequence[str] = ()
    tables: Sequence[Table] = ()
    listing: str = ""
    illustrations: Sequence[Illustration] = ()
    folded: bool = False
    alarm: bool = False


@dataclass(frozen=True)
class Document:
    """A report on one result.

    Attributes
    ----------
    title : str
        Its name, with values of this result.
    lines : sequence of str
        Below the title.
    status : str
        Why the result is not complete; empty if it is.
    chapters : sequence of Chapter
        In the order in which they are read.
    """

    title: str
    lines: Sequence[str]
    status: str
    chapters: Sequence[Chapter]
