"""Arrays along a component, as it declares them by an envelope: places and values."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.roles import Role

from ..core.results.reading import StoredRun
from .roles import elements, members_of


@dataclass(frozen=True)
class Peak:
    """The value of an array that is farthest from zero.

    Attributes
    ----------
    value : float
        With its sign, in the unit of the array.
    time : float
        In s.
    place : float
        In m, at the start of the run.
    """

    value: float
    time: float
    place: float


def along(
    run: StoredRun, component: str, told: Mapping[str, Any]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places and values of an array along a component, ends included.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    told : mapping
        The envelope as it is declared.

    Returns
    -------
    places : array of float, shape (n,)
        In m, at the start of the run.
    values : array of float, shape (n, rows)
        In the unit of the array.
    """
    places = np.array([at[0] for at in elements(run, f"{component}.{told['along']}")])
    values = np.array(elements(run, f"{component}.{told['variable']}"))
    ends = elements(run, f"{component}.{told['ends']}") if told["ends"] else []
    if not ends or places.size < 2:
        return places, values
    half = 0.5 * (places[1] - places[0])
    if told.get("at_edges"):
        return np.append(places - half, places[-1] + half), np.vstack([values, ends[1]])
    wider = np.concatenate([places[:1] - half, places, places[-1:] + half])
    return wider, np.vstack([ends[0], values, ends[1]])


def peak(run: StoredRun, component: str, role: Role) -> Peak | None:
    """Return the value that is farthest from zero in the arrays of a role that have an envelope.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    role : Role
        The role of the array.

    Returns
    -------
    Peak or None
        Over the rows; None where no such array was recorded with its places.
    """
    found = [
        Peak(float(values[place, row]), float(run.series["time"][row]), float(places[place]))
        for told in _envelopes(run, component, role)
        for places, values in [along(run, component, told)]
        if values.size and len(places) == len(values)
        for place, row in [np.unravel_index(np.abs(values).argmax(), values.shape)]
    ]
    return max(found, key=lambda peak: abs(peak.value), default=None)


def _envelopes(run: StoredRun, component: str, role: Role) -> Iterator[Mapping[str, Any]]:
    """Yield the envelopes that a component declares of arrays with a role."""
    named = {member.variable for member in members_of(run, component, role)}
    for picture in run.provenance["components"][component].get("pictures", ()):
        for panel in picture["panels"]:
            if "along" in panel and panel["variable"] in named:
                yield panel
