"""Pressure of a cushion on the structure below it, in space and time, and how far it spreads."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.roles import Role

from ..core.results.metric import Metric
from ..core.results.reading import StoredRun
from . import names
from .cushion import cushions, cut_off, thickness_at_start
from .energy import driven
from .filtering import low_pass
from .roles import all_samples, column, owners, positive
from .values import Samples, of_each

HALF, MOST = 0.5, 0.9
"""Parts of the load whose distance from its centre is told."""


@dataclass(frozen=True)
class RoofPressure:
    """Pressure along a structure.

    Attributes
    ----------
    places : array of float, shape (elements,)
        Middles of the elements (m).
    values : array of float, shape (elements, rows)
        Mean pressure on an element, downwards (Pa).
    length : float
        Of an element (m).
    turning : int
        Row in which the striking body is deepest: what comes later is the motion of the structure.
    """

    places: Samples
    values: NDArray[np.float64]
    length: float
    turning: int

    @property
    def added(self) -> NDArray[np.float64]:
        """Pressure beyond that at the start, of the cushion at rest (Pa)."""
        return self.values - self.values[:, :1]

    def row_of_most_load(self) -> int:
        """Return the row in which the added load is largest, until the body turns."""
        return int(self.added[:, : self.turning + 1].sum(axis=0).argmax())

    def within(self, part: float) -> float:
        """Return the distance from the load's centre within which a part of it lies (m).

        Parameters
        ----------
        part : float
            Of the added load in the row in which it is largest.
        """
        load = np.clip(self.added[:, self.row_of_most_load()], 0.0, None) * self.length
        centre = float(load @ self.places / load.sum())
        edges = np.concatenate((self.places - 0.5 * self.length, self.places[-1:]))
        edges[-1] += 0.5 * self.length
        below = np.concatenate(([0.0], np.cumsum(load))) / load.sum()
        distances = np.linspace(0.0, float(edges[-1] - edges[0]), 2001)
        share = np.interp(centre + distances, edges, below) - np.interp(
            centre - distances, edges, below
        )
        return float(np.interp(part, share, distances))


def roof_pressure(run: StoredRun, cushion: str) -> RoofPressure | None:
    """Return the pressure of a cushion on the elements of the structure below it.

    Contact force on an element / (its length x effective width of the cushion); without what is
    faster than the cut-off of the settled forces, where the rows can tell that.

    Parameters
    ----------
    run : StoredRun
        The run.
    cushion : str
        Name of the component in the system.

    Returns
    -------
    RoofPressure or None
        None without a structure, or where its forces were not recorded.
    """
    width = positive(run, cushion, Role.EFFECTIVE_WIDTH)
    below = owners(run, Role.ALONG)
    if not width or len(below) != 1:
        return None
    places = all_samples(run, below[0], Role.ALONG)
    forces = all_samples(run, cushion, Role.ON_STRUCTURE)
    if places.size == 0 or forces.shape != places.shape or len(places) < 2:
        return None
    length = float(places[1, 0] - places[0, 0])
    fastest = cut_off(run, cushion)
    shown = [_slow(run.series["time"], force, fastest) for force in -forces]
    depth = column(run, cushion, Role.PENETRATION)
    turning = len(forces[0]) - 1 if depth is None else int(run.series[depth].argmax())
    return RoofPressure(places[:, 0], np.array(shown) / (length * width), length, turning)


def _slow(time: Samples, force: Samples, fastest: float | None) -> Samples:
    curve = None if fastest is None else low_pass(time, force, fastest)
    return force if curve is None else curve


def of_pressures(run: StoredRun) -> Iterator[Metric]:
    """Yield the peak pressure under each cushion, its moment and place, and the load's spread.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return iter(()) if driven(run) else of_each(run, cushions(run), _of_cushion)


def _of_cushion(run: StoredRun, cushion: str) -> Iterator[Metric]:
    found = roof_pressure(run, cushion)
    if found is None or not np.any(found.added[:, found.row_of_most_load()] > 0.0):
        return
    element, row = np.unravel_index(int(found.values.argmax()), found.values.shape)
    yield Metric(names.PEAK_PRESSURE, float(found.values[element, row]), "Pa")
    yield Metric(names.PEAK_PRESSURE_AT, float(run.series["time"][row]), "s")
    yield Metric(names.PEAK_PRESSURE_PLACE, float(found.places[element]), "m")
    half, most = found.within(HALF), found.within(MOST)
    yield Metric(names.LOAD_HALF, half, "m")
    yield Metric(names.LOAD_MOST, most, "m")
    thickness, radius = thickness_at_start(run, cushion), striking_radius(run)
    if thickness and radius:
        yield Metric(names.SPREAD_ANGLE, math.atan((most - radius) / thickness), "rad")


def striking_radius(run: StoredRun) -> float | None:
    """Return the radius of the body that strikes (m); None where there is not one alone.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    bodies = owners(run, Role.STRIKING)
    return positive(run, bodies[0], Role.BODY_RADIUS) if len(bodies) == 1 else None
