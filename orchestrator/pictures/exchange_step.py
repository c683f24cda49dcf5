"""The exchange step of an adaptive run over time."""

from pathlib import Path

from rockshed.components.common.units import ms

from ..core.results.reading import StoredRun
from .style import INK, WIDTH, figure, over_time, plain_powers

COLUMN = "coupling.step"
"""Column of the steps."""


def exchange_step(run: StoredRun, file: Path) -> None:
    """Draw the mean exchange step between two rows over time.

    Parameters
    ----------
    run : StoredRun
        Of an adaptive system.
    file : Path
        File of the picture.
    """
    time = run.time / ms
    steps = run.series[COLUMN] / ms
    with figure(run, file, WIDTH, 2.6) as made:
        axes = made.subplots()
        axes.stairs(steps[1:], time, color=INK, baseline=None)
        axes.set_yscale("log")
        plain_powers(axes.yaxis)
        axes.set_xlabel("time, ms")
        axes.set_ylabel("exchange step, ms")
        over_time(axes, time)
