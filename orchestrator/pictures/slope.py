"""The slope of a shed to scale: profile, the way of the rock down to it, and the roof."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle
from numpy.typing import NDArray

from ..core.results.facts import number_of, table_of, tables_of
from ..core.results.reading import StoredRun
from ..metrics.slope import slope_of
from .style import BEAM, FAINT, GREY, INK, ROCK, SAND, WIDTH, figure, legend, literal

_ROOM = 0.12
"""Room around what is shown / its size."""
_AROUND = 1.2
"""Length shown beside the cushion / its width, in the near view."""
_HIGHEST = 0.4
"""Height above the cushion that is shown in the near view / its length, at most."""
_HEIGHTS = (1.5, 6.5)
"""Heights (inch) of a panel."""

_Floats = NDArray[np.float64]


def slope(run: StoredRun, file: Path) -> None:
    """Draw the whole slope, and below it the roof with the last part of the rock's way.

    Parameters
    ----------
    run : StoredRun
        That has a slope.
    file : Path
        File of the picture.
    """
    told = slope_of(run)
    nodes = np.array(told["nodes"], float)
    path = np.array(told["trajectory"], float)
    roof = table_of(told, "roof")
    whole, near = _whole(nodes, path, roof), _near(roof, path)
    heights = [float(np.clip(WIDTH * _shape(view), *_HEIGHTS)) for view in (whole, near)]
    with figure(run, file, WIDTH, sum(heights) + 1.0) as made:
        above, below = made.subplots(2, 1, height_ratios=heights)
        _draw(above, told, nodes, path, whole)
        _draw(below, told, nodes, path, near)
        radius = number_of(table_of(run.provenance, "design", "rock"), "radius") or 0.0
        label = "rock at the hand-over, to scale"
        below.add_patch(Circle((path[-1, 0], path[-1, 1]), radius, color=ROCK, label=label))
        above.set_title(f"trial {told['trial']} on the slope {literal(str(told['name']))}")
        legend(below)


def _shape(view: _Floats) -> float:
    return float((view[3] - view[2]) / (view[1] - view[0]))


def _framed(x: _Floats, y: _Floats) -> _Floats:
    """Return the limits of a view in which these points stand, with room around them."""
    room = _ROOM * max(float(np.ptp(x)), float(np.ptp(y)), 1.0)
    return np.array([x.min() - room, x.max() + room, y.min() - room, y.max() + room])


def _whole(nodes: _Floats, path: _Floats, roof: Mapping[str, Any]) -> _Floats:
    ends = [[roof["left"], roof["y"]], [roof["right"], roof["surface"]]]
    every = np.concatenate([nodes, path, ends])
    return _framed(every[:, 0], every[:, 1])


def _near(roof: Mapping[str, Any], path: _Floats) -> _Floats:
    """Return the limits of the view of the roof."""
    left, right, surface = (float(roof[name]) for name in ("left", "right", "surface"))
    width = right - left
    left, right = left - 0.5 * _AROUND * width, right + 0.5 * _AROUND * width
    shown = path[(left <= path[:, 0]) & (path[:, 0] <= right)]
    highest = float(shown[:, 1].max(initial=surface + 1.0))
    top = min(highest, surface + _HIGHEST * (right - left))
    return np.array([left, right, float(roof["y"]) - 0.25 * width, top + 0.05 * width])


def _draw(
    axes: Axes, told: Mapping[str, Any], nodes: _Floats, path: _Floats, view: _Floats
) -> None:
    """Draw one view, lengths and heights at one scale."""
    roof = table_of(told, "roof")
    left, right, low, high = view
    x = np.concatenate([[left], nodes[:, 0], [right]])
    y = np.concatenate([nodes[:1, 1], nodes[:, 1], nodes[-1:, 1]])
    inside = slice(1, -1) if left < nodes[0, 0] or right > nodes[-1, 0] else slice(None)
    axes.fill_between(x[inside], y[inside], min(low, y.min()) - 1.0, color=FAINT, linewidth=0.0)
    axes.plot(nodes[:, 0], nodes[:, 1], color=INK, linewidth=1.0, label="profile")
    axes.plot(path[:, 0], path[:, 1], color=ROCK, linewidth=1.1, label="way of its centre")
    ends = (roof["left"], roof["right"])
    width, depth = ends[1] - ends[0], roof["surface"] - roof["y"]
    box = (roof["left"], roof["y"])
    axes.add_patch(Rectangle(box, width, depth, color=SAND, linewidth=0.0, label="cushion"))
    axes.plot(ends, [roof["y"]] * 2, color=BEAM, linewidth=2.0, label="top of the roof")
    for barrier in tables_of(told, "barriers"):
        foot = float(barrier["y"])
        name = literal(str(barrier["name"]))
        axes.plot(
            [barrier["x"]] * 2,
            [foot, foot + float(barrier["height"])],
            color=GREY,
            linewidth=2.0,
            label=name,
        )
    axes.set(xlabel="x (m)", ylabel="y (m)", xlim=(left, right), ylim=(low, high))
    axes.set_aspect("equal", adjustable="box")
