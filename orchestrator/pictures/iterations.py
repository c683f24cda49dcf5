"""Iterations of the implicit master over time, and how values came to fit together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from rockshed.components.common.units import ms

from ..core.results.facts import table_of, tables_of
from ..core.results.reading import StoredRun, undamaged
from .style import (
    COLOURS,
    FAINT,
    INK,
    WIDTH,
    figure,
    legend,
    literal,
    over_time,
    plain_powers,
    reference_line,
)

_COLUMN = "coupling.iterations"
_HEIGHT = 2.3
"""Height of a panel (inch)."""
_PART = 6
"""Exchanges in a panel of residuals, at most."""
_SMALLEST = 1e-6
"""Residual / tolerance at the lower edge, at least; smaller ones are drawn there."""
_LARGEST = 1e30
"""Half the same at the upper edge, at most."""


@dataclass(frozen=True)
class _Window:
    """Exchanges that were iterated together.

    Attributes
    ----------
    time : float
        At which they begin (ms).
    residuals : array of float
        As multiples of tolerances, a row for each iteration, a column for each connection.
    """

    time: float
    residuals: NDArray[np.float64]


def iterations(run: StoredRun, file: Path) -> None:
    """Draw iterations over time, and the residuals of the exchanges that were kept in full.

    Parameters
    ----------
    run : StoredRun
        Of a system with the implicit master, of several rows or with such exchanges.
    file : Path
        File of the picture.

    Raises
    ------
    InputRefused
        The residuals of the run are damaged.
    """
    told = table_of(run.provenance, "iteration")
    with undamaged(run.folder / "run.json"):
        names = [str(connection["source"]) for connection in tables_of(told, "connections")]
        windows = [_window(entry, len(names)) for entry in tables_of(told, "windows")]
    parts = _parts(windows, "exchanges" if told.get("window", 1) == 1 else "windows")
    several_rows = len(run.time) > 1
    rows = several_rows + len(parts)
    with figure(run, file, WIDTH, 0.3 + _HEIGHT * rows) as made:
        panels = [*np.atleast_1d(made.subplots(rows))]
        if several_rows:
            _over_time(panels[0], run)
        if parts:
            _histories(panels[several_rows:], parts, names)


def _window(told: Mapping[str, Any], connections: int) -> _Window:
    """Return a window as ``run.json`` has it."""
    residuals = np.array(told["residuals"], float).reshape(-1, connections)
    if not residuals.size or np.any(residuals < 0.0):
        raise ValueError("residuals of an iteration are missing or negative")
    return _Window(float(told["time"]) / ms, np.nan_to_num(residuals, nan=np.inf))


def _parts(windows: Sequence[_Window], which: str) -> dict[str, Sequence[_Window]]:
    """Return those with the most iterations and the last ones by a title; once if they are all."""
    if not windows:
        return {}
    if len(windows) <= _PART:
        return {f"all {which}": windows}
    most = sorted(windows, key=lambda window: len(window.residuals))[-_PART:]
    return {f"the {which} with the most iterations": most, f"the last {which}": windows[-_PART:]}


def _over_time(axes: Axes, run: StoredRun) -> None:
    """Draw the most iterations of an exchange between two rows."""
    time = run.time / ms
    counts = run.series[_COLUMN][1:]
    axes.stairs(counts, time, color=INK, baseline=None)
    axes.set_ylim(0.0, 1.1 * max(1.0, counts.max()))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("time (ms)")
    axes.set_ylabel("iterations")
    over_time(axes, time)


def _histories(
    panels: Sequence[Axes], parts: Mapping[str, Sequence[_Window]], names: Sequence[str]
) -> None:
    """Draw residuals over iterations, a panel for each part of the exchanges, on equal axes."""
    drawn = [window.residuals for part in parts.values() for window in part]
    every = np.concatenate(drawn)
    named = _named(every)
    lower = max(_SMALLEST, 0.5 * min(1.0, every[every > 0.0].min(initial=1.0)))
    upper = 2.0 * max(1.0, min(every.max(), _LARGEST))
    for axes, (title, part) in zip(panels, parts.items(), strict=True):
        for window in part:
            _history(axes, np.clip(window.residuals, lower, upper), named)
        reference_line(axes, 1.0, "tolerance")
        axes.set_title(f"{title}: {_times(part)}")
        axes.set_yscale("log")
        axes.set_ylim(lower, upper)
        plain_powers(axes.yaxis)
        axes.set_xlim(0.5, 0.5 + max(map(len, drawn)))
        axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
        axes.set_xlabel("iteration")
        axes.set_ylabel("residual / tolerance")
    _name(panels[0], names, named)


def _named(every: NDArray[np.float64]) -> list[int]:
    """Return the connections that get a colour: those that were the farthest away most often."""
    often = np.bincount(every.argmax(axis=1), minlength=every.shape[1])
    order = np.lexsort((-every.max(axis=0), -often))
    return sorted(order[: len(COLOURS)].tolist())


def _history(axes: Axes, residuals: NDArray[np.float64], named: Sequence[int]) -> None:
    """Draw the residuals of an exchange; connections without a colour lie behind."""
    numbers = np.arange(1, len(residuals) + 1)
    others = [column for column in range(residuals.shape[1]) if column not in named]
    style: dict[str, Any] = {"marker": "o", "markersize": 2.5, "linewidth": 0.8}
    axes.plot(numbers, residuals[:, others], color=FAINT, **style)
    for column, colour in zip(named, COLOURS):
        axes.plot(numbers, residuals[:, column], color=colour, **style)


def _times(part: Sequence[_Window]) -> str:
    """Return how many there are, and from when to when they begin."""
    times = [window.time for window in part]
    first, last = f"{min(times):.6g}", f"{max(times):.6g}"
    return f"{len(times)}, from {first} to {last} ms" if len(times) > 1 else f"at {first} ms"


def _name(axes: Axes, names: Sequence[str], named: Sequence[int]) -> None:
    """Name the connections by their sources, and the tolerance, in the legend."""
    lines = [axes.plot([], [], color=c, label=literal(names[i]))[0] for i, c in zip(named, COLOURS)]
    if more := len(names) - len(named):
        lines += axes.plot([], [], color=FAINT, label=f"{more} more")
    tolerance = [line for line in axes.get_lines() if line.get_label() == "tolerance"]
    legend(axes, [*lines, *tolerance])
