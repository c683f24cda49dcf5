"""Figures of the analyses in the look of all pictures."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ..pictures.style import styled

if TYPE_CHECKING:
    from ..pictures.sheet import Sheet


@contextmanager
def drawn(lines: Sequence[str], width: float, height: float) -> "Iterator[Sheet]":
    """Open a figure that keeps the look of all pictures after the block.

    Parameters
    ----------
    lines : sequence of str
        Stand below the figure.
    width, height : float
        Of the panels (inch).

    Yields
    ------
    Sheet
        Empty but for the lines.
    """
    with styled(lines, width, height) as figure:
        yield figure
        figure.fit()  # draws it too: ticks are made when they are drawn, here in this look
