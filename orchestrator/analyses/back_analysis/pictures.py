"""Pictures of a back-analysis: measured and computed end points, and the parameters."""

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...pictures.style import GREY, INK, ROCK, SAND, WIDTH, legend, literal
from ..drawing import drawn
from ..frame import Drawing
from .forecast import CONFIDENCE, Forecast

if TYPE_CHECKING:
    from .result import BackAnalysisResult


def drawings(result: "BackAnalysisResult") -> dict[str, Drawing]:
    """Return a function for each figure of a back-analysis.

    Parameters
    ----------
    result : BackAnalysisResult
        Parameters, fit and forecast.

    Returns
    -------
    dict of str to callable
        By the name of the file without its ending.
    """
    return {"ends": partial(ends, result), "parameters": partial(parameters, result)}


def ends(result: "BackAnalysisResult") -> Figure:
    """Draw the part of the rocks that end before x, measured, fitted and foretold.

    Parameters
    ----------
    result : BackAnalysisResult
        Parameters, fit and forecast.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for the slope of the data, and one for that of the forecast.
    """
    made = [result.fitted, *([result.forecast] if result.forecast else [])]
    words = f"Bands: {100 * CONFIDENCE:.0f} % of the posterior. {result.summary}."
    with drawn([literal(result.name), words], WIDTH, 2.8 * len(made)) as figure:
        panels = figure.subplots(len(made), 1, squeeze=False)[:, 0]
        for axes, entry in zip(panels, made, strict=True):
            _band(axes, entry)
            axes.set(xlabel="x (m)", ylabel="ended before x (%)", ylim=(0.0, 104.0))
            axes.set_title(literal(entry.name))
        measured = np.sort(result.inferred.end_points)
        parts = 100.0 * np.arange(1, len(measured) + 1) / len(measured)
        panels[0].plot(measured, parts, drawstyle="steps-post", color=ROCK, label="measured")
        for axes in panels:
            legend(axes)
    return figure


def _band(axes: Axes, forecast: Forecast) -> None:
    """Draw the distribution of the end points, and its band over the posterior."""
    inside = forecast.ends[np.isfinite(forecast.ends)]
    x = np.linspace(inside.min(), inside.max(), 300)
    each = np.array([np.searchsorted(np.sort(row), x, "right") / len(row) for row in forecast.ends])
    tail = 50.0 * (1.0 - CONFIDENCE)
    low, high = np.percentile(each, [tail, 100.0 - tail], axis=0)
    axes.fill_between(x, 100.0 * low, 100.0 * high, color=SAND, alpha=0.5, linewidth=0.0)
    axes.plot(x, 100.0 * each.mean(axis=0), color=INK, linewidth=1.1, label="computed")


def parameters(result: "BackAnalysisResult") -> Figure:
    """Draw a histogram of each parameter over the range in which it was sought.

    Parameters
    ----------
    result : BackAnalysisResult
        With the samples.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each parameter; the prior is level in it.
    """
    entries = result.inferred.parameters
    rows = -(-len(entries) // 3)
    with drawn(
        [literal(result.name), "Posterior; the prior is level."], WIDTH, 1.9 * rows
    ) as figure:
        panels = figure.subplots(rows, 3, squeeze=False).ravel()
        for axes in panels[len(entries) :]:
            axes.remove()
        for axes, entry, places in zip(panels, entries, result.inferred.posterior.places.T):
            bins = entry.value(np.linspace(0.0, 1.0, 31))
            axes.hist(entry.value(places), bins=list(bins), color=GREY)
            axes.set(xlabel=literal(entry.name), yticks=[])
            if entry.is_logarithmic:
                axes.set_xscale("log")
    return figure
