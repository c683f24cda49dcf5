"""The exchange step of an adaptive run over time."""

from pathlib import Path

from rockshed.components.common.units import ms

from ..core.results.reading import StoredRun
from .style import INK, WIDTH, figure, over_time

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
        axes.set_yscale("log", base=2)
        ticks = _ticks(run)
        axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
        axes.set_ylim(0.8 * ticks[0], 1.25 * max(ticks[-1], steps.max()))
        axes.set_xlabel("time (ms)")
        axes.set_ylabel("exchange step (ms)")
        over_time(axes, time)


def _ticks(run: StoredRun) -> list[float]:
    """Return steps (ms) from the smallest to the longest one, eight at most."""
    system = run.provenance["system"]
    smallest = float(system["exchange_step"]) / ms
    levels = round(float(system["adaptive"]["largest_step"]) / ms / smallest).bit_length()
    return [smallest * 2**level for level in range(0, levels, 1 + (levels - 1) // 8)]
