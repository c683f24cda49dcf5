"""Other ways to let two relays exchange their values, each in a process of its own.

Run as a script with tool and FMU file. Answers a line with a number of macro steps with the seconds
that they took and an output at their end. In each macro step both FMUs advance, all 150 outputs of
each are read, and 50 of them are set in the other. The file is both FMUs. An error ends the process
with the reason on stderr.
"""

import ctypes
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from importlib.metadata import files
from itertools import count
from typing import Any

INPUTS = 50
OUTPUTS = 150
STEP = 1e-3
"""Macro step (s)."""

Exchange = Callable[[int], float]
"""Carries out so many macro steps, and returns an output."""


def _slaves(file: str) -> Iterator[Any]:
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    description = read_model_description(file)
    for name in "ab":
        slave = FMU2Slave(
            instanceName=name,
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=extract(file),
        )
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        yield slave


def with_fmpy(file: str, _stack: ExitStack) -> Exchange:
    """Exchange with fmpy as in its documentation."""
    a, b = _slaves(file)
    times = count()
    given = list(range(INPUTS))
    shown = list(range(INPUTS, INPUTS + OUTPUTS))

    def run(steps: int) -> float:
        for n in (next(times) for _ in range(steps)):
            for slave in (a, b):
                slave.doStep(currentCommunicationPoint=n * STEP, communicationStepSize=STEP)
            from_a = a.getReal(shown)
            from_b = b.getReal(shown)
            a.setReal(given, from_b[:INPUTS])
            b.setReal(given, from_a[:INPUTS])
        return float(from_b[0])

    return run


def with_ctypes(file: str, _stack: ExitStack) -> Exchange:
    """Exchange in a bare loop that calls the C functions with arrays made before."""
    a, b = _slaves(file)
    times = count()
    given = (ctypes.c_uint * INPUTS)(*range(INPUTS))
    shown = (ctypes.c_uint * OUTPUTS)(*range(INPUTS, INPUTS + OUTPUTS))
    in_a, in_b = (ctypes.c_void_p(slave.component) for slave in (a, b))
    # an input's values begin the other's outputs
    from_a = (ctypes.c_double * OUTPUTS)()
    from_b = (ctypes.c_double * OUTPUTS)()
    few = ctypes.c_size_t(INPUTS)
    many = ctypes.c_size_t(OUTPUTS)
    # Python code inside needs that the interpreter is not let go
    library_a, library_b = (ctypes.PyDLL(None, handle=slave.dll._handle) for slave in (a, b))
    step_a = library_a.fmi2DoStep
    step_b = library_b.fmi2DoStep
    get_a = library_a.fmi2GetReal
    get_b = library_b.fmi2GetReal
    set_a = library_a.fmi2SetReal
    set_b = library_b.fmi2SetReal
    length = ctypes.c_double(STEP)

    def run(steps: int) -> float:
        worst = 0
        for n in (next(times) for _ in range(steps)):
            time_now = ctypes.c_double(n * STEP)
            worst |= step_a(in_a, time_now, length, 1)
            worst |= step_b(in_b, time_now, length, 1)
            worst |= get_a(in_a, shown, many, from_a)
            worst |= get_b(in_b, shown, many, from_b)
            worst |= set_a(in_a, given, few, from_b)
            worst |= set_b(in_b, given, few, from_a)
        if worst:
            raise RuntimeError("a call failed")
        return from_b[0]

    return run


def _connections() -> Iterator[tuple[str, str, int]]:
    for one, other in ("ab", "ba"):
        for i in range(INPUTS):
            yield one, other, i


def with_libcosim(file: str, _stack: ExitStack) -> Exchange:
    """Exchange with libcosim by its fixed-step algorithm."""
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_step_size(round(STEP * 1e9))
    slaves = {name: CosimLocalSlave(file, name) for name in "ab"}
    index = {name: execution.add_local_slave(slave) for name, slave in slaves.items()}
    for one, other, i in _connections():
        assert execution.connect_real_variables(index[one], INPUTS + i, index[other], i) == 0
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)

    def run(steps: int) -> float:
        assert execution.step(steps)
        return float(observer.last_real_values(index["b"], [INPUTS])[0])

    del CosimVariableType
    return run


def with_ecos(file: str, stack: ExitStack) -> Exchange:
    """Exchange with ecos by its fixed-step algorithm."""
    for part in files("tbb") or []:
        if part.name == "libtbb.so.12":
            ctypes.CDLL(str(part.locate()))
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = stack.enter_context(EcosSimulationStructure())
    for name in "ab":
        structure.add_model(name, file)
    for one, other, i in _connections():
        structure.make_real_connection(f"{one}::y[{i + 1}]", f"{other}::u[{i + 1}]")
    simulation = stack.enter_context(EcosSimulation(step_size=STEP, structure=structure))
    assert simulation.init()

    def run(steps: int) -> float:
        for _ in range(steps):
            simulation.step()
        return float(simulation.get_real("b::y[1]"))

    return run


TOOLS: Mapping[str, Callable[[str, ExitStack], Exchange]] = {
    "ctypes": with_ctypes,
    "fmpy": with_fmpy,
    "libcosim": with_libcosim,
    "ecos": with_ecos,
}


def main() -> None:
    """Answer lines until the input ends."""
    tool, file = sys.argv[1:]
    with ExitStack() as stack:
        run = TOOLS[tool](file, stack)
        for line in sys.stdin:
            begin = time.perf_counter()
            output = run(int(line))
            print(time.perf_counter() - begin, output, flush=True)


if __name__ == "__main__":
    main()
