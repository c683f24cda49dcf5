"""Quantities with units, as people write them: ``2.5 t``, ``39 kgf/cm2``, ``90 km/h``, ``15 deg``.

A number without a unit is in SI. Units are those of pint, in the notation of this program: ``cm2``
is a square centimetre, ``kN.m`` a product. A weight stands for the mass that has it in standard
gravity: ``2.5 tf`` for 2.5 t, ``18 kN/m3`` for 1835 kg/m3.
"""

import math
import re
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

from rockshed.components.common.units import UNITS, standard_gravity

from ..fmu.description import UnitDefinition
from ..input_text import shown
from .names import nearest
from .units import unit_text

if TYPE_CHECKING:
    from pint import Quantity, Unit, UnitRegistry

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*(\S.*)?")
_FACTOR = r"[A-Za-zµμΩ]+(?:(?:\^|\*\*)?-?[1-9])?"
_UNIT = re.compile(rf"(?:1|{_FACTOR})(?:\s*[*./ ]\s*{_FACTOR})*")
_POWER = re.compile(r"([A-Za-zµμΩ])(?:\^|\*\*)?(-?[1-9])")
_COMMA = re.compile(r"[+-]?\d+(?:[.,]\d+)*,\d+(?:[.,]\d+)*")
"""Begins a number with a comma, between decimals or thousands."""
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+(?:\.\d+)?")
_LONGEST = 40
"""Letters of a quantity, at most."""
_BEGINS = frozenset("+-.0123456789")
_DIGITS = 10**40
"""A decimal factor makes it a whole number: those of powers of lengths have so many digits."""
_SIGNS = str.maketrans({"²": "2", "³": "3", "⁴": "4", "·": ".", "°": "deg"})
_OFFERED = (
    *("m", "cm", "mm", "km", "in", "ft", "m2", "cm2", "mm2", "m3", "cm3", "m4", "cm4", "mm4"),
    *("kg", "g", "t", "lb", "kg/m", "kg/m2", "kg/m3", "t/m3", "g/cm3", "kN/m3"),
    *("N", "kN", "MN", "kgf", "tf", "lbf", "N/m", "kN/m", "kN/m2", "kgf/cm2", "tf/m2", "kgf/cm"),
    *("Pa", "kPa", "MPa", "GPa", "bar", "psi", "ksi", "N/mm2", "J", "kJ", "MJ", "kN.m", "tf.m"),
    *("s", "ms", "min", "h", "m/s", "km/h", "ft/s", "deg", "rad", "rad/s", "deg/s", "m/s2"),
)
"""Units among which the nearest to an unknown one is offered."""


def in_si(text: str, unit: str) -> float:
    """Read a quantity.

    Parameters
    ----------
    text : str
        A number, with a unit or in SI.
    unit : str
        SI unit of the kind of quantity, a key of
        :data:`rockshed.components.common.units.UNITS`.

    Returns
    -------
    float
        Value in that unit, see :func:`in_unit`.

    Raises
    ------
    ValueError
        It is no number with a unit, the unit does not exist or is of another kind; with a remedy.
    """
    return in_unit(text, _si(unit))


def in_unit(text: str, unit: UnitDefinition | None, is_difference: bool = False) -> float:
    """Read a quantity in the unit of a variable.

    Parameters
    ----------
    text : str
        A number, in the unit of the variable or with one of its own.
    unit : UnitDefinition or None
        Of the variable. One that is not defined, but called like an SI unit, is that.
    is_difference : bool
        Whether it is the difference of two values: an offset of a unit, of degC, is passed over.

    Returns
    -------
    float
        The nearest to the value where the factor between the units is a decimal number: 90 cm are
        0.9 m; else the value with 15 digits.

    Raises
    ------
    ValueError
        It is no number with a unit, the unit does not exist or is of another kind; with a remedy.
    """
    if comma := _COMMA.match(text.strip()):
        raise ValueError(
            f"must have a decimal point and no comma between digits: write "
            f"{_without_comma(comma[0])} (given: {shown(text)})"
        )
    name = unit.name if unit else "1"
    found = _QUANTITY.fullmatch(text.strip().translate(_SIGNS))
    if found is None or len(text) > _LONGEST:
        raise ValueError(
            f"must be a number, with a unit or in {_named(name)} (given: {shown(text)})"
        )
    number, written = _finite(float(found.group(1)), text), found.group(2)
    if written in (None, name):
        return number
    meant = defined(unit)
    if meant is None:
        why = "it has no unit" if unit is None else f"what its unit {name} is, is told nowhere"
        raise ValueError(f"must be a number alone: {why} (given: {shown(text)})")
    from pint import PintError

    exact = Fraction(found.group(1)) if number else Fraction(0)  # 1e-999999 has too many digits
    try:
        return _converted(exact, written, text, meant, is_difference)
    except PintError as error:
        raise ValueError(f"{shown(text)}: {written} is no unit to count in") from error


