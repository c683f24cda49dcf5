"""Shape of the forces on both sides of a cushion: rise, and what the impulse says of the pulse."""

from collections.abc import Iterator

import numpy as np

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .cushion import CONTACT_SHARE, both_forces, cushions, settled
from .energy import driven
from .values import Samples, of_each

_FROM, _TO = 0.1, 0.9
"""Parts of the peak between which the rise is counted."""


def of_pulses(run: StoredRun) -> Iterator[Metric]:
    """Yield rise times and the shape factor of an impact on each cushion.

    They are those of the settled forces where the rows can tell these, so that single grains do not
    make the rise.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return iter(()) if driven(run) else of_each(run, cushions(run), _of_cushion)


def _of_cushion(run: StoredRun, cushion: str) -> Iterator[Metric]:
    columns = both_forces(run, cushion)
    if columns is None:
        return
    transmitted, on_body = (_shown(run, cushion, name) for name in columns)
    time = run.series["time"]
    for name, force in (
        (names.RISE_ROCK, on_body),
        (names.RISE_TRANSMITTED, transmitted - transmitted[0]),
    ):
        rise = rise_time(time, force)
        if rise is not None:
            yield Metric(name, rise, "s")
    shape = shape_factor(time, on_body)
    if shape is not None:
        yield Metric(names.SHAPE, shape)


def _shown(run: StoredRun, cushion: str, name: str) -> Samples:
    """Return the settled force, or the force as it is where the rows cannot tell it."""
    curve = settled(run, cushion, name)
    return run.series[name] if curve is None else curve


def rise_time(time: Samples, force: Samples) -> float | None:
    """Return how long a force takes from a tenth to nine tenths of its peak.

    Parameters
    ----------
    time, force : array of float, shape (rows,)
        In s and N.

    Returns
    -------
    float or None
        In s, between the rows by straight lines; None of a force that does not rise.
    """
    top = int(force.argmax())
    peak = float(force[top])
    if peak <= 0.0 or top == 0:
        return None
    moments = [_reached(time, force[: top + 1], share * peak) for share in (_FROM, _TO)]
    return moments[1] - moments[0]


def _reached(time: Samples, force: Samples, level: float) -> float:
    """Return the first time (s) at which a force has a level that its last value exceeds."""
    row = int(np.argmax(force >= level))
    if row == 0:
        return float(time[0])
    rise = float(force[row] - force[row - 1])
    return float(time[row] - (force[row] - level) / rise * (time[row] - time[row - 1]))


def shape_factor(time: Samples, force: Samples) -> float | None:
    """Return impulse / (peak x duration) of a pulse.

    A rectangle has 1, a half sine 2/pi = 0.64, a triangle 0.5; a peak on a long tail less.

    Parameters
    ----------
    time, force : array of float, shape (rows,)
        In s and N.

    Returns
    -------
    float or None
        None of a force that does not last. The duration is that of a hundredth of the peak.
    """
    peak = float(force.max())
    touching = np.flatnonzero(force > CONTACT_SHARE * peak) if peak > 0.0 else np.array([], int)
    if touching.size < 2:
        return None
    within = slice(int(touching[0]), int(touching[-1]) + 1)
    duration = float(time[within][-1] - time[within][0])
    if peak * duration == 0.0:  # too small for a number, in rows that are damaged
        return None
    return float(np.trapezoid(force[within], time[within])) / (peak * duration)
