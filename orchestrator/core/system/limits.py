"""Limits of a run: refused is what would fill memory or disk hours later."""

import math
import shutil
from collections.abc import Mapping
from pathlib import Path

from ..errors import Problem
from .plan import Starts
from .system import SystemSpec
from .timing import Timing

MOST_VALUES = 100_000_000
"""Values in the time series of a run: at its end they are in memory at once (0.8 GB), and about
2 GB as text."""
MOST_STATES = 20_000
"""Serialized states that a run may record."""
MOST_INTERNAL_STEPS = 100_000
"""Internal steps that a component may make in one communication step: it cannot be interrupted
there, nor tell how far it is."""


def amount_problems(system: SystemSpec, timing: Timing, columns: int) -> list[Problem]:
    """Find out whether a run would record too much.

    Parameters
    ----------
    system : SystemSpec
        Says which states are recorded.
    timing : Timing
        Of the run.
    columns : int
        Columns of the time series.

    Returns
    -------
    list of Problem
    """
    problems = []
    rows = timing.exchanges // timing.output_every + 1
    values = rows * columns
    if values > MOST_VALUES:
        what = (
            f"{rows:,} rows of {columns:,} columns are {values:.2g} values "
            f"({8e-9 * values:.2g} GB), and at most {MOST_VALUES:.0e} can be kept"
        )
        interval = _longer(timing, MOST_VALUES // columns)
        remedy = f"{interval} or more will do; or shorten stop_time, or record less"
        problems.append(Problem("output_interval", what, remedy))
    framed = sum(spec.record_states for spec in system.components.values())
    states = (timing.exchanges // timing.state_every + 1) * framed
    if states > MOST_STATES:
        what = f"{states:,} states would be recorded, and at most {MOST_STATES:,} can be kept"
        interval = _longer(timing, MOST_STATES // framed)
        remedy = f"{interval} or more will do; or shorten stop_time"
        problems.append(Problem("state_interval", what, remedy))
    return problems


MUCH = 50_000_000
"""Size of results (bytes) from which on they are told before the run."""


_BYTES = 25
"""Bytes that a value takes as text and in the Parquet file."""


def amount_in_words(timing: Timing, columns: int, state: int, folder: Path) -> str:
    """Say how much a run will write, if that is much or more than the disk has room for.

    Parameters
    ----------
    timing : Timing
        Of the run.
    columns : int
        Columns of the time series.
    state : int
        Size (bytes) of the compressed states that are recorded together, as they are at the start.
    folder : Path
        Folder of the results.

    Returns
    -------
    str
        Empty if it is less than :data:`MUCH` and there is room.
    """
    rows = timing.exchanges // timing.output_every + 1
    frames = timing.exchanges // timing.state_every + 1 if state else 0
    size = _BYTES * rows * columns + frames * state
    free = shutil.disk_usage(folder).free
    if size < min(MUCH, free):
        return ""
    parts = [f"{rows:,} rows of {columns:,} columns"]
    if frames:
        parts.append(f"{frames:,} states of {state / 1e3:.3g} kB")
    room = f", and {_size(free)} are free there" if size >= free else ""
    return (
        f"the results will take {_size(size)} or more ({' and '.join(parts)}){room}; a longer "
        "output_interval or state_interval makes less"
    )


def _size(count: int) -> str:
    return f"{count / 1e9:.3g} GB" if count >= 1e9 else f"{count / 1e6:.3g} MB"


def internal_step_problems(system: SystemSpec, starts: Mapping[str, Starts]) -> list[Problem]:
    """Find components that would make too many internal steps at once.

    Parameters
    ----------
    system : SystemSpec
        Gives the communication steps.
    starts : mapping of str to Starts
        Values of ``internal_step`` are looked for among them.

    Returns
    -------
    list of Problem
    """
    asked = {name: system.longest_step(name) for name in starts}
    return [
        Problem(
            f"{name}.internal_step",
            f"steps of {value:g} s are {asked[name] / value:.2g} in each communication step "
            f"of {asked[name]:g} s, and at most {MOST_INTERNAL_STEPS:,} can be made",
            f"raise it to {asked[name] / MOST_INTERNAL_STEPS:g} s or more",
        )
        for name, values in starts.items()
        for port, value in values
        if port.name == "internal_step"
        and isinstance(value, float)
        and 0.0 < value * MOST_INTERNAL_STEPS < asked[name]
    ]


def _longer(timing: Timing, most: int) -> str:
    """Return the shortest interval that gives at most so many rows or states.

    It is 1, 2 or 5 times a power of ten exchanges.
    """
    least = timing.exchanges / max(1, most - 1)
    power = 10 ** math.floor(math.log10(max(1.0, least)))
    every = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= least)
    return f"{timing.lasts(every * timing.exchange):g} s"
