"""Units of ports that are connected."""

from ..fmu.description import UnitDefinition

_JOULE = {"kg": 1, "m": 2, "s": -2}
"""Exponents of the base units of energy."""


def units_agree(one: UnitDefinition | None, other: UnitDefinition | None) -> bool | None:
    """Tell whether values can pass unchanged; None where that cannot be known.

    Parameters
    ----------
    one, other : UnitDefinition or None
        A port without a unit goes with everything.
    """
    if one is None or other is None:
        return True
    return one.agrees_with(other)


def unit_text(unit: UnitDefinition | None) -> str:
    """Return a unit with its meaning in base units: ``kN (1000 kg.m.s-2)``.

    Parameters
    ----------
    unit : UnitDefinition or None
        ``1`` stands for none.
    """
    if unit is None:
        return "1"
    if unit.base is None:
        return unit.name
    powers = [symbol + (str(n) if n != 1 else "") for symbol, n in unit.base.items()]
    offset = f" + {unit.offset:g}" if unit.offset else ""
    return f"{unit.name} ({unit.factor:g} {'.'.join(powers) or '1'}{offset})"


def is_force(one: UnitDefinition | None) -> bool | None:
    """Tell whether a unit is that of a force or a torque; None where that cannot be known.

    Parameters
    ----------
    one : UnitDefinition or None
        An angle counts as a number.
    """
    if one is None or one.base is None:
        return None
    exponents = {s: n for s, n in one.base.items() if n and s != "rad"}
    return exponents.pop("m", 0) in (1, 2) and exponents == {"kg": 1, "s": -2}


def is_joule(one: UnitDefinition | None, other: UnitDefinition | None) -> bool | None:
    """Tell whether the product of two units is the joule; None where that cannot be known.

    Parameters
    ----------
    one, other : UnitDefinition or None
        An angle counts as a number.
    """
    if one is None or other is None or one.base is None or other.base is None:
        return None
    symbols = {*one.base, *other.base} - {"rad"}
    exponents = {s: one.base.get(s, 0) + other.base.get(s, 0) for s in symbols}
    is_energy = {s: n for s, n in exponents.items() if n} == _JOULE
    return is_energy and one.factor * other.factor == 1.0
