"""Values for parameters and inputs: from what a person writes to what a port takes."""

import math

from rockshed.components.common.units import range_in_words

from ..fmu.description import Port
from ..fmu.slave import BOOLEAN, INTEGER, REAL, STRING
from ..fmu.types import TYPES
from .fields import Value
from .quantities import in_unit, is_quantity

_TRUE = ("true", "1", "on", "yes")
_FALSE = ("false", "0", "off", "no")


def value_for(port: Port, value: Value) -> float | str:
    """Turn a value into the number or text that a port takes.

    Parameters
    ----------
    port : Port
        Says kind, items and range.
    value : bool, int, float or str
        Text is read as a number, a quantity with a unit, a word or an item of an enumeration,
        whatever the port is.

    Returns
    -------
    float or str

    Raises
    ------
    ValueError
        The value does not fit; the message says what is allowed.
    """
    if port.kind == STRING:
        return str(value)
    if not port.is_number:
        raise ValueError(f"is of the type {port.kind}, and numbers and text can be given only")
    number = _item(port, value) if port.items else _number(port, value)
    low = -math.inf if port.minimum is None else port.minimum
    high = math.inf if port.maximum is None else port.maximum
    if not math.isfinite(number):
        raise ValueError("must be a finite number")
    if not low <= number <= high:
        allowed = range_in_words(port.minimum, port.maximum, port.unit_name)
        raise ValueError(f"allowed is {allowed}")
    held = TYPES[port.type]
    if not held.low <= number <= held.high:
        raise ValueError(f"allowed is {held.low:.17g} to {held.high:.17g}")
    return number


def start_value(port: Port) -> float | str | None:
    """Return the start value of a variable, as its description has it.

    Parameters
    ----------
    port : Port
        The variable.

    Returns
    -------
    float, str or None
        None where there is none that can be read.
    """
    if port.start is None or port.kind == STRING:
        return port.start
    try:
        return _truth(port.start) if port.kind == BOOLEAN else float(port.start)
    except ValueError:
        return None


def _item(port: Port, value: Value) -> float:
    """Return the number of an enumeration's item; the value is its name or its number."""
    if str(value) in port.items:
        return float(port.items[str(value)])
    numbers = {str(number): number for number in port.items.values()}
    if isinstance(value, bool) or str(value) not in numbers:
        raise ValueError(f"choose one of {', '.join(port.items)}")
    return float(numbers[str(value)])


def _number(port: Port, value: Value) -> float:
    if port.kind == BOOLEAN:
        return _truth(value)
    if isinstance(value, bool):
        raise ValueError("must be a number, not true or false")
    if port.kind == REAL and isinstance(value, str) and is_quantity(value):
        return in_unit(value, port.unit)
    try:
        number = float(value)
    except ValueError:
        unit = "" if port.unit is None else f" in {port.unit_name}"
        raise ValueError(f"must be a number{unit}") from None
    except OverflowError:  # an integer of hundreds of digits
        number = math.inf
    if port.kind == INTEGER and math.isfinite(number) and number != math.floor(number):
        raise ValueError("must be a whole number")
    return number


def _truth(value: Value) -> float:
    word = str(value).lower().removesuffix(".0")
    if word not in _TRUE + _FALSE:
        raise ValueError("must be true or false")
    return float(word in _TRUE)


def written(port: Port, number: float) -> Value:
    """Return a number as a person would write it.

    Parameters
    ----------
    port : Port
        Whose value it is.
    number : float
        As the port gives it.

    Returns
    -------
    bool, int, float or str
        The name of an item, true or false, a whole number, or the number itself.
    """
    if port.items:
        return next((name for name, n in port.items.items() if n == number), number)
    if port.kind == BOOLEAN:
        return bool(number)
    return number if port.kind == REAL else int(number)
