"""Tables of a convergence study of exchange steps for a person."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...tables import Table, digits
from ..study.headline import on_screen
from .figures import Figure, Level

if TYPE_CHECKING:
    from .result import ExchangeStepsResult


def level_table(levels: Sequence[Level]) -> Table:
    """Return the runs: exchanges, and the energy that system and couplings have made.

    Parameters
    ----------
    levels : sequence of Level
        From coarse to fine.
    """
    headings = ("step (s)", "exchanges", "residual (J)", "by couplings (J)", "run (s)")
    table = Table(headings, right=headings, title="runs, and the energy that they make")
    for level in levels:
        energies = (_number(level.residual), _number(level.coupling))
        table.add(f"{level.step:.6g}", f"{level.exchanges:,}", *energies, digits(level.wall_time))
    return table


def order_table(result: "ExchangeStepsResult") -> Table:
    """Return order, limit, error of the finest step and the step that will do, of each figure.

    Parameters
    ----------
    result : ExchangeStepsResult
        The study.
    """
    last = f"step for {100.0 * result.accuracy:g} %"
    headings = ("figure", "finest", "limit", "order", "error", last)
    table = Table(headings, right=headings[1:], title="order of convergence")
    for figure in result.figures_followed:
        unit, scale = on_screen(figure.unit)
        finest = digits(figure.values[-1] / scale, 4) if figure.values else ""
        limit = digits(figure.limit / scale, 4) if figure.limit is not None else ""
        step = result.step_for(figure)
        cells = (order_in_words(figure), _percent(figure.share(-1)))
        told = f"{step:.6g}" if step is not None else ""
        table.add(_titled(figure, unit), finest, limit, *cells, told)
    return table


def step_table(result: "ExchangeStepsResult") -> Table:
    """Return the value of each figure at each step, the difference to the next, and the error.

    Parameters
    ----------
    result : ExchangeStepsResult
        The study.
    """
    headings = ("figure", "step (s)", "value", "difference", "order", "error")
    table = Table(headings, right=headings[1:], title="from step to step")
    for figure in result.figures_followed:
        unit, scale = on_screen(figure.unit)
        for place, level in enumerate(result.levels):
            table.add(
                _titled(figure, unit) if place == 0 else "",
                f"{level.step:.6g}",
                digits(figure.values[place] / scale, 5) if figure.values else "",
                _entry(figure.differences, place, scale, 3),
                _entry(figure.found.orders, place, 1.0, 3),
                _percent(figure.share(place)),
            )
    return table


def order_in_words(figure: Figure) -> str:
    """Return the order of a figure, or that there is none.

    Parameters
    ----------
    figure : Figure
        That was followed.
    """
    if figure.found.order is not None:
        return f"{figure.found.order:.2f}"
    return "any step" if figure.found.is_known else "no order"


def _titled(figure: Figure, unit: str) -> str:
    return f"{figure.name} ({unit})" if unit else figure.name


def _entry(values: Sequence[float], place: int, scale: float, number: int) -> str:
    if place >= len(values) or values[place] != values[place]:
        return ""
    return digits(values[place] / scale, number)


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100.0 * share:+.2g} %"


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"
