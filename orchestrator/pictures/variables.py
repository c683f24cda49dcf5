"""Any recorded variables over time, of one run or several, a panel for each unit."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rockshed.components.common.units import UNITS, ms

from ..core.results.series import Series
from ..metrics.measured import MeasuredCurve
from .style import COLOURS, INK, WIDTH, legend, literal, styled

_PANEL = 2.2
"""Height of a panel (inch)."""
_DASHES = ("-", "--", ":", "-.")
"""Dashes of the runs, in turn."""
_MOST_NAMED = 60
"""Curves that are named in a legend, at most."""


@dataclass(frozen=True)
class _Curve:
    """A curve with its name in the legend, the number of its run, and that of its variable."""

    series: Series
    label: str
    run: int
    number: int


def draw(
    runs: Mapping[str, Sequence[Series]],
    measured: Sequence[MeasuredCurve],
    caption: Sequence[str],
    side_by_side: bool = False,
) -> Figure:
    """Draw variables over time.

    Parameters
    ----------
    runs : mapping of str to sequence of Series
        Variables by the name of their run; those with one unit share a panel.
    measured : sequence of MeasuredCurve
        Drawn as points into the panels of their unit.
    caption : sequence of str
        Lines below the figure that say what was run.
    side_by_side : bool
        Whether each run has a column of panels of its own, with scales that all have.

    Returns
    -------
    Figure
        With a row of panels for each unit, in the order in which the units come.
    """
    units = list(dict.fromkeys(entry.unit for part in runs.values() for entry in part))
    columns = [[number] for number in range(len(runs))] if side_by_side else [[*range(len(runs))]]
    size = (WIDTH * (1.0 if len(columns) == 1 else 0.7 * len(columns)), 0.5 + _PANEL * len(units))
    curves = list(_curves(runs))
    with styled(caption, *size) as figure:
        panels = figure.subplots(len(units), len(columns), sharex=True, sharey="row", squeeze=False)
        for row, unit in zip(panels, units, strict=True):
            for axes, chosen in zip(row, columns, strict=True):
                members = [c for c in curves if c.series.unit == unit and c.run in chosen]
                points = [curve for curve in measured if curve.unit == unit]
                _panel(axes, unit, members, points)
        _share_time(panels.ravel().tolist(), runs)
        figure.fit()
    return figure


def _curves(runs: Mapping[str, Sequence[Series]]) -> Iterator[_Curve]:
    """Yield all curves; the name of the run is said where there are several."""
    numbers: dict[str, int] = {}
    for run, (name, variables) in enumerate(runs.items()):
        for series in variables:
            number = numbers.setdefault(series.name, len(numbers))
            words = f"{name}: {series.name}" if len(runs) > 1 else series.name
            yield _Curve(series, literal(words), run, number)


def _panel(
    axes: Axes, unit: str, members: Sequence[_Curve], measured: Sequence[MeasuredCurve]
) -> None:
    """Draw variables of one unit, each named in the legend."""
    variables = list(dict.fromkeys(curve.number for curve in members))
    # one variable of several runs: a colour for each run
    of_runs = len(variables) == 1
    parts = [curve.run if of_runs else variables.index(curve.number) for curve in members]
    colours = _colours(max(parts, default=0) + 1)
    for curve, part in zip(members, parts, strict=True):
        axes.plot(
            curve.series.time,
            curve.series.values,
            "-" if of_runs else _DASHES[curve.run % len(_DASHES)],
            color=colours[part],
            label=curve.label,
        )
    for points, marker in zip(measured, cycle("os^D")):
        label = f"measured: {literal(points.name)}"
        few = max(1, points.time.size // 60)
        style: dict[str, Any] = {"linewidth": 0.6, "markersize": 2.5, "markevery": few}
        axes.plot(points.time, points.values, color=INK, marker=marker, label=label, **style)
    axes.set_ylabel(_label(unit))
    axes.label_outer(remove_inner_ticks=True)
    handles = axes.get_legend_handles_labels()[0]
    more = len(handles) - _MOST_NAMED
    if more > 0:
        (rest,) = axes.plot([], [], linestyle="none", label=f"and {more} more")
        handles = [*handles[:_MOST_NAMED], rest]
    legend(axes, handles)


def _colours(number: int) -> Sequence[str] | np.ndarray:
    if number <= len(COLOURS):
        return COLOURS
    return colormaps["viridis"](np.linspace(0.0, 1.0, number))


def _share_time(panels: Sequence[Axes], runs: Mapping[str, Sequence[Series]]) -> None:
    """Let the axis of time reach from the first to the last row of all runs, in ms if it is short.

    Curves are drawn in seconds: the numbers at the axis are in its unit.
    """
    times = [entry.time for part in runs.values() for entry in part if entry.time.size]
    begin = min((float(time[0]) for time in times), default=0.0)
    end = max((float(time[-1]) for time in times), default=0.0)
    is_short = 0.0 < end < 1.0
    for axes in panels:
        if end > begin:
            axes.set_xlim(begin, end)
        if is_short:
            axes.xaxis.set_major_formatter(lambda value, place: f"{value / ms:g}")
        if axes.get_subplotspec().is_last_row():  # type: ignore[union-attr]  # each has a place
            axes.set_xlabel("time (ms)" if is_short else "time (s)")


def _label(unit: str) -> str:
    """Return quantity and unit as the axis shows them; of a number without unit, nothing.

    A torque is called a moment: both are N m, and the name of the variable tells which.
    """
    if unit == "1":
        return ""
    shown = unit.replace(".", " ")
    if unit not in UNITS:
        return f"({shown})"
    quantity = UNITS[unit].quantity.replace("Torque", "Moment")
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", quantity).lower()
    return f"{words} ({shown})"
