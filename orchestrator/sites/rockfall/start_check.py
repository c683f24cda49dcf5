"""Rocks that would start inside the slope."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.records import ROCK

from ...core.errors import Problem
from ...input_files.places import Places
from .profile import Node
from .rocks import RockSampler
from .site import SlopeSite

PROBED = 10_000
"""Trials, from the first on, whose starts are looked at before any is computed."""
_ROUNDING = 1e-6
"""Depth (m) that is rounding."""

_Floats = NDArray[np.float64]


def start_faults(
    rocks: RockSampler, nodes: Sequence[Node], site: SlopeSite, where: Places
) -> Iterator[Problem]:
    """Yield a problem if rocks that start in the air would begin inside the slope.

    Parameters
    ----------
    rocks : RockSampler
        Of the site.
    nodes : sequence of Node
        Of the profile.
    site : SlopeSite
        With the number of trials.
    where : Places
        Of the values of the site.

    Yields
    ------
    Problem
        With the share of such rocks among the first ones.
    """
    if site.start.y is None and site.start.line is None:
        return
    sample = rocks.sample(0, min(site.trials, PROBED))
    depth = sample[:, ROCK.radius] - distance(nodes, sample[:, ROCK.x], sample[:, ROCK.y])
    below = int((depth > _ROUNDING).sum())
    if below:
        text = (
            f"{below} of the first {len(sample)} rocks would start inside the slope, up to "
            f"{depth.max():.3g} m deep"
        )
        remedy = "start higher, or leave y out for rocks that start on the slope"
        yield Problem(where.of(("start",)), text, remedy)


def distance(nodes: Sequence[Node], x: _Floats, y: _Floats) -> _Floats:
    """Return the distance of points from a profile.

    Parameters
    ----------
    nodes : sequence of Node
        From left to right.
    x, y : array of float, shape (n,)
        The points (m).

    Returns
    -------
    array of float, shape (n,)
        Distance (m), negative below the profile.
    """
    least = np.full(len(x), np.inf)
    for node, after in pairwise(nodes):
        dx, dy = after.x - node.x, after.y - node.y
        along = ((x - node.x) * dx + (y - node.y) * dy) / (dx * dx + dy * dy)
        part = np.clip(along, 0.0, 1.0)
        away = np.hypot(x - node.x - part * dx, y - node.y - part * dy)
        least = np.minimum(least, away)
    above = y >= np.interp(x, [node.x for node in nodes], [node.y for node in nodes])
    return np.where(above, least, -least)
