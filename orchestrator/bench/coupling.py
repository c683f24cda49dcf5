"""Price of the coupling: the laboratory impact as FMUs against the same physics as one program.

Times are those of the processor: both run on one thread, and others use the machine too.
"""

from collections.abc import Mapping
from time import thread_time

from rockshed.fmus.build import BuildError, Runtime, build_if_needed
from rockshed.fmus.native.fmu import CPU

from ..cases.sonoda1993 import lab_system, tests
from ..core.run import simulate
from ..core.system.system import SystemSpec
from ..temporary import TemporaryFolder
from .interleave import Contestant
from .monolithic import from_system
from .peer import Peer

END = 0.02
"""Simulated time (s)."""


def lab(coupling: str, runtime: Runtime = Runtime.PYTHON) -> SystemSpec:
    """Return test 4 of the laboratory for 20 ms.

    Rows of results every 0.1 ms as usual, but no states for pictures, which the one program has
    not either.

    Parameters
    ----------
    coupling : str
        Scheme of exchange.
    runtime : Runtime
        Of the FMUs.
    """
    names = {"rock": "FallingRock", "sand": "SandCushion", "beam": "RBSMBeam"}
    fmus = {key: str(build_if_needed(name, runtime=runtime)) for key, name in names.items()}
    system = lab_system(fmus, tests()[4], coupling)
    components = {
        name: spec.model_copy(update={"record_states": False})
        for name, spec in system.components.items()
    }
    return system.model_copy(
        update={"components": components, "stop_time": END, "state_interval": None}
    )


def one_program() -> Contestant:
    """Return the monolithic program as a contestant, without its preparation."""
    system = lab("paper")

    def work() -> float:
        program = from_system(system, END)
        begin = thread_time()
        program.run()
        return thread_time() - begin

    return work


def co_simulation(coupling: str, runtime: Runtime = Runtime.PYTHON) -> Contestant:
    """Return the exchanges of a co-simulation as a contestant.

    Rows of results in memory count; its preparation and writing files do not.

    Parameters
    ----------
    coupling : str
        Scheme of exchange.
    runtime : Runtime
        Of the FMUs.
    """
    system = lab(coupling, runtime)

    def work() -> float:
        with TemporaryFolder() as folder:
            run = simulate(system, folder / "run")
        return float(run.provenance["cpu_time"]["exchanges"])

    return work


BASELINE = ("-m", f"{__package__}.monolithic_peer")
AS_NATIVE = {"NUMBA_CPU_NAME": CPU.name, "NUMBA_CPU_FEATURES": ""}
"""The one program as a :class:`~.peer.Peer`, compiled for the processor of native FMUs."""


def contestants(baseline: Peer) -> Mapping[str, Contestant]:
    """Return the one program, and the co-simulation with both exchange steps and runtimes.

    Parameters
    ----------
    baseline : Peer
        The one program for the processor of native FMUs.

    Returns
    -------
    mapping of str to Contestant
        Native FMUs are among them only where there is a compiler.
    """
    common = {
        "one program": one_program(),
        "paper": co_simulation("paper"),
        "impulse": co_simulation("impulse"),
    }
    try:
        return {
            **common,
            "one program, baseline": baseline.contestant(""),
            "paper, native": co_simulation("paper", runtime=Runtime.NATIVE),
            "impulse, native": co_simulation("impulse", runtime=Runtime.NATIVE),
        }
    except BuildError:
        return common
