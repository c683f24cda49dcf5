"""Static loading: load on a driven rock over its penetration, and what the curve tells."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rockshed.components.common.units import cm, mm

from .values import Samples

DEPTH = 4 * cm
"""Penetration (m) at which the load is read: Sonoda et al. 1993, sec. 2 (2) and fig. 13."""
WINDOW = 0.5 * mm
"""A load is the mean over so much penetration (m): discs that slip let it jump."""


@dataclass(frozen=True)
class LoadCurve:
    """Load (N) on the rock, upwards, at rising penetrations (m)."""

    depth: Samples
    load: Samples

    def reaches(self, depth: float) -> bool:
        """Whether the load at a penetration (m) can be told."""
        return self.depth.size > 1 and bool(
            self.depth[0] <= depth - 0.5 * WINDOW and depth + 0.5 * WINDOW <= self.depth[-1]
        )

    def at(self, depth: Samples | float) -> Samples:
        """Return the load at penetrations, as the mean over the :data:`WINDOW` around them.

        Parameters
        ----------
        depth : float or array of float
            In m.

        Returns
        -------
        array of float
            In N: work over the window / the way; at the ends over what there is.
        """
        parts = 0.5 * (self.load[1:] + self.load[:-1]) * np.diff(self.depth)
        work = np.concatenate(([0.0], np.cumsum(parts)))
        low = np.clip(np.asarray(depth) - 0.5 * WINDOW, self.depth[0], self.depth[-1])
        high = np.clip(np.asarray(depth) + 0.5 * WINDOW, self.depth[0], self.depth[-1])
        return (np.interp(high, self.depth, work) - np.interp(low, self.depth, work)) / (high - low)

    def departure(self, depth: float) -> float:
        """Return how far the load is from the secant line.

        Parameters
        ----------
        depth : float
            End of the line (m).

        Returns
        -------
        float
            Root mean square over the penetration / largest load; infinite where the sand carries
            nothing.
        """
        places = np.linspace(0.0, depth, round(depth / WINDOW) + 1)[1:]
        loads, end = self.at(places), float(self.at(depth))
        largest = float(loads.max())
        return (
            float(np.sqrt(np.mean((loads - end * places / depth) ** 2))) / largest
            if largest > 0.0
            else np.inf
        )


def load_curve(series: Mapping[str, Samples], sand: str) -> LoadCurve | None:
    """Return the load curve of a sand cushion from the columns of a run.

    Parameters
    ----------
    series : mapping of str to array of float, shape (rows,)
        Columns of the run.
    sand : str
        Name of the sand cushion in the system.

    Returns
    -------
    LoadCurve or None
        None if the results have no such columns.
    """
    depth, load = series.get(f"{sand}.penetration"), series.get(f"{sand}.rock.force.y")
    return None if depth is None or load is None else driven_curve(depth, load)


def driven_curve(depth: Samples, load: Samples) -> LoadCurve:
    """Return the load curve of a driven body from the rows in which it sinks.

    Parameters
    ----------
    depth : array of float, shape (rows,)
        Penetration (m).
    load : array of float, shape (rows,)
        Load on the body (N), upwards.
    """
    sinking = np.concatenate(([True], depth[1:] > np.maximum.accumulate(depth)[:-1]))
    return LoadCurve(depth[sinking], load[sinking])
