"""Connections and values as SSP has them: an array of FMI 3.0 is one connector, and one value."""

from collections.abc import Iterable
from typing import NamedTuple

from ..core.errors import InputRefused, Problem
from ..core.fmu.description import Description, Port
from ..core.system.plan import End, Plan
from ..core.system.units import units_agree
from ..core.system.values import start_value


class Joint(NamedTuple):
    """A connection: of arrays, the first element of each.

    way: factor and offset in the place of a conversion of units; None where both units are one.
    """

    source: End
    target: End
    way: tuple[float, float] | None


def linked(plan: Plan, ssp_version: str) -> list[Joint]:
    """Return the connections of a system.

    Parameters
    ----------
    plan : Plan
        The system.
    ssp_version : str
        ``1.0`` or ``2.0``.

    Returns
    -------
    list of Joint
        In the order of the inputs.

    Raises
    ------
    InputRefused
        The version does not know FMI 3.0, or parts of arrays are connected.
    """
    problems = [
        Problem(name, "is of FMI 3.0, which SSP 1.0 does not know", 'give ssp="2.0"')
        for name, known in plan.descriptions.items()
        if known.is_fmi_3 and ssp_version == "1.0"
    ]
    groups: dict[tuple[str, ...], list[Joint]] = {}
    for place, target, source in plan.fed:
        ends = (source.component, source.port.array, target.component, target.port.array)
        groups.setdefault(ends, []).append(Joint(source, target, _way(plan, place, source, target)))
    for group in groups.values():
        if not _is_whole(group):
            first = group[0]
            what = "connects elements of an array of FMI 3.0, and SSP whole ones"
            where = f"{first.source.name} -> {first.target.name}"
            problems.append(Problem(where, what, "connect whole arrays of FMI 3.0 alone"))
    if problems:
        raise InputRefused(problems)
    return [group[0] for group in groups.values()]


def _way(plan: Plan, place: int, source: End, target: End) -> tuple[float, float] | None:
    """Return factor and offset of a connection.

    A factor of 1 between two units, which changes nothing here, has to be told: others would
    convert the value.
    """
    is_one_unit = units_agree(source.port.unit, target.port.unit)
    return plan.linear.get(place, None if is_one_unit else (1.0, 0.0))


def _is_whole(group: list[Joint]) -> bool:
    """Tell whether connections are a single one, or all of two arrays, element by element."""
    source, target, way = group[0]
    if not source.port.shape and not target.port.shape:
        return True
    return (
        source.port.shape == target.port.shape
        and len(group) == source.port.length
        and all(one.port.element == other.port.element for one, other, _ in group)
        and all(link.way == way for link in group)
    )


def whole_arrays(
    known: Description, starts: Iterable[tuple[Port, float | str]]
) -> list[tuple[Port, float | str]]:
    """Return values with those of all elements of an array, in their order.

    Elements without a value have their start value.

    Parameters
    ----------
    known : Description
        Of the FMU.
    starts : iterable of (Port, float or str)
        Variables and their values.

    Raises
    ------
    InputRefused
        An element has no start value either.
    """
    values = {port.name: value for port, value in starts}
    ports = {port.array: port for port, _ in starts}
    whole: list[tuple[Port, float | str]] = []
    for port in ports.values():
        for element in known.elements_of(port):
            value = values.get(element.name, start_value(element))
            if value is None:
                what = "has no value, and SSP has those of whole arrays"
                raise InputRefused([Problem(element.name, what, "give it one")])
            whole.append((element, value))
    return whole
