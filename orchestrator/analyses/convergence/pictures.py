"""The picture of a convergence study: each figure over the sizes, beside the finest."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...metrics import names
from ...pictures.style import GREY, INK, ROCK, TRANSMITTED, WIDTH
from ..drawing import drawn
from ..frame import Drawing
from .figures import TOLERANCE, Measured
from .meshes import DISCS, ELEMENTS

if TYPE_CHECKING:
    from .result import ConvergenceResult

_CURVES = (
    (names.SETTLED_ROCK, ROCK, "o", -0.03),
    (names.SETTLED_TRANSMITTED, TRANSMITTED, "s", -0.01),
    (names.PENETRATION, GREY, "^", 0.01),
    (names.PEAK_MOMENT, INK, "D", 0.03),
)
"""Figures that are drawn: name, colour, marker, and part by which they are moved aside."""


def drawings(result: "ConvergenceResult") -> dict[str, Drawing]:
    """Return a function for the figure of a study.

    Parameters
    ----------
    result : ConvergenceResult
        The study.

    Returns
    -------
    dict of str to callable
        By the name of the file without its ending.
    """
    return {"convergence": partial(overview, result)}


def overview(result: "ConvergenceResult") -> Figure:
    """Draw each figure over the number of discs and of elements, as a part of the finest mesh's.

    Parameters
    ----------
    result : ConvergenceResult
        The study.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with drawn(result.notes[:1], WIDTH, 4.2) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, refined in zip(panels, (DISCS, ELEMENTS), strict=True):
            series = [entry for entry in result.measured if entry.mesh.refined == refined]
            _panel(axes, series, refined)
        panels[0].set_ylabel("mean / that of the finest mesh")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=2)
    return figure


def _panel(axes: Axes, series: Sequence[Measured], refined: str) -> None:
    """Draw the figures over the fineness of what is refined."""
    axes.axhspan(1.0 - TOLERANCE, 1.0 + TOLERANCE, color=GREY, alpha=0.2, linewidth=0)
    axes.axhline(1.0, color=GREY, linewidth=0.7)
    for name, colour, marker, aside in _CURVES:
        known = [entry for entry in series if name in entry.estimates]
        if not known:
            continue
        finest = known[-1].estimates[name].mean
        axes.errorbar(
            [entry.mesh.fineness * (1.0 + aside) for entry in known],
            [entry.estimates[name].mean / finest for entry in known],
            yerr=[entry.estimates[name].error / finest for entry in known],
            color=colour,
            marker=marker,
            markersize=4.0,
            linewidth=1.0,
            capsize=2.0,
            label=name,
        )
    axes.set_xscale("log", base=2)
    axes.set_xticks([entry.mesh.fineness for entry in series], [_size(e, refined) for e in series])
    axes.minorticks_off()
    axes.set_xlabel("radius of the discs (mm)" if refined == DISCS else "number of beam elements")


def _size(entry: Measured, refined: str) -> str:
    radius = f"{1e3 * entry.mesh.disc_radius:.3g}"
    text = radius if refined == DISCS else str(entry.mesh.elements)
    return f"{text}\nproject" if entry.mesh.fineness == 1.0 else text
