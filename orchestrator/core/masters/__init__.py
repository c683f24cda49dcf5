"""Ways of carrying out the exchanges of a run, which the plan of a system chooses.

A way is a :class:`~rockshed.core.loop.driver.Driver`. The explicit masters ``sequential`` and
``jacobi`` differ in their schedule only, and need nothing beyond the compiled loop.
"""

from collections.abc import Mapping

from ..fmu.slave import Slave
from ..loop.buses import Buses
from ..loop.driver import Driver
from ..loop.exchange import ExchangeLoop


def driver_of(buses: Buses, slaves: Mapping[str, Slave]) -> Driver:
    """Return the way in which the system of a plan is carried out.

    Parameters
    ----------
    buses : Buses
        With the values after the initialisation, and the plan.
    slaves : mapping of str to Slave
        Initialised, by component.
    """
    return Driver(ExchangeLoop(buses, slaves))
