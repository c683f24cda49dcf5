"""Order of convergence from values at steps h, h/2, h/4, ..., and what follows from it.

An error C h^p makes successive differences d_k = v_k - v_(k+1) fall by 2^p, so that
p = log2(d_k / d_(k+1)), and the limit lies d / (2^p - 1) beyond the finest value, with the last
difference d: L. F. Richardson and J. A. Gaunt, The deferred approach to the limit, Phil. Trans. R.
Soc. A 226 (1927) 299-361 (as cited in the literature; the formulas follow from the first sentence).
Three steps give one order; four give two, which have to agree before either is believed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

LEAST_ORDER, MOST_ORDER = 0.3, 6.0
"""Orders that are believed: below, the limit is too far away to be told; above, no coupling is."""
SETTLED = 0.5
"""Difference of the last two orders up to which they count as the same."""
ROUNDING = 1e-12
"""Part of the size of a figure up to which two values count as equal."""
FEWEST = 3
"""Steps from which an order can be told."""
_MOST_HALVINGS = 20
"""Halvings of the finest step beyond which none is recommended."""


@dataclass(frozen=True)
class Convergence:
    """Order and errors that the differences of a figure from step to step show.

    Attributes
    ----------
    order : float or None
        None where there is none.
    reason : str
        Why there is none; empty where there is one, or where nothing depends on the step.
    errors : tuple of float
        Estimated value less limit at each step, from the coarsest on; empty without an order. All
        zero where nothing depends on the step.
    orders : tuple of float
        Of each three successive steps; NaN where the differences have none.
    scatters : bool
        Whether there is no order because the last differences change their sign.
    """

    order: float | None
    reason: str = ""
    errors: tuple[float, ...] = ()
    orders: tuple[float, ...] = ()
    scatters: bool = False

    @property
    def is_known(self) -> bool:
        """Whether the errors are known."""
        return bool(self.errors)


def converged(differences: Sequence[float], scale: float) -> Convergence:
    """Find the order of convergence.

    Parameters
    ----------
    differences : sequence of float
        Value at each step less that at the next finer one; or distances of curves, all positive.
    scale : float
        Size of the figure, for what counts as rounding.

    Returns
    -------
    Convergence
        Without an order where the differences do not show one.
    """
    if not all(map(math.isfinite, (*differences, scale))):
        return Convergence(None, "it has no value at one of the steps")
    rounding = ROUNDING * scale
    if all(abs(difference) <= rounding for difference in differences):
        return Convergence(None, errors=(0.0,) * (len(differences) + 1))
    orders = tuple(map(_order, differences, differences[1:]))
    reason = _doubt(differences[-3:], orders[-2:], rounding)
    if reason:
        scatters = any(math.isnan(order) for order in orders[-2:])
        return Convergence(None, reason, orders=orders, scatters=scatters)
    errors = [differences[-1] / (2.0 ** orders[-1] - 1.0)]
    for difference in reversed(differences):
        errors.insert(0, errors[0] + difference)
    return Convergence(orders[-1], "", tuple(errors), orders)


def _order(coarse: float, fine: float) -> float:
    """Return the order of two successive differences; NaN where they have none."""
    return math.log2(coarse / fine) if coarse * fine > 0.0 else math.nan


def _doubt(differences: Sequence[float], orders: Sequence[float], rounding: float) -> str:
    """Return why the last differences have no order; empty if they have one."""
    if abs(differences[-1]) <= rounding:
        return "the finest two steps agree to rounding, coarser ones do not"
    if any(math.isnan(order) for order in orders):
        return "it is not monotone: the differences change their sign"
    if orders[-1] <= 0.0:
        return "the differences do not become smaller"
    if not LEAST_ORDER <= orders[-1] <= MOST_ORDER:
        return f"the differences give {orders[-1]:.2g}, which is no order to build on"
    if abs(orders[-1] - orders[0]) > SETTLED:
        return f"it is not settled: {orders[0]:.2f}, then {orders[-1]:.2f}"
    return ""


def halvings_for(found: Convergence, most: float) -> int | None:
    """Return how often the coarsest step has to be halved for an accuracy.

    Parameters
    ----------
    found : Convergence
        Of a figure.
    most : float
        Largest error, in the unit of the figure.

    Returns
    -------
    int or None
        More than were computed where the order has to be extrapolated; None where the errors are
        not known, or no step in reach will do.
    """
    if not found.is_known:
        return None
    finest = len(found.errors) - 1
    if abs(found.errors[finest]) <= most:
        level = finest
        while level and abs(found.errors[level - 1]) <= most:
            level -= 1
        return level
    if found.order is None or most <= 0.0:
        return None
    more = math.ceil(math.log2(abs(found.errors[finest]) / most) / found.order)
    return finest + more if more <= _MOST_HALVINGS else None
