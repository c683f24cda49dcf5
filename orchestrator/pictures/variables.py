"""Any recorded variables over time, a panel for each unit."""

import re
from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from rockshed.components.common.units import UNITS, ms

from ..core.results.series import Series
from .style import WIDTH, over_time, styled

_PANEL = 2.2
"""Height of a panel (inch)."""
_LEGEND_LINES = 12
"""Variables in a column of the legend of a panel."""
_LEGEND_COLUMN = 1.6
"""Width of a further column of the legend (inch)."""
_COLOURS = 10
"""Variables in a panel that have a colour of the style; more of them have a scale of colours."""


def draw(variables: Sequence[Series], caption: Sequence[str]) -> Figure:
    """Draw variables over time.

    Parameters
    ----------
    variables : sequence of Series
        Of one run; those with one unit share a panel.
    caption : sequence of str
        Lines below the figure that say what was run.

    Returns
    -------
    Figure
        With one panel for each unit, in the order in which the units come.
    """
    panels: dict[str, list[Series]] = {}
    for variable in variables:
        panels.setdefault(variable.unit, []).append(variable)
    height = 0.8 + _PANEL * max(len(panels), 1)
    columns = max(map(_columns, panels.values()), default=1)
    with styled(caption, WIDTH + _LEGEND_COLUMN * (columns - 1), height) as figure:
        axes = figure.subplots(max(len(panels), 1), sharex=True, squeeze=False)[:, 0]
        for panel, (unit, members) in zip(axes, panels.items(), strict=False):
            _panel(panel, unit, members)
        for text in figure.findobj(Text):
            text.set_parse_math(False)  # names are text: a dollar in them is a dollar
    return figure


def _panel(axes: Axes, unit: str, members: Sequence[Series]) -> None:
    """Draw variables of one unit, each named in the legend with its description."""
    time = members[0].time
    short = bool(time.size) and float(time[-1]) < 1.0
    scale = ms if short else 1.0
    if len(members) > _COLOURS:
        axes.set_prop_cycle(color=colormaps["viridis"](np.linspace(0.0, 1.0, len(members))))
    for variable in members:
        axes.plot(time / scale, variable.values, label=f"{variable.name}")
    if time.size:
        over_time(axes, time / scale)
    axes.set_ylabel(_label(unit))
    axes.set_xlabel("time (ms)" if short else "time (s)")
    axes.label_outer(remove_inner_ticks=True)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=_columns(members))


def _columns(members: Sequence[Series]) -> int:
    """Return the number of columns of a legend."""
    return -(-len(members) // _LEGEND_LINES)


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
