"""Figure of a convergence study of exchange steps."""

from functools import partial
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure as Picture
from matplotlib.ticker import FuncFormatter

from ...pictures.style import BEAM, GREY, INK, ROCK, SAND, TRANSMITTED, WIDTH
from ..drawing import drawn
from ..frame import Drawing
from .figures import Figure
from .tables import order_in_words

if TYPE_CHECKING:
    from .result import ExchangeStepsResult

_COLOURS = (TRANSMITTED, ROCK, BEAM, INK, SAND, GREY)
_MARKERS = "os^Dvx"


def drawings(result: "ExchangeStepsResult") -> dict[str, Drawing]:
    """Return a function for the figure of a study.

    Parameters
    ----------
    result : ExchangeStepsResult
        The study.

    Returns
    -------
    dict of str to callable
        By the name of the file without its ending.
    """
    return {"exchange-steps": partial(overview, result)}


def overview(result: "ExchangeStepsResult") -> Picture:
    """Draw the difference of each step from the next finer one over the step, both logarithmic.

    Parameters
    ----------
    result : ExchangeStepsResult
        The study.

    Returns
    -------
    matplotlib.figure.Figure
        Slopes 1 and 2 go through the middle.
    """
    with drawn(result.notes[:1], WIDTH, 4.2) as picture:
        axes = picture.subplots()
        steps = [level.step for level in result.levels[:-1]]
        drawn_values = []
        for number, figure in enumerate(result.figures_followed):
            drawn_values += _curve(axes, steps, figure, number)
        axes.set_xscale("log", base=2)
        axes.set_xticks(steps, [f"{step:.3g}" for step in steps])
        axes.minorticks_off()
        axes.set_xlabel("exchange step (s)")
        axes.set_ylabel("difference from the next finer step / size")
        if drawn_values:
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter(FuncFormatter(lambda share, _: f"{100.0 * share:g} %"))
            _slopes(axes, steps, max(drawn_values))
            wanted = f"accuracy {100.0 * result.accuracy:g} %"
            axes.axhline(result.accuracy, color=GREY, linewidth=0.7, label=wanted)
            handles, labels = axes.get_legend_handles_labels()
            picture.legend(handles, labels, loc="outside upper center", ncols=2)
    return picture


def _curve(axes: Axes, steps: list[float], figure: Figure, number: int) -> list[float]:
    """Draw a figure, and return what is drawn; differences of zero have no place in it."""
    scale = figure.scale or 1.0
    points = [
        (step, abs(difference) / scale)
        for step, difference in zip(steps, figure.differences)
        if difference
    ]
    if not points:
        return []
    axes.plot(
        *zip(*points),
        color=_COLOURS[number % len(_COLOURS)],
        marker=_MARKERS[(number + number // len(_COLOURS)) % len(_MARKERS)],
        markersize=4.0,
        linewidth=1.0,
        linestyle="-" if figure.found.order is not None else ":",
        label=f"{figure.name}: {_order(figure)}",
    )
    return [share for _, share in points]


def _order(figure: Figure) -> str:
    words = order_in_words(figure)
    return f"order {words}" if figure.found.order is not None else words


def _slopes(axes: Axes, steps: list[float], top: float) -> None:
    """Draw orders 1 and 2 from above the largest difference downwards."""
    for order, dashes in ((1, "--"), (2, "-.")):
        line = [1.5 * top * (step / steps[0]) ** order for step in steps]
        axes.plot(steps, line, dashes, color=GREY, linewidth=0.7, label=f"slope {order}")
