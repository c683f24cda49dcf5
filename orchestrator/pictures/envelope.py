"""A declared array of a component along its places: the envelope, and the instant of its peak."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from rockshed.components.common.units import SCREEN_UNITS, ms

from ..core.results.reading import StoredRun
from ..metrics.along import along
from ..tables import digits
from .style import GREY, ROCK, TRANSMITTED


def draw_envelope(
    run: StoredRun, component: str, told: Mapping[str, Any], axes: Axes, owner: str
) -> None:
    """Draw the largest and the least values along a component, and those at the time of the peak.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    told : mapping
        The envelope as it is declared.
    axes : Axes
        Where to draw.
    owner : str
        Put before the label of the axis.
    """
    places, values = along(run, component, told)
    values = values / SCREEN_UNITS[told["unit"]]
    row = int(np.unravel_index(np.abs(values).argmax(), values.shape)[1])
    high, low = values.max(axis=1), values.min(axis=1)
    axes.fill_between(places, low, high, color=TRANSMITTED, alpha=0.15, linewidth=0.0)
    axes.plot(places, high, color=TRANSMITTED, linewidth=1.1, label="largest and least")
    axes.plot(places, low, color=TRANSMITTED, linewidth=1.1)
    instant = f"at {digits(run.series['time'][row] / ms)} ms"
    axes.plot(places, values[:, row], ".-", color=ROCK, linewidth=1.1, markersize=3, label=instant)
    axes.axhline(0.0, color=GREY, linewidth=0.7)
    axes.set(xlabel="x (m)", ylabel=f"{owner}{told['label']} ({told['unit']})")
    if places[-1] > places[0]:
        axes.set_xlim(places[0], places[-1])
