"""Pictures of a study: tornado, effects of the factors, and curves of exceedance."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...pictures.style import BEAM, GREY, INK, ROCK, TRANSMITTED, WIDTH
from ..drawing import drawn
from ..frame import Drawing
from .designs import SAMPLED
from .headline import on_screen, titled
from .records import StudyRecords, values_of
from .result import StudyResult
from .statistics import exceedance, spreads

_MOST_PANELS = 4
"""Metrics in a picture."""
_COLOURS = (TRANSMITTED, ROCK, BEAM, INK)


def drawings(result: StudyResult) -> dict[str, Drawing]:
    """Return a function for each figure of a study.

    Parameters
    ----------
    result : StudyResult
        The study.

    Returns
    -------
    dict of str to callable
        By the name of the file without its ending.
    """
    records = result.records
    metrics = [m for m in result.metric_names if spreads(records, m)][:_MOST_PANELS]
    found: dict[str, Drawing] = {}
    if metrics:
        found["tornado"] = partial(tornado, records, metrics)
        found["effects"] = partial(effects, records, metrics)
    told = [m for m in result.metric_names if len(values_of(records.sample, m)) > 1]
    if records.design in SAMPLED and told:
        found["exceedance"] = partial(exceedances, records, told[:_MOST_PANELS])
    return found


def tornado(records: StudyRecords, metrics: Sequence[str]) -> Figure:
    """Draw the spread of each metric over each factor as bars, the widest on top.

    Parameters
    ----------
    records : StudyRecords
        Of the study.
    metrics : sequence of str
        Identifiers.

    Returns
    -------
    matplotlib.figure.Figure
    """
    height = (0.5 + 0.32 * len(records.factors)) * len(metrics) + 0.6
    line = "bars: lowest to highest mean over one factor, whatever the others are"
    with drawn([line], WIDTH, height) as figure:
        panels = np.atleast_1d(figure.subplots(len(metrics), 1))
        for axes, metric in zip(panels, metrics, strict=True):
            _bars(axes, records, metric)
    return figure


def _bars(axes: Axes, records: StudyRecords, metric: str) -> None:
    scale = on_screen(records.names[metric].unit)[1]
    found = spreads(records, metric)
    places = np.arange(len(found))[::-1]
    low = np.array([spread.low for spread in found]) / scale
    high = np.array([spread.high for spread in found]) / scale
    axes.barh(places, high - low, left=low, height=0.6, color=TRANSMITTED)
    mean = values_of(records.sample, metric).mean() / scale
    axes.axvline(mean, color=INK, linewidth=0.8)
    axes.use_sticky_edges = False
    axes.margins(x=0.08)
    axes.set_yticks(places, [spread.factor for spread in found])
    axes.set_xlabel(titled(records, metric))
    axes.grid(visible=False, axis="y")


def effects(records: StudyRecords, metrics: Sequence[str]) -> Figure:
    """Draw each run of each metric over each factor, and the means of the levels.

    Parameters
    ----------
    records : StudyRecords
        Of the study.
    metrics : sequence of str
        Identifiers.

    Returns
    -------
    matplotlib.figure.Figure
    """
    factors = records.factors[:_MOST_PANELS]
    line = "points: runs; line: means of the levels, or of the thirds of a sample"
    with drawn([line], WIDTH, 1.7 * len(metrics) + 0.5) as figure:
        panels = figure.subplots(len(metrics), len(factors), squeeze=False, sharey="row")
        for row, metric in zip(panels, metrics, strict=True):
            for axes, factor in zip(row, factors, strict=True):
                _effect(axes, records, metric, factor.name)
            row[0].set_ylabel(titled(records, metric).replace(" (", "\n("))
        for axes, factor in zip(panels[-1], factors, strict=True):
            unit = "" if factor.unit == "1" else f" ({factor.unit})"
            axes.set_xlabel(f"{factor.name}{unit}")
    return figure


def _effect(axes: Axes, records: StudyRecords, metric: str, factor: str) -> None:
    """Draw the runs over one factor; words stand side by side."""
    scale = on_screen(records.names[metric].unit)[1]
    runs = [r for r in records.sample if metric in r.metrics and factor in r.inputs]
    inputs = [run.inputs[factor] for run in runs]
    words = list(dict.fromkeys(inputs)) if any(isinstance(v, str) for v in inputs) else []
    x = np.array([words.index(v) if words else float(v) for v in inputs], float)
    y = values_of(runs, metric) / scale
    axes.plot(x, y, ".", color=GREY, markersize=3.0)
    levels = np.unique(x)
    parts = [x == level for level in levels]
    if len(levels) > 12:
        order = np.argsort(x)
        parts = [np.isin(np.arange(len(x)), third) for third in np.array_split(order, 3)]
    centres = [float(x[part].mean()) for part in parts]
    axes.plot(centres, [float(y[part].mean()) for part in parts], "o-", color=TRANSMITTED)
    if words:
        axes.set_xticks(range(len(words)), [str(word) for word in words])
        axes.set_xlim(-0.5, len(words) - 0.5)


def exceedances(records: StudyRecords, metrics: Sequence[str]) -> Figure:
    """Draw the probability with which each metric exceeds a value, with its band.

    Parameters
    ----------
    records : StudyRecords
        Of the study.
    metrics : sequence of str
        Identifiers.

    Returns
    -------
    matplotlib.figure.Figure
    """
    line = f"{len(records.sample)} runs; band: pointwise 95 % interval"
    rows = (len(metrics) + 1) // 2
    with drawn([line], WIDTH, 2.4 * rows + 0.4) as figure:
        panels = figure.subplots(rows, min(2, len(metrics)), squeeze=False, sharey=True).ravel()
        for axes, metric, colour in zip(panels, metrics, _COLOURS):
            scale = on_screen(records.names[metric].unit)[1]
            curve = exceedance(values_of(records.sample, metric))
            x = curve.values / scale
            axes.fill_between(
                x, curve.low, curve.high, step="post", color=colour, alpha=0.2, linewidth=0
            )
            axes.step(x, curve.probability, where="post", color=colour)
            axes.set_xlabel(titled(records, metric))
            axes.set_ylim(0.0, 1.0)
        for axes in panels[len(metrics) :]:
            axes.set_axis_off()
        for axes in panels[:: min(2, len(metrics))]:
            axes.set_ylabel("probability of exceedance")
    return figure
