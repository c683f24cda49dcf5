"""Variables of the FMU under check, as its description declares them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Numbers = tuple[Any, ...]
"""Values of a variable, one for each element."""

_CALLS_3 = {"Enumeration": "Int64"}
_CALLS_2 = {"Enumeration": "Integer"}
FLOATS = ("Real", "Float64", "Float32")
"""Families of calls that move real numbers."""
_LARGEST_FLOAT32 = 3.4028234663852886e38


@dataclass(frozen=True)
class Declared:
    """A variable that FMI calls can move.

    Attributes
    ----------
    name : str
        As in the description.
    reference : int
        Value reference.
    kind : str
        Family of calls that moves it: ``Real``, ``Float64``, ``Boolean``, ...
    causality, variability, initial : str
        As in the description; ``initial`` is empty where there is none.
    size : int
        Number of elements.
    start : tuple, optional
        Start values, one for each element.
    lowest, highest : float, optional
        Range.
    nominal : float
        Size of usual values; 1 where none is told.
    items : frozenset of int
        Values of an enumeration; empty for anything else.
    place : int
        Number of the variable in the description, from 0.
    is_alias : bool
        Another variable before it has the same reference.
    """

    name: str
    reference: int
    kind: str
    causality: str
    variability: str
    initial: str
    size: int
    start: Numbers | None
    lowest: float | None
    highest: float | None
    nominal: float
    items: frozenset[int]
    place: int
    is_alias: bool = False

    @property
    def is_real(self) -> bool:
        """Tell whether its values are real numbers."""
        return self.kind in FLOATS

    def other_start(self) -> Numbers | None:
        """Return values near the start that are allowed and differ from it; None without any."""
        if not self.start:
            return None
        values = tuple(self._other(value) for value in self.start)
        return None if values == self.start else values

    def _other(self, value: Any) -> Any:
        if self.kind == "Boolean":
            return not value
        if self.kind in ("String", "Binary", "Clock") or not isinstance(value, int | float):
            return value
        if self.items:
            return next((item for item in sorted(self.items) if item != value), value)
        by = max(abs(value), 1.0) / 64 if self.is_real else 1
        for tried in (value + by, value - by):
            if self.allows(tried):
                return tried
        return value

    def allows(self, value: float) -> bool:
        """Tell whether a value lies in the range."""
        least = -math.inf if self.lowest is None else self.lowest
        most = math.inf if self.highest is None else self.highest
        return least <= value <= most


def declared(model: Any) -> list[Declared]:
    """Return the variables of a model description that can be moved at any time.

    Parameters
    ----------
    model : fmpy.model_description.ModelDescription
        Of the FMU.

    Returns
    -------
    list of Declared
        Without clocks, what hangs on clocks, and aliases.
    """
    is_three = model.fmiMajorVersion == 3
    seen: set[tuple[str, int]] = set()
    found = []
    for place, variable in enumerate(model.modelVariables):
        if variable.type == "Clock" or variable.clocks:
            continue
        calls = _CALLS_3 if is_three else _CALLS_2
        kind = calls.get(variable.type, variable.type)
        key = (kind, int(variable.valueReference))
        found.append(_declared(variable, kind, place, key in seen))
        seen.add(key)
    return found


def _declared(variable: Any, kind: str, place: int, is_alias: bool) -> Declared:
    size = math.prod(variable.shape or ())
    kin = variable.declaredType
    items = getattr(kin, "items", None) or ()
    return Declared(
        variable.name,
        int(variable.valueReference),
        kind,
        variable.causality or "local",
        variable.variability or "",
        variable.initial or "",
        size,
        _start(variable.start, kind, size),
        _limit(variable.min, kin, "min"),
        _limit(variable.max, kin, "max"),
        abs(_limit(variable.nominal, kin, "nominal") or 1.0),
        frozenset(int(item.value) for item in items),
        place,
        is_alias,
    )


def _limit(own: Any, kin: Any, name: str) -> float | None:
    text = own if own is not None else getattr(kin, name, None)
    try:
        return None if text is None else float(text)
    except ValueError:
        return None


def _start(text: Any, kind: str, size: int) -> Numbers | None:
    """Return the start values of a description; None where they cannot be read."""
    if text is None:
        return None
    if kind == "String":
        return (text,) if size == 1 and isinstance(text, str) else None
    try:
        if kind == "Binary":
            return (bytes.fromhex(text),) if size == 1 else None
        values = tuple(_value(word, kind) for word in str(text).split())
    except ValueError:
        return None
    if len(values) == 1:
        values *= size
    return values if len(values) == size else None


def _value(word: str, kind: str) -> Any:
    if kind == "Boolean":
        if word not in ("true", "false", "1", "0"):
            raise ValueError(word)
        return word in ("true", "1")
    return float(word) if kind in FLOATS else int(word)


def exactly(values: Mapping[str, Numbers]) -> dict[str, tuple[str, ...]]:
    """Return values in a form that is equal only where every bit is.

    Parameters
    ----------
    values : mapping of str to tuple
        Values by variable.

    Returns
    -------
    dict of str to tuple of str
        Real numbers in hexadecimal notation.
    """
    return {
        name: tuple(v.hex() if isinstance(v, float) else repr(v) for v in elements)
        for name, elements in values.items()
    }


def differing(one: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    """Return the names of what is not equal in two mappings of the same keys."""
    return [name for name, value in one.items() if other.get(name) != value]


def not_finite(values: Mapping[str, Numbers]) -> list[str]:
    """Return the names of variables with an element that is not a finite number."""
    return [
        name
        for name, elements in values.items()
        if any(isinstance(v, float) and not math.isfinite(v) for v in elements)
    ]


def listed(names: Sequence[str], most: int = 3) -> str:
    """Return names as a text: the first few, and how many more there are."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")
