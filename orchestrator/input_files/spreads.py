"""Values of distributions that input files give, and faults of them."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.errors import Problem
from .chance import RandomQuantity
from .places import Key, Places

_Floats = NDArray[np.float64]
CUT = 3.0
"""Deviations from the mean at which a normal or lognormal distribution ends by default."""
_GIVEN = {
    "normal": ("mean", "deviation"),
    "lognormal": ("mean", "deviation"),
    "uniform": ("from", "to"),
    "triangular": ("from", "mode", "to"),
}
"""Values that each distribution needs."""
_OPTIONAL = {"normal": ("from", "to"), "lognormal": ("from", "to")}
_FIELDS = {"mean": "mean", "deviation": "deviation", "from": "low", "to": "high", "mode": "mode"}
_LEAST_PART = 1e-6
"""Least part of a distribution that its ends may leave."""


def spread_problems(spread: RandomQuantity[Any], key: Key, where: Places) -> Iterator[Problem]:
    """Yield what is wrong with a distribution.

    Parameters
    ----------
    spread : RandomQuantity
        Of an input file.
    key : Key
        Of its table.
    where : Places
        Of the values of the file.

    Yields
    ------
    Problem
        Values that are missing or have no use, and such that no distribution has.
    """
    kind = spread.distribution
    given = [name for name, attribute in _FIELDS.items() if getattr(spread, attribute) is not None]
    missing = [name for name in _GIVEN[kind] if name not in given]
    for name in given:
        if name not in (*_GIVEN[kind], *_OPTIONAL.get(kind, ())):
            text = f"a {kind} distribution has no {name}"
            yield Problem(where.of((*key, name)), text, "leave it out")
    if missing:
        remedy = f"give {', '.join(_GIVEN[kind])}"
        yield Problem(where.of(key), f"a {kind} distribution has no {', '.join(missing)}", remedy)
    elif text := _fault(spread):
        yield Problem(where.of(key), text, "correct its values")


def spread_faults(spread: RandomQuantity[Any]) -> list[Problem]:
    """Return what is wrong with a distribution, wherever it stands."""
    return list(spread_problems(spread, (), Places("distribution")))


def _fault(spread: Any) -> str:
    """Return why no distribution has these values; empty if one has."""
    if spread.deviation is not None and spread.deviation <= 0.0:
        return f"deviation = {spread.deviation:g} is not positive"
    if spread.distribution == "lognormal" and spread.mean <= 0.0:
        return f"mean = {spread.mean:g} is not positive, as that of a lognormal distribution is"
    if spread.low is not None and spread.high is not None and spread.low >= spread.high:
        return f"from = {spread.low:g} is not below to = {spread.high:g}"
    if spread.mode is not None and not spread.low <= spread.mode <= spread.high:
        return f"mode = {spread.mode:g} does not lie between from and to"
    if spread.distribution in _OPTIONAL:
        below, above = _ends(spread)
        if above - below < _LEAST_PART:
            return "from and to leave nothing of the distribution"
    return ""


def bounds(spread: RandomQuantity[Any]) -> tuple[float, float]:
    """Return the least and the largest value of a distribution without faults."""
    low, high = values_of(spread, np.array([0.0, 1.0]))
    return float(low), float(high)


def values_of(spread: RandomQuantity[Any], numbers: _Floats) -> _Floats:
    """Return the values of a distribution at uniform numbers.

    Parameters
    ----------
    spread : RandomQuantity
        Without faults.
    numbers : array of float
        From 0 to 1.

    Returns
    -------
    array of float
        Of the same shape.
    """
    from scipy.special import ndtri

    if spread.distribution == "uniform":
        return _uniform(spread, numbers)
    if spread.distribution == "triangular":
        return _triangular(spread, numbers)
    below, above = _ends(spread)
    mean, deviation = _of_normal(spread)
    values = mean + deviation * ndtri(below + (above - below) * numbers)
    return np.asarray(np.exp(values) if spread.distribution == "lognormal" else values)


def _uniform(spread: Any, numbers: _Floats) -> _Floats:
    return np.asarray(spread.low + (spread.high - spread.low) * numbers)


def _triangular(spread: Any, numbers: _Floats) -> _Floats:
    width = spread.high - spread.low
    rise, fall = spread.mode - spread.low, spread.high - spread.mode
    rising = spread.low + np.sqrt(numbers * width * rise)
    falling = spread.high - np.sqrt((1.0 - numbers) * width * fall)
    return np.where(numbers * width < rise, rising, falling)


def _of_normal(spread: Any) -> tuple[float, float]:
    """Return mean and deviation of the normal distribution, or of that of the logarithm."""
    if spread.distribution == "normal":
        return spread.mean, spread.deviation
    variance = float(np.log1p((spread.deviation / spread.mean) ** 2))
    return float(np.log(spread.mean)) - 0.5 * variance, variance**0.5


def _ends(spread: Any) -> tuple[float, float]:
    """Return the probabilities below the ends of a normal or lognormal distribution."""
    from scipy.special import ndtr

    mean, deviation = _of_normal(spread)
    ends = []
    for value, side in ((spread.low, -CUT), (spread.high, CUT)):
        place = side
        if value is not None and spread.distribution == "normal":
            place = (value - mean) / deviation
        elif value is not None:
            place = (np.log(value) - mean) / deviation if value > 0.0 else -CUT
        ends.append(float(ndtr(place)))
    return ends[0], ends[1]
