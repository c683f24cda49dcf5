"""Quantities with units, as people write them: ``2.5 t``, ``39 kgf/cm2``, ``90 km/h``, ``15 deg``.

A number without a unit is in SI. Units are those of pint, in the notation of this program: ``cm2``
is a square centimetre, ``kN.m`` a product. A weight stands for the mass that has it in standard
gravity: ``2.5 tf`` for 2.5 t, ``18 kN/m3`` for 1835 kg/m3.
"""

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from rockshed.components.common.plausible import Plausible
from rockshed.components.common.units import UNITS, standard_gravity

from ..core.input_text import shown
from ..core.system.names import nearest

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
_SIGNS = str.maketrans({"²": "2", "³": "3", "⁴": "4", "·": ".", "°": "deg"})
_OFFERED = (
    *("m", "cm", "mm", "km", "in", "ft", "m2", "cm2", "mm2", "m3", "cm3", "m4", "cm4", "mm4"),
    *("kg", "g", "t", "lb", "kg/m", "kg/m2", "kg/m3", "t/m3", "g/cm3", "kN/m3"),
    *("N", "kN", "MN", "kgf", "tf", "lbf", "N/m", "kN/m", "kN/m2", "kgf/cm2", "tf/m2", "kgf/cm"),
    *("Pa", "kPa", "MPa", "GPa", "bar", "psi", "ksi", "N/mm2", "J", "kJ", "MJ", "kN.m", "tf.m"),
    *("s", "ms", "min", "h", "m/s", "km/h", "ft/s", "deg", "rad", "rad/s", "deg/s", "m/s2"),
)
"""Units among which the nearest to an unknown one is offered."""


@dataclass(frozen=True)
class InUnit:
    """Reads texts as quantities of one kind; for ``BeforeValidator`` of pydantic.

    Attributes
    ----------
    unit : str
        SI unit of the value, a key of :data:`rockshed.components.common.units.UNITS`.
    """

    unit: str

    def __call__(self, value: Any) -> Any:
        """Return the value of a text in SI; anything else as it is.

        Parameters
        ----------
        value : Any
            As it stands in a file.

        Raises
        ------
        ValueError
            It is no quantity of this kind.
        """
        return in_si(value, self.unit) if isinstance(value, str) else value


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
        Value in that unit; of 15 digits, so that 90 cm are 0.9 m.

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
    found = _QUANTITY.fullmatch(text.strip().translate(_SIGNS))
    if found is None or len(text) > _LONGEST:
        raise ValueError(
            f"must be a number, with a unit or in {_named(unit)} (given: {shown(text)})"
        )
    number, written = float(found.group(1)), found.group(2)
    if written is None:
        return _finite(number, text)
    from pint import PintError

    try:
        return _converted(number * _unit(written), text, unit)
    except PintError as error:
        raise ValueError(f"{shown(text)}: {written} is no unit to count in") from error


def _without_comma(number: str) -> str:
    """Return how a number with commas may have been meant: its decimals or its thousands."""
    is_decimal = number.count(",") == 1 and number.rfind(",") > number.rfind(".")
    decimal = number.replace(".", "").replace(",", ".") if is_decimal else ""
    whole = number.replace(",", "") if _THOUSANDS.fullmatch(number) else ""
    return " or ".join(filter(None, [decimal, whole])) or "1234.5, for instance"


def _converted(given: "Quantity[float]", text: str, unit: str) -> float:
    """Return a quantity in an SI unit; of a weight in the place of a mass, the mass.

    Raises
    ------
    ValueError
        It is of another kind, or not finite.
    """
    by_gravity = given / (standard_gravity * _unit("m/s2"))
    for candidate in (given, by_gravity):
        if candidate.is_compatible_with(_unit(unit)):
            return _finite(_rounded(candidate, unit), text)
    same = (name for name in UNITS if given.is_compatible_with(_unit(name)))
    kind = next((f"is {_kind(name)}" for name in same), "is of another kind")
    wanted = f"must be {_kind(unit)}, in {_named(unit)}"
    raise ValueError(f"{wanted} (given: {shown(text)}, which {kind})")


def _finite(value: float, text: str) -> float:
    if not math.isfinite(value):
        raise ValueError(f"must be a finite number (given: {shown(text)})")
    return value


def doubt(value: float, unit: str, plausible: Plausible) -> str | None:
    """Return why a value is doubted, with the unit in which it may have been meant.

    Parameters
    ----------
    value : float
        In ``unit``.
    unit : str
        Key of :data:`rockshed.components.common.units.UNITS`.
    plausible : Plausible
        Range of the quantity in practice.

    Returns
    -------
    str or None
        Continues the name of the value; None where it is within the range.
    """
    if plausible.holds(value) or not math.isfinite(value):  # refused elsewhere
        return None
    suffix = "" if unit == "1" else f" {unit}"
    usual = f"{plausible.low:g} to {plausible.high:g}{suffix}"
    text = f"is {value:.6g}{suffix}, and {usual} are usual"
    for likely in plausible.likely:
        meant = in_si(f"{value!r} {likely}", unit)
        if plausible.holds(meant):
            return f"{text}; if {value:.6g} {likely} is meant, write that unit: {meant:.4g}{suffix}"
    return text


def _rounded(given: "Quantity[float]", unit: str) -> float:
    return float(f"{given.to(_unit(unit)).magnitude:.15g}")


@cache
def _registry() -> "UnitRegistry[float]":
    from pint import UnitRegistry  # takes a second, which only values with units are worth

    return UnitRegistry(cache_folder=None)


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