def finite_number(text: str) -> float | None:
    """Read a finite number; return None if the text is none."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def is_quantity(text: str) -> bool:
    """Tell whether a text is a number with something behind it, and may be a quantity."""
    return text.strip()[:1] in _BEGINS and finite_number(text) is None


def _si(name: str) -> UnitDefinition:
    return UnitDefinition(name, UNITS[name].base, UNITS[name].factor)


def defined(unit: UnitDefinition | None) -> UnitDefinition | None:
    """Return what a unit means; None where nobody tells.

    Parameters
    ----------
    unit : UnitDefinition or None
        One that is not defined, but called like an SI unit, is that.
    """
    if unit is None or unit.base is not None:
        return unit
    return _si(unit.name) if unit.name in UNITS else None


def _without_comma(number: str) -> str:
    """Return how a number with commas may have been meant: its decimals or its thousands."""
    is_decimal = number.count(",") == 1 and number.rfind(",") > number.rfind(".")
    decimal = number.replace(".", "").replace(",", ".") if is_decimal else ""
    whole = number.replace(",", "") if _THOUSANDS.fullmatch(number) else ""
    return " or ".join(filter(None, [decimal, whole])) or "1234.5, for instance"


def _converted(
    number: Fraction, written: str, text: str, unit: UnitDefinition, is_difference: bool
) -> float:
    """Return a quantity in a unit; of a weight in the place of a mass, the mass.

    Raises
    ------
    ValueError
        It is of another kind, or not finite.
    """
    given = _registry().Quantity
    base = _product(unit)
    one = given(Fraction(1), _unit(written))
    gravity = given(Fraction(str(standard_gravity)), _unit("m/s2"))
    if not one.is_compatible_with(base) and not (one / gravity).is_compatible_with(base):
        raise ValueError(_of_another_kind(one, text, unit))

    def value(count: Fraction) -> Fraction:
        quantity = given(count, _unit(written))
        quantity = quantity if one.is_compatible_with(base) else quantity / gravity
        in_base = Fraction(quantity.to(base).magnitude)
        return (in_base - Fraction(str(unit.offset))) / Fraction(str(unit.factor))

    zero = value(Fraction(0))
    exact = value(number) - (zero if is_difference else 0)
    factor = value(Fraction(1)) - zero
    try:
        nearest_float = float(exact)
    except OverflowError:
        nearest_float = math.inf
    is_decimal = _DIGITS % factor.denominator == 0
    return _finite(nearest_float if is_decimal else float(f"{nearest_float:.15g}"), text)


def _of_another_kind(given: "Quantity[Fraction]", text: str, unit: UnitDefinition) -> str:
    """Return what a quantity has to be in the place of what it is."""
    same = (name for name in UNITS if given.is_compatible_with(_product(_si(name))))
    kind = next((f"is {_kind(name)}" for name in same), "is of another kind")
    named = next((name for name in UNITS if _is_of(unit, name)), None)
    wanted = f"{_kind(named)}, in {_named(unit.name)}" if named else f"in {unit_text(unit)}"
    return f"must be {wanted} (given: {shown(text)}, which {kind})"


def _is_of(unit: UnitDefinition, name: str) -> bool:
    """Tell whether a unit is of the kind of an SI unit; of torque and energy, of its own name."""
    if unit.name in UNITS and unit.base == UNITS[unit.name].base:
        return unit.name == name
    return {s: n for s, n in (unit.base or {}).items() if n} == UNITS[name].base


def _product(unit: UnitDefinition) -> "Unit":
    """Return the product of base units that a unit is a multiple of."""
    product = _unit("1")
    for base, power in (unit.base or {}).items():
        product *= _unit(base) ** power
    return product


def _finite(value: float, text: str) -> float:
    if not math.isfinite(value):
        raise ValueError(f"must be a finite number (given: {shown(text)})")
    return value


@cache
def _registry() -> "UnitRegistry[float]":
    from pint import UnitRegistry  # takes a second, which only values with units are worth

    return UnitRegistry(cache_folder=None, non_int_type=Fraction)


@cache
def _unit(written: str) -> "Unit":
    """Return a unit by its name.

    Raises
    ------
    ValueError
        There is no such unit; with the nearest.
    """
    known = _registry()
    if written == "1":
        return known.dimensionless
    if not _UNIT.fullmatch(written):
        raise ValueError(f"{written!r} is no unit; {_nearest(written)}")
    from pint import PintError

    try:
        return known.parse_units(_POWER.sub(r"\1**\2", written).replace(".", "*"))
    except (PintError, ValueError, AttributeError) as error:
        raise ValueError(f"there is no unit {written!r}; {_nearest(written)}") from error


def _nearest(written: str) -> str:
    return nearest(written, _OFFERED)


def _kind(unit: str) -> str:
    """Return a kind of quantity in words: ``a length``, ``a mass per length``."""
    words = re.sub(r"(?<=[a-z])([A-Z])", r" \1", UNITS[unit].quantity).lower()
    if unit == "1":
        return "a number without a unit"
    return f"an {words}" if words[0] in "aeiou" else f"a {words}"


def _named(unit: str) -> str:
    return "SI units" if unit == "1" else unit
