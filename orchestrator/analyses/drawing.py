"""Figures of the analyses in the look of all pictures."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from matplotlib.figure import Figure

from ..pictures.style import styled


@contextmanager
def drawn(lines: Sequence[str], width: float, height: float) -> Iterator[Figure]:
    """Open a figure that keeps the look of all pictures after the block.

    Parameters
    ----------
    lines : sequence of str
        Stand below the figure.
    width, height : float
        Size (inch).

    Yields
    ------
    matplotlib.figure.Figure
        Empty but for the lines.
    """
    with styled(lines, width, height) as figure:
        yield figure
        figure.draw_without_rendering()  # ticks are made when they are drawn: here, in this look
