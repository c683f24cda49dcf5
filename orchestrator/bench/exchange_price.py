"""Price of an exchange in this program's own loop: of its accounts and rows, and of its FMUs' FMI.

FMUs are native. Times are those of the processor, on one thread; rows come together in memory, and
writing them to files does not count.
"""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.fmus.build import Fmi, Runtime, build_component

from ..core.loop.buses import Buses
from ..core.loop.exchange import ExchangeLoop
from ..core.loop.initialisation import free, initialise, instantiate
from ..core.loop.ledger import Accounts
from ..core.loop.recording import Recorder
from ..core.masters import driver_of
from ..core.run import sources_of
from ..core.system.planning import make_plan
from ..core.system.reading import system_from
from ..core.system.system import SystemSpec
from ..temporary import TemporaryFolder
from .bonded import COMPONENT as BONDED
from .coupling import END, lab
from .exchange_peer import STEP
from .interleave import Contestant
from .pair import COMPONENT as RELAY

BARE, LEDGER, KEPT = "without either", "ledger", "ledger and rows"
"""Names of contestants: nothing is accounted for or recorded; bonds are accounted for; all outputs
are recorded too."""
ARRAYS, SCALARS = "arrays of FMI 3.0", "scalars of FMI 2.0"
"""Names of contestants: the version of FMI in which values are exchanged."""
VALUES = 288
"""Values that an exchange of :func:`versions_of_fmi` moves, half of them each way."""
CHANNELS = BONDED.sizes["channels"].default
"""Forces of each of the two bonds of :func:`accounts_of_relays`."""
EXCHANGES = 10_000
"""Exchanges of one measurement of relays."""
_AT_ONCE = 1000


@contextmanager
def accounts_of_relays(measurements: int) -> Iterator[Mapping[str, Contestant]]:
    """Open two relays all of whose values belong to bonds: bare, with ledger, with a row each time.

    Parameters
    ----------
    measurements : int
        How often each contestant may be measured.

    Raises
    ------
    BuildError
        There is no compiler.
    """
    forces, ways = ([f"{of}[{i + 1}]" for i in range(CHANNELS)] for of in ("spring", "way"))
    bonds = {
        giver + taker: {"giver": giver, "force": forces, "taker": taker, "position": ways}
        for giver, taker in ("ab", "ba")
    }
    wires = [f"{one}.spring -> {other}.force" for one, other in ("ab", "ba")]
    wires += [f"{one}.way -> {other}.position" for one, other in ("ab", "ba")]
    rows = {"output_interval": STEP, "record": ["a.*", "b.*"]}
    with ExitStack() as opened:
        folder = opened.enter_context(TemporaryFolder())
        file = build_component(BONDED, destination=folder, runtime=Runtime.NATIVE)
        settings: dict[str, dict[str, Any]]
        settings = {BARE: {}, LEDGER: {"bonds": bonds}, KEPT: {"bonds": bonds, **rows}}
        yield {
            name: _part_of(opened.enter_context(_begun(_pair(file, wires, measurements, **more))))
            for name, more in settings.items()
        }


@contextmanager
def versions_of_fmi(measurements: int) -> Iterator[Mapping[str, Contestant]]:
    """Open two relays that exchange arrays of FMI 3.0, or scalars of FMI 2.0, and record nothing.

    Parameters
    ----------
    measurements : int
        How often each contestant may be measured.

    Raises
    ------
    BuildError
        There is no compiler.
    """
    sizes = {"inputs": VALUES // 2, "outputs": VALUES // 2}
    wires = [f"{one}.y -> {other}.u" for one, other in ("ab", "ba")]
    with ExitStack() as opened:
        folder = opened.enter_context(TemporaryFolder())
        contestants = {}
        for name, fmi in ((ARRAYS, Fmi.THREE), (SCALARS, Fmi.TWO)):
            place = folder / fmi.name
            file = build_component(RELAY, sizes, place, runtime=Runtime.NATIVE, fmi=fmi)
            begun = _begun(_pair(file, wires, measurements))
            contestants[name] = _part_of(opened.enter_context(begun))
        yield contestants


def accounts_of_impact() -> Mapping[str, Contestant]:
    """Return the laboratory impact with its ledger and rows as usual, and without.

    Raises
    ------
    BuildError
        There is no compiler.
    """
    system = lab("paper", Runtime.NATIVE)
    nothing = {"bonds": {}, "record": [], "output_interval": END}
    return {KEPT: _whole(system), BARE: _whole(system.model_copy(update=nothing))}


def _pair(file: Path, wires: list[str], measurements: int, **more: Any) -> SystemSpec:
    """Return two instances of an FMU; only the last row is recorded, unless something else is."""
    end = measurements * EXCHANGES * STEP
    return system_from(
        {
            "name": "pair",
            "components": {name: {"fmu": str(file)} for name in "ab"},
            "master": "jacobi",
            "connections": wires,
            "exchange_step": STEP,
            "stop_time": end,
            **{"output_interval": end, "record": [], **more},
        }
    )


class _Begun:
    """A system that has been initialised, whose exchanges are carried out part by part."""

    def __init__(self, buses: Buses, loop: ExchangeLoop, recorder: Recorder) -> None:
        self._snapshots, self._loop, self._recorder = buses.snapshots, loop, recorder
        self.exchanges = buses.plan.timing.exchanges
        self._done = 0

    def advance(self, count: int) -> float:
        """Carry out more exchanges, and return the processor time (s)."""
        began = thread_time()
        last = self._done + count
        while self._done < last:
            portion = min(_AT_ONCE, last - self._done, self._snapshots.room)
            fault = self._loop.advance(self._done, portion)
            assert fault is None, fault
            due = self._snapshots.due(self._done, self._done + portion)
            self._snapshots.waiting.extend(due)
            self._recorder.flush()
            self._done += portion
        return thread_time() - began


class _Nowhere:
    """Takes rows and frames, and keeps none."""

    def rows(self, times: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        """Pass over rows, which have been put together and are not written."""

    def frame(self, component: str, at: float, state: bytes) -> None:
        """Pass over a state, which no contestant records."""


@contextmanager
def _begun(system: SystemSpec) -> Iterator[_Begun]:
    """Open a system, as a run does."""
    sources = sources_of(system)
    plan = make_plan(system, sources)
    slaves = instantiate(plan, sources)
    try:
        buses = Buses(plan)
        initialise(slaves, buses)
        accounts = Accounts(slaves, buses)
        driver = driver_of(buses, slaves)
        buses.open_accounts()
        recorder = Recorder(slaves, buses.snapshots, accounts, _Nowhere(), driver)
        yield _Begun(buses, driver.loop, recorder)
    finally:
        free(slaves.values())


def _part_of(begun: _Begun) -> Contestant:
    """Return the next exchanges of relays as a contestant."""
    return lambda: begun.advance(EXCHANGES)


def _whole(system: SystemSpec) -> Contestant:
    """Return all exchanges of a system as a contestant, without its preparation."""

    def work() -> float:
        with _begun(system) as begun:
            return begun.advance(begun.exchanges)

    return work
