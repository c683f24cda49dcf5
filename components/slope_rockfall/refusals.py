"""Refusals of the initialisation: profiles, materials and starts that the model cannot answer."""

import math
from typing import TYPE_CHECKING

from ..common.kernels import kernel, view
from .declarations import LAYOUT, LOGNORMAL
from .faults import (
    FOLDED,
    LIMIT_SIGN,
    LOCKED,
    RECEIVER_EMPTY,
    ROUGH,
    ROUGHNESS_SIGN,
    RULES,
    STEEP,
    TILT_SIGN,
)
from .geometry import node
from .sampling import widest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..common.component import Instance

V, A = LAYOUT.scalar, LAYOUT.array

_STEEPEST = math.tan(math.radians(0.1))
_ROUGHEST = 1.999


@kernel
def widest_roughness(c, w, k):
    """Return the largest R_o of cell c.

    Parameters
    ----------
    c : int
        Number of the cell, from 0.
    w, k : ndarray
        Variables and integers of the instance.

    Returns
    -------
    float
        R_o, without unit.
    """
    return widest(
        w[V.roughness_distribution],
        view(w, k, A.roughness)[c],
        view(w, k, A.roughness_deviation)[c],
        w[V.truncation],
    )


@kernel
def locking(c, w, k):
    """Return mu tan(phi) of cell c with its largest roughness.

    Parameters
    ----------
    c : int
        Number of the cell, from 0.
    w, k : ndarray
        Variables and integers of the instance.

    Returns
    -------
    float
        Without unit; 1 or more where the contact locks itself.
    """
    rough = min(max(widest_roughness(c, w, k), 0.0), _ROUGHEST)
    return view(w, k, A.friction)[c] * math.sqrt(rough / (2.0 - rough))


@kernel
def has_fault(fault, c, w, k):
    """Tell whether cell c has the fault of this number.

    Parameters
    ----------
    fault : int
        Number of the fault.
    c : int
        Number of the cell, from 0.
    w, k : ndarray
        Variables and integers of the instance.

    Returns
    -------
    bool
    """
    x0, y0 = node(c, w, k)
    x1, y1 = node(c + 1, w, k)
    if fault == FOLDED:
        return x1 <= x0
    if fault == STEEP:
        return 0.0 < x1 - x0 < _STEEPEST * abs(y1 - y0)
    if fault == ROUGHNESS_SIGN:
        return w[V.roughness_distribution] == LOGNORMAL and view(w, k, A.roughness)[c] <= 0.0
    if fault == TILT_SIGN:
        return w[V.tilt_distribution] == LOGNORMAL and view(w, k, A.tilt)[c] <= 0.0
    if fault == ROUGH:
        return widest_roughness(c, w, k) > _ROUGHEST
    return widest_roughness(c, w, k) <= _ROUGHEST and locking(c, w, k) >= 1.0


@kernel
def tell_fault(fault, c, w, k):
    """Publish what the message of this fault of cell c needs; c = -1 stands for no cell.

    Parameters
    ----------
    fault : int
        Number of the fault.
    c : int
        Number of the cell, from 0.
    w, k : ndarray
        Variables and integers of the instance.
    """
    w[V.fault_cell] = c + 1.0
    w[V.fault_value], w[V.fault_roughness], w[V.fault_locking] = 0.0, 0.0, 0.0
    if c < 0:
        return
    w[V.fault_roughness], w[V.fault_locking] = widest_roughness(c, w, k), locking(c, w, k)
    if fault in (FOLDED, STEEP):
        w[V.fault_value] = view(w, k, A.end_x)[c]
    elif fault == TILT_SIGN:
        w[V.fault_value] = view(w, k, A.tilt)[c]
    elif fault == LOCKED:
        w[V.fault_value] = view(w, k, A.friction)[c]
    else:
        w[V.fault_value] = view(w, k, A.roughness)[c]


@kernel
def common_fault(w):
    """Return the fault of the parameters that belong to no cell, or 0.

    Parameters
    ----------
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    int
    """
    if w[V.limit_speed_distribution] == LOGNORMAL and w[V.limit_speed_mean] <= 0.0:
        return LIMIT_SIGN
    empty = w[V.receiver_left] >= w[V.receiver_right] or w[V.receiver_bottom] >= w[V.receiver_top]
    return RECEIVER_EMPTY if w[V.receiver_present] != 0.0 and empty else 0


@kernel
def first_fault(w, k):
    """Return the number of the first fault, or 0; the outputs fault.* describe its cell.

    Parameters
    ----------
    w, k : ndarray
        Variables and integers of the instance.

    Returns
    -------
    int
    """
    tell_fault(0, -1, w, k)
    for c in range(k[A.end_x + 1]):
        for fault in range(FOLDED, LIMIT_SIGN):
            if has_fault(fault, c, w, k):
                tell_fault(fault, c, w, k)
                return fault
    return common_fault(w)


def cell_problems(instance: "Instance") -> "Iterator[tuple[int, int, str]]":
    """Yield every fault of every cell.

    Parameters
    ----------
    instance : Instance
        With the parameters set.

    Yields
    ------
    tuple of int, int and str
        Number of the cell, from 0, the fault, and the message in words.
    """
    w, k = instance.w, instance.k
    for c in range(instance.sizes["cells"]):
        for fault in RULES:
            if has_fault(fault, c, w, k):
                tell_fault(fault, c, w, k)
                yield c, fault, instance.message(fault)
    tell_fault(0, -1, w, k)


def problems(instance: "Instance") -> list[str]:
    """Return every fault of every cell, and those of the other parameters.

    Parameters
    ----------
    instance : Instance
        With the parameters set.

    Returns
    -------
    list of str
        The faults in words.
    """
    found = [text for _, _, text in cell_problems(instance)]
    if common := common_fault(instance.w):
        found.append(instance.message(common))
    return found
