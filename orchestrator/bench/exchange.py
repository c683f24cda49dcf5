"""Price of a macro step in our loop and in other tools.

Two relays have 50 inputs and 150 outputs each.
"""

import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

from rockshed.fmus.build import Runtime, build_component

from ..core.loop.buses import Buses
from ..core.loop.exchange import ExchangeLoop
from ..core.loop.initialisation import free, initialise, instantiate
from ..core.run import sources_of
from ..core.system.planning import make_plan
from ..core.system.reading import system_from
from ..core.system.system import SystemSpec
from ..temporary import TemporaryFolder
from ..versions import version_of
from .exchange_peer import INPUTS, STEP
from .interleave import Contestant
from .pair import COMPONENT as RELAY

OURS = "our loop"
BARE = "ctypes"
"""Names of contestants: this program's loop, and a bare loop of calls."""
PEERS: Mapping[str, str] = {
    BARE: "fmpy",
    "fmpy": "fmpy",
    "libcosim": "libcosimpy",
    "ecos": "ecospy",
}
"""Other tools by the names of :mod:`rockshed.bench.exchange_peer`, and the package of each."""
_STEPS = {Runtime.NATIVE: 10_000, Runtime.PYTHON: 1000}
"""Macro steps of one measurement."""
_AT_ONCE = 1000
_SETTLED = 2.0
"""Outputs of both relays in the end if they are connected: half of it and one is the same again."""


class Pair:
    """The two relays of a runtime in every tool. A context manager.

    Parameters
    ----------
    runtime : Runtime
        Of the FMUs.
    measurements : int
        How often our loop may be measured.

    Attributes
    ----------
    contestants : dict of str to Contestant
        Those that there are.
    missing : dict of str to str
        Tools that are not among them, and why.
    steps : int
        Macro steps of one measurement.

    Raises
    ------
    BuildError
        The FMU cannot be built.
    """

    def __init__(self, runtime: Runtime, measurements: int) -> None:
        self._stack = ExitStack()
        folder = self._stack.enter_context(TemporaryFolder())
        self.steps = _STEPS[runtime]
        self._file = build_component(RELAY, destination=folder, runtime=runtime)
        self.contestants: dict[str, Contestant] = {OURS: self._own_loop(measurements)}
        self.missing: dict[str, str] = {}
        for tool, package in PEERS.items():
            try:
                self.contestants[tool] = self._peer(tool, package)
            except _MissingError as reason:
                self.missing[tool] = str(reason)

    def __enter__(self) -> "Pair":
        return self

    def __exit__(self, *_error: object) -> None:
        self._stack.close()

    def _own_loop(self, measurements: int) -> Contestant:
        """Return our loop as a contestant.

        All outputs are recorded in every macro step; writing them to files does not count.
        """
        system = self._system(measurements)
        sources = sources_of(system)
        plan = make_plan(system, sources)
        slaves = instantiate(plan, sources)
        self._stack.callback(free, slaves.values())
        buses = Buses(plan)
        initialise(slaves, buses)
        buses.open_accounts()
        loop = ExchangeLoop(buses, slaves)
        begun = 0

        def work() -> float:
            nonlocal begun
            took = 0.0
            for _ in range(self.steps // _AT_ONCE):
                begin = time.perf_counter()
                fault = loop.advance(begun, _AT_ONCE)
                took += time.perf_counter() - begin
                assert fault is None, fault
                begun += _AT_ONCE
            assert buses.outputs[0] == _SETTLED
            return took

        return work

    def _system(self, measurements: int) -> SystemSpec:
        wires = [f"{one}.y[1..{INPUTS}] -> {other}.u[1..{INPUTS}]" for one, other in ("ab", "ba")]
        return system_from(
            {
                "name": "pair",
                "components": {name: {"fmu": str(self._file)} for name in "ab"},
                "master": "jacobi",
                "connections": wires,
                "exchange_step": STEP,
                "stop_time": measurements * self.steps * STEP,
            }
        )

    def _peer(self, tool: str, package: str) -> Contestant:
        if version_of(package) is None:
            raise _MissingError("not installed")
        script = str(Path(__file__).with_name("exchange_peer.py"))
        process = subprocess.Popen(
            [sys.executable, script, tool, str(self._file)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self._stack.callback(_end, process)

        def work() -> float:
            seconds, output = _ask(process, self.steps)
            if abs(output - _SETTLED) > 1e-12:
                raise _MissingError(f"does not connect them: {output} instead of {_SETTLED}")
            return seconds

        work()
        return work


def _ask(process: "subprocess.Popen[str]", steps: int) -> tuple[float, float]:
    """Let a tool carry out so many macro steps; return its time (s) and an output."""
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(f"{steps}\n")
        process.stdin.flush()
        seconds, output = map(float, process.stdout.readline().split())
    except (OSError, ValueError):
        raise _MissingError(_last_words(process)) from None
    return seconds, output


class _MissingError(Exception):
    """A tool that cannot take part, and why."""


def _end(process: "subprocess.Popen[str]") -> None:
    process.kill()
    process.communicate()


def _last_words(process: "subprocess.Popen[str]") -> str:
    process.kill()
    said = process.communicate()[1].strip().splitlines() or [f"exit code {process.returncode}"]
    return f"failed: {said[-1]}"
