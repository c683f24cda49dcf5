"""Ways of carrying out the exchanges of a run, which the plan of a system chooses.

A way is a :class:`~rockshed.core.loop.driver.Driver`. The explicit masters ``sequential`` and
``jacobi`` differ in their schedule only, and need nothing beyond the compiled loop; ``implicit`` is
:class:`~rockshed.core.masters.implicit.Implicit`.
"""

from collections.abc import Mapping

from ..fmu.slave import Slave
from ..loop.buses import Buses
from ..loop.driver import Driver
from ..loop.exchange import ExchangeLoop
from .adaptive import DoublingDriver, LedgerDriver
from .implicit import Implicit


def driver_of(buses: Buses, slaves: Mapping[str, Slave]) -> Driver:
    """Return the way in which the system of a plan is carried out.

    Parameters
    ----------
    buses : Buses
        With the values after the initialisation, and the plan.
    slaves : mapping of str to Slave
        Initialised, by component.

    Raises
    ------
    InputRefused
        Components that the way asks too much of, by name.
    """
    if buses.plan.iteration is not None:
        return Implicit(buses, slaves)
    loop = ExchangeLoop(buses, slaves)
    adaptive = buses.plan.system.adaptive
    if adaptive is not None:
        kinds = {"doubling": DoublingDriver, "ledger": LedgerDriver}
        return kinds[adaptive.control](loop, buses, slaves)
    return Driver(loop)
