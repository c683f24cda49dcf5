"""Values of single variables of a slave, outside of the exchange."""

from collections.abc import Sequence

import numpy as np

from .description import Port
from .slave import OK, Slave, worst


def read_values(slave: Slave, ports: Sequence[Port]) -> tuple[int, list[float]]:
    """Read the present values of numbers.

    Parameters
    ----------
    slave : Slave
        An array of FMI 3.0 is read once, whole.
    ports : sequence of Port
        Of the slave.

    Returns
    -------
    (int, list of float)
        The worst status, and the value of each port.
    """
    status = OK
    arrays: dict[int, np.ndarray] = {}
    values = []
    for port in ports:
        if port.reference not in arrays or not port.shape:
            out = np.zeros(port.length)
            reference = np.array([port.reference], np.uint32)
            status = worst(status, slave.get(reference, out, port.type))
            arrays[port.reference] = out
        values.append(float(arrays[port.reference][port.element]))
    return status, values


def read_value(slave: Slave, port: Port) -> float:
    """Read the present value of a number; one that cannot be read is 0.

    Parameters
    ----------
    slave : Slave
        Whose value it is.
    port : Port
        Of the slave.
    """
    return read_values(slave, [port])[1][0]
