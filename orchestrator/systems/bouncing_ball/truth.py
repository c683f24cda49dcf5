"""A ball on a table that shakes: parabolas between impacts, which are roots of one equation."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from rockshed.components.common.units import standard_gravity

from ..system import NumberArray

HEIGHT, RESTITUTION = 0.5, 0.8
"""Height of fall (m); velocity away after an impact over that towards the table before."""
AMPLITUDE, RATE = 0.01, 12.0
"""Of the table (m, rad/s)."""
_LOOK = 1e-4
"""Times (s) at which the sign of the distance is looked at."""


class Flight(NamedTuple):
    """A parabola between two impacts: start and end (s), height (m) and velocity (m/s) first."""

    start: float
    end: float
    height: float
    velocity: float

    def at(self, time: NumberArray) -> NumberArray:
        """Return the height of the ball (m)."""
        since = time - self.start
        fallen: NumberArray = self.height + (self.velocity - 0.5 * standard_gravity * since) * since
        return fallen

    def above(self, time: NumberArray) -> NumberArray:
        """Return the height of the ball above the table (m)."""
        distance: NumberArray = self.at(time) - AMPLITUDE * np.sin(RATE * time)
        return distance


def ball_height(times: NumberArray) -> NumberArray:
    """Return the height of the ball (m)."""
    heights = np.empty_like(times)
    for flight in flights(float(times.max(initial=0.0))):
        inside = (times >= flight.start) & (times <= flight.end)
        heights[inside] = flight.at(times[inside])
    return heights


def impacts(last: float) -> list[float]:
    """Return the times of all impacts until a time (s)."""
    return [flight.end for flight in flights(last) if flight.end < last]


def flights(last: float) -> Iterator[Flight]:
    """Yield all flights that begin until a time (s)."""
    start, height, velocity = 0.0, HEIGHT, 0.0
    while start <= last:
        end = _impact(Flight(start, last, height, velocity))
        yield Flight(start, end, height, velocity)
        if end > last:
            return
        table = AMPLITUDE * RATE * np.cos(RATE * end)
        down = velocity - standard_gravity * (end - start)
        height, velocity = AMPLITUDE * np.sin(RATE * end), table + RESTITUTION * (table - down)
        start = end


def _impact(flight: Flight) -> float:
    """Return the time (s) of the impact that ends a flight; infinity if it lasts until its end."""
    count = int((flight.end - flight.start) / _LOOK) + 2
    looks: NumberArray = flight.start + _LOOK * np.arange(1, count + 1, dtype=np.float64)
    below = np.flatnonzero(flight.above(looks) < 0.0)
    if not below.size:
        return math.inf
    time = float(looks[below[0]])
    ends = time - _LOOK, time
    return float(brentq(lambda at: float(flight.above(np.asarray(at))), *ends, xtol=1e-15))
