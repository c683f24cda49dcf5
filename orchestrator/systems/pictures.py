"""The figure of the impact systems: error over exchange step, a panel for each system."""

import math
from collections.abc import Sequence
from pathlib import Path

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from ..analyses.drawing import drawn
from ..pictures.style import BEAM, GREY, INK, ROCK, SAND, TRANSMITTED, WIDTH
from .catalogue import impact_system
from .jobs import NATIVE
from .masters.table import MASTERS
from .measured import MasterRun, SuiteRuns
from .results import mean_step

_COLUMNS = 2
_COLOURS = (TRANSMITTED, ROCK, BEAM, INK, SAND, GREY)
_MARKERS = "osD^v<>pPX*hd+x8H|"
_ROOM = 0.16
"""Part of an axis that the label of a step needs."""
_SHOWN = (1e-7, 3.0)
"""Errors that are drawn; runs beyond them have lost the way, or show rounding."""


def draw(measured: SuiteRuns, file: Path) -> Path:
    """Draw the errors of all masters on all systems.

    Parameters
    ----------
    measured : SuiteRuns
        The measurements.
    file : Path
        Of the picture.

    Returns
    -------
    Path
        The file.
    """
    rows = [row for row in measured.rows if row.variant == NATIVE.name and row.error]
    names = list(dict.fromkeys(row.system for row in rows))
    lines = -(-len(names) // _COLUMNS)
    with drawn([], WIDTH, 2.5 * lines + 1.2) as picture:
        panels = picture.subplots(lines, _COLUMNS, squeeze=False).flat
        for panel, name in zip(panels, names, strict=False):
            _panel(panel, name, [row for row in rows if row.system == name])
        for panel in list(panels)[len(names) :]:
            panel.set_visible(False)
        handles: dict[str, Artist] = {}
        for panel in picture.axes:
            found = panel.get_legend_handles_labels()
            handles |= dict(zip(found[1], found[0], strict=True))
        ordered = [m.name for m in MASTERS if m.name in handles]
        picture.legend(
            [handles[name] for name in ordered], ordered, loc="outside lower center", ncols=3
        )
        picture.savefig(file, dpi=150)
    return file


def _apart(steps: Sequence[float]) -> list[float]:
    """Return the steps whose labels do not run into one another, the finest among them."""
    room = _ROOM * math.log(steps[0] / steps[-1])
    chosen = [steps[-1]]
    for step in reversed(steps):
        if math.log(step / chosen[-1]) > room:
            chosen.append(step)
    return chosen


def _panel(axes: Axes, name: str, rows: Sequence[MasterRun]) -> None:
    """Draw one system; markers are open and of different size, as many curves are the same."""
    system = impact_system(name)
    for number, master in enumerate(MASTERS):
        points = sorted(
            (mean_step(row), row.error)
            for row in rows
            if row.master == master.name and row.error and _SHOWN[0] < row.error < _SHOWN[1]
        )
        if points:
            axes.plot(
                *zip(*points, strict=True),
                color=_COLOURS[number % len(_COLOURS)],
                marker=_MARKERS[number],
                markersize=9.0 - 0.35 * number,
                markerfacecolor="none",
                linewidth=0.8,
                label=master.name,
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    places = _apart(system.steps)
    axes.set_xticks(places, [f"{1e3 * step:g}" for step in places])
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.minorticks_off()
    axes.set_title(name, fontsize="small")
    axes.set_xlabel("mean exchange step (ms)")
    axes.set_ylabel("error / largest value")
