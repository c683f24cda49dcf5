"""Factors of a study: a name, and the values that it takes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...core.errors import Problem
from ...core.input_text import shown
from ...core.system.fields import Value
from ...core.system.quantities import finite_number
from ...input_files.form import LARGEST
from ..frame import FloatArray

_NEVER = 1e-12
"""Probability beyond which a distribution is cut off: its tails may be endless."""
MOST_LEVELS = 100_000
"""Levels of a range, at most."""


@dataclass(frozen=True)
class Levels:
    """Listed values; in a random sample each is as probable as any other.

    Attributes
    ----------
    values : tuple of Value
        Numbers, or texts with a unit, or words.
    """

    values: tuple[Value, ...]


@dataclass(frozen=True)
class Listed(Levels):
    """A value for each of some variants, in their order; variants may have the same one."""


@dataclass(frozen=True)
class Interval:
    """Values between two bounds; in a random sample all are equally probable.

    Attributes
    ----------
    low, high : float or str
        Bounds, numbers or texts with a unit.
    levels : int, optional
        Number of values of a grid, evenly spaced, the bounds among them.
    """

    low: float | str
    high: float | str
    levels: int | None = None


@dataclass(frozen=True)
class RandomValue:
    """A distribution of probability.

    Attributes
    ----------
    kind : str
        ``normal``: mean and standard deviation. ``lognormal``: median, and standard deviation of
        the natural logarithm. ``uniform``: bounds. ``triangular``: lower bound, mode, upper bound.
    parameters : tuple of float or str
        Numbers, or texts with a unit.
    """

    kind: str
    parameters: tuple[float | str, ...]


Varied = Levels | Interval | RandomValue
"""How a factor varies."""


@dataclass(frozen=True)
class Factor:
    """A value of the system that varies.

    Attributes
    ----------
    name : str
        Field of a project, ``component.parameter`` or the name of a shared value.
    unit : str
        SI unit of its numbers; ``1`` for numbers without one and for words.
    varied : Varied
        With numbers in SI.
    """

    name: str
    unit: str
    varied: Varied

    @property
    def is_distribution(self) -> bool:
        """Whether its values have probabilities that somebody has thought of."""
        return isinstance(self.varied, RandomValue)

    def levels(self) -> list[Value]:
        """Return the values that a grid has; none of a factor without levels."""
        varied = self.varied
        if isinstance(varied, Levels):
            return list(varied.values)
        if isinstance(varied, Interval) and varied.levels:
            found = np.linspace(float(varied.low), float(varied.high), varied.levels)
            return [self._value(x) for x in found]
        return []

    def at(self, probabilities: FloatArray) -> list[Value]:
        """Return the values that are not exceeded with these probabilities.

        Parameters
        ----------
        probabilities : array of float, shape (n,)
            From 0 to 1.

        Returns
        -------
        list of Value
            Of a list, each value for an equal part of the range.
        """
        varied = self.varied
        if isinstance(varied, Levels):
            count = len(varied.values)
            places = np.minimum((probabilities * count).astype(int), count - 1)
            return [varied.values[place] for place in places]
        inside = np.clip(probabilities, _NEVER, 1.0 - _NEVER)
        return [self._value(x) for x in _frozen(varied).ppf(inside)]

    def _value(self, number: float) -> Value:
        """Return a number of 12 digits; a whole one as such where no unit tells that it is real."""
        rounded = float(f"{number:.12g}")
        return int(rounded) if self.unit == "1" and rounded.is_integer() else rounded

    def as_data(self) -> dict[str, Any]:
        """Return the factor as plain data."""
        return {"name": self.name, "unit": self.unit, **varied_as_data(self.varied)}


def varied_as_data(varied: Varied) -> dict[str, Any]:
    """Return how a factor varies as plain data, under the name of its kind."""
    content = {key: value for key, value in vars(varied).items() if value is not None}
    return {type(varied).__name__.lower(): content}


def factor_from(data: Mapping[str, Any]) -> Factor:
    """Return a factor of plain data.

    Parameters
    ----------
    data : mapping
        As :meth:`Factor.as_data` gives it.
    """
    return Factor(str(data["name"]), str(data["unit"]), varied_from(data))


def varied_from(data: Mapping[str, Any]) -> Varied:
    """Return how a factor varies of plain data.

    Parameters
    ----------
    data : mapping
        As :func:`varied_as_data` gives it; other entries are passed over.
    """
    kinds: Mapping[str, Callable[..., Varied]] = {
        "levels": Levels,
        "listed": Listed,
        "interval": Interval,
        "randomvalue": RandomValue,
    }
    for kind, made in kinds.items():
        if kind in data:
            content = dict(data[kind])
            listed = {k: tuple(v) if isinstance(v, list) else v for k, v in content.items()}
            return made(**listed)
    raise ValueError("it has a factor that does not vary")


# --- distributions ---


def _frozen(varied: Interval | RandomValue) -> Any:
    """Return a distribution of scipy."""
    from scipy import stats

    if isinstance(varied, Interval):
        low, high = float(varied.low), float(varied.high)
        return stats.uniform(low, high - low)
    numbers = [float(number) for number in varied.parameters]
    return _KINDS[varied.kind].made(stats, *numbers)


@dataclass(frozen=True)
class _Kind:
    """A kind of distribution: names of its parameters, those with its unit, how it is made."""

    parameters: tuple[str, ...]
    with_unit: tuple[bool, ...]
    made: Callable[..., Any]
    fault: Callable[..., str]


def _normal_fault(mean: float, deviation: float) -> str:
    return "" if deviation > 0.0 else "its standard deviation must be positive"


def _lognormal_fault(median: float, sigma: float) -> str:
    return "" if median > 0.0 and sigma > 0.0 else "its median and deviation must be positive"


def _uniform_fault(low: float, high: float) -> str:
    return "" if low < high else "its upper bound must be above the lower one"


def _triangular_fault(low: float, mode: float, high: float) -> str:
    good = low <= mode <= high and low < high
    return "" if good else "lower bound, mode and upper bound must ascend"


_KINDS: Mapping[str, _Kind] = {
    "normal": _Kind(
        ("mean", "standard deviation"),
        (True, True),
        lambda stats, mean, deviation: stats.norm(mean, deviation),
        _normal_fault,
    ),
    "lognormal": _Kind(
        ("median", "standard deviation of the logarithm"),
        (True, False),
        lambda stats, median, sigma: stats.lognorm(sigma, scale=median),
        _lognormal_fault,
    ),
    "uniform": _Kind(
        ("lower bound", "upper bound"),
        (True, True),
        lambda stats, low, high: stats.uniform(low, high - low),
        _uniform_fault,
    ),
    "triangular": _Kind(
        ("lower bound", "mode", "upper bound"),
        (True, True, True),
        lambda stats, low, mode, high: stats.triang(
            (mode - low) / (high - low), loc=low, scale=high - low
        ),
        _triangular_fault,
    ),
}
KINDS: Mapping[str, Sequence[str]] = {name: kind.parameters for name, kind in _KINDS.items()}
"""Names of the parameters by kind of distribution."""

ValueReader = Callable[[Value], Value]
"""Returns a value in SI, a word as it is; raises ValueError for one of another kind."""


def in_si(name: str, varied: Varied, unit: str, read: ValueReader) -> tuple[Factor, list[Problem]]:
    """Return a factor with its numbers in SI, and what is wrong with it.

    Parameters
    ----------
    name : str
        Of the value that varies.
    varied : Varied
        As it was given.
    unit : str
        SI unit of the value; ``1`` where there is none.
    read : callable
        Reads one value.
    """
    found = list(_form_faults(varied))
    numbers: list[Value] = []
    if not found:
        for value, has_unit in _with_units(varied):
            try:
                numbers.append(read(value) if has_unit else _number(value))
            except ValueError as error:
                found.append(str(error))
    if not found:
        varied = _with_numbers(varied, numbers)
        found += _meaning_faults(varied)
    factor = Factor(name, unit, varied)
    return factor, [Problem(f"vary {name}", text) for text in found]


def _form_faults(varied: Varied) -> Iterator[str]:
    """Yield what is wrong with a factor, whatever its numbers are."""
    if isinstance(varied, Levels) and not varied.values:
        yield "has no value"
    if isinstance(varied, Interval) and varied.levels is not None and varied.levels < 2:
        yield f"{varied.levels} levels are no range: give two at least"
    if isinstance(varied, Interval) and varied.levels is not None and varied.levels > MOST_LEVELS:
        yield f"{shown(varied.levels)} levels, and {MOST_LEVELS:,} are the most"
    if not isinstance(varied, RandomValue):
        return
    if varied.kind not in _KINDS:
        yield f"there is no distribution {varied.kind!r}: choose one of {', '.join(_KINDS)}"
        return
    wanted = _KINDS[varied.kind].parameters
    if len(varied.parameters) != len(wanted):
        yield f"{varied.kind} takes {len(wanted)} numbers: {', '.join(wanted)}"


def _with_units(varied: Varied) -> list[tuple[Value, bool]]:
    """Return the numbers of a factor, and whether each has the unit of the value."""
    if isinstance(varied, Levels):
        return [(value, True) for value in varied.values]
    if isinstance(varied, Interval):
        return [(varied.low, True), (varied.high, True)]
    return list(zip(varied.parameters, _KINDS[varied.kind].with_unit, strict=True))


def _number(value: Value) -> float:
    number = finite_number(str(value))
    if number is None:
        raise ValueError(f"must be a finite number (given: {shown(value)})")
    return number


def _with_numbers(varied: Varied, numbers: Sequence[Any]) -> Varied:
    if isinstance(varied, Levels):
        return replace(varied, values=tuple(numbers))
    if isinstance(varied, Interval):
        return replace(varied, low=numbers[0], high=numbers[1])
    return replace(varied, parameters=tuple(numbers))


def _meaning_faults(varied: Varied) -> Iterator[str]:
    """Yield what is wrong with the numbers of a factor."""
    if isinstance(varied, Levels):
        is_plain = not isinstance(varied, Listed)
        if is_plain and len(set(varied.values)) < len(varied.values):
            yield "has a value twice"
        return
    content = (varied.low, varied.high) if isinstance(varied, Interval) else varied.parameters
    if any(isinstance(value, str) for value in content):
        yield "needs numbers, and no words"
    elif any(abs(float(value)) > LARGEST for value in content):
        yield f"has a number beyond {LARGEST:g}"
    elif isinstance(varied, Interval):
        fault = _uniform_fault(float(varied.low), float(varied.high))
        yield from filter(None, [fault])
    else:
        fault = _KINDS[varied.kind].fault(*map(float, varied.parameters))
        yield from filter(None, [fault or _reach_fault(varied)])


def _reach_fault(varied: RandomValue) -> str:
    """Return a fault where a distribution reaches values that nothing has."""
    with np.errstate(over="ignore"):
        ends = _frozen(varied).ppf([_NEVER, 1.0 - _NEVER])
    return "" if np.all(np.abs(ends) <= LARGEST) else f"reaches beyond {LARGEST:g}"
