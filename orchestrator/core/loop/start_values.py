"""Values that are set before the initialisation: sizes first, arrays of FMI 3.0 as a whole."""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import cast

import numpy as np

from ..fmu.description import SIZE, Description, Port
from ..fmu.slave import NUMBERS, OK, Slave, SlaveOfFmi3, worst
from ..system.plan import Starts
from ..system.values import start_value

_Values = Mapping[str, float | str]


def set_values(slave: Slave, description: Description, starts: Starts) -> int:
    """Set the values of a slave that is not initialised yet.

    Parameters
    ----------
    slave : Slave
        Just made, or reset.
    description : Description
        In the sizes that are set.
    starts : sequence of (Port, value)
        The elements of an array of FMI 3.0 for which there is no value keep their start values.

    Returns
    -------
    int
        The worst status.
    """
    values = {port.name: value for port, value in starts}
    sizes = [port for port, _ in starts if port.causality == SIZE]
    others = [port for port, _ in starts if port.causality != SIZE]
    status = OK
    if sizes:
        status = cast(SlaveOfFmi3, slave).configure(
            [_setting(port, [values[port.name]]) for port in sizes]
        )
    for _, group in groupby(_by_array(others), lambda port: (port.kind, port.array)):
        port = next(group)
        elements = description.elements_of(port)
        status = worst(status, _set(slave, port, [_value(values, one) for one in elements]))
    return status


def _by_array(ports: Sequence[Port]) -> list[Port]:
    """Return ports in the order in which their arrays come first."""
    turns: dict[str, int] = {}
    for port in ports:
        turns.setdefault(port.array, len(turns))
    return sorted(ports, key=lambda port: turns[port.array])


def _value(values: _Values, port: Port) -> float | str:
    if port.name in values:
        return values[port.name]
    start = start_value(port)
    assert start is not None, port.name  # else the system has been refused
    return start


def _set(slave: Slave, port: Port, values: Sequence[float | str]) -> int:
    if port.kind in NUMBERS:
        return slave.set(*_setting(port, values))
    if port.shape:
        return cast(SlaveOfFmi3, slave).set_texts(port.reference, list(map(str, values)))
    return slave.set_text(port.reference, str(values[0]))


def _setting(port: Port, values: Sequence[float | str]) -> tuple[np.ndarray, np.ndarray, str]:
    reference = np.array([port.reference], np.uint32)
    return reference, np.array(values, np.float64), port.type
