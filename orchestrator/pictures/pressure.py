"""Pressure on the roof: a map of place over time, and the envelope along the roof."""

from pathlib import Path

from matplotlib.axes import Axes

from rockshed.components.common.units import ms

from ..core.results.reading import StoredRun
from ..metrics.pressure import MOST, RoofPressure, roof_pressure
from ..metrics.values import Samples
from ..tables import digits
from .style import GREY, ROCK, TRANSMITTED, WIDTH, figure, legend, over_time

_KPA = 1e3


def pressure(run: StoredRun, cushion: str, file: Path) -> None:
    """Draw the pressure of a cushion on the structure over place and time.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.
    file : Path
        File of the picture.
    """
    found = roof_pressure(run, cushion)
    assert found is not None
    with figure(run, file, WIDTH, 5.4) as made:
        above, below = made.subplots(2, 1, height_ratios=(3, 2))
        time = run.series["time"] / ms
        edges = (found.places[0] - 0.5 * found.length, found.places[-1] + 0.5 * found.length)
        shown = above.pcolormesh(
            time, found.places, found.values / _KPA, cmap="cividis", shading="nearest"
        )
        made.colorbar(shown, ax=above, label="pressure (kPa)")
        above.set(xlabel="time (ms)", ylabel="x (m)", ylim=edges)
        above.grid(False)
        over_time(above, time)
        _envelope(found, below, time)
        below.set(xlabel="x (m)", ylabel="pressure (kPa)", xlim=edges)


def _envelope(found: RoofPressure, axes: Axes, time: Samples) -> None:
    """Draw largest pressures, those under the largest load, and where 90 % of it lie."""
    row = found.row_of_most_load()
    axes.plot(found.places, found.values.max(axis=1) / _KPA, color=TRANSMITTED, label="largest")
    instant = f"under the largest load of the impact, at {digits(time[row])} ms"
    axes.plot(found.places, found.values[:, row] / _KPA, ".-", color=ROCK, label=instant)
    rest = found.values[:, 0] / _KPA
    axes.plot(found.places, rest, color=GREY, linewidth=0.9, label="at rest")
    load = found.added[:, row].clip(min=0.0)
    if load.any():
        centre = float(load @ found.places / load.sum())
        reach = found.within(MOST)
        words = f"{100 * MOST:.0f} % of it within {digits(reach)} m of its centre"
        ends = (centre - reach, centre + reach)
        axes.axvspan(*ends, color=ROCK, alpha=0.08, linewidth=0, label=words)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]), top=1.05 * axes.get_ylim()[1])
    legend(axes)
