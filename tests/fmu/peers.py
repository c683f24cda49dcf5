"""Experiments inside our FMUs in other tools, from the manifest alone: ``python -m tests.fmu.peers``.

Each tool carries out all experiments of an FMU in a process of its own. libcosim and ecos take no
serialized state: there experiments begin with their parameters.
"""

import ctypes
import json
import re
import subprocess
import sys
import tempfile
import zipfile
from importlib.metadata import PackageNotFoundError, distribution, files
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
(RUNNER,) = re.findall(
    r"^```python\n(.*?)^```$",
    (ROOT / "docs" / "experiments.md").read_text(encoding="utf-8"),
    re.DOTALL | re.MULTILINE,
)
"""The program of the page, with fmpy alone."""
PACKAGES = {"fmpy": ("fmpy",), "libcosim": ("libcosimpy",), "ecos": ("ecospy", "tbb")}


def missing(tool):
    """Packages of a tool that are not installed."""

    def is_missing(name):
        try:
            distribution(name)
        except PackageNotFoundError:
            return True
        return False

    return [name for name in PACKAGES[tool] if is_missing(name)]


def runner():
    """The program's functions."""
    found = {"__name__": "runner"}
    arguments, sys.argv = sys.argv, sys.argv[:1]
    try:
        exec(compile(RUNNER, "docs/experiments.md", "exec"), found)
    finally:
        sys.argv = arguments
    return found


def _starts(model, start_values, stimuli):
    """Start values of parameters and inputs, as numbers and truths."""
    kinds = {v.name: v.type for v in model.modelVariables}
    texts = start_values | _inputs(stimuli, 0.0)
    make = {"Real": float, "Boolean": lambda text: str(text) in ("true", "1", "1.0")}
    return {name: make.get(kinds[name], int)(text) for name, text in texts.items()}


def _inputs(stimuli, time):
    if stimuli is None:
        return {}
    return {n: float(np.interp(time, stimuli["time"], stimuli[n])) for n in stimuli.dtype.names[1:]}


def with_integers(fmu, folder):
    """A copy of an FMU whose enumerations are integers, as both pass over enumerations."""
    copy = Path(folder) / Path(fmu).name
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(copy, "w") as target:
        for info in source.infolist():
            content = source.read(info)
            if info.filename == "modelDescription.xml":
                content = re.sub(rb'<Enumeration declaredType="[^"]*"', b"<Integer", content)
            target.writestr(info, content)
    return str(copy)


def libcosim(fmu, model, stop, step, start_values, stimuli, outputs, _state):
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    variables = {v.name: v for v in model.modelVariables}
    steps = round(stop / step)
    with tempfile.TemporaryDirectory() as folder:
        execution = CosimExecution.from_step_size(round(step * 1e9))
        slave = execution.add_local_slave(CosimLocalSlave(with_integers(fmu, folder), "fmu"))
        put = {float: "real_initial_value", int: "integer_initial_value"}
        for name, value in _starts(model, start_values, stimuli).items():
            function = getattr(execution, put.get(type(value), "boolean_initial_value"))
            if not function(slave, variables[name].valueReference, value):
                raise RuntimeError(f"libcosim does not set {name}")
        series, manipulator = CosimObserver.create_time_series(), CosimManipulator.create_override()
        assert execution.add_observer(series)
        assert execution.add_manipulator(manipulator)
        kinds = {n: "real" if variables[n].type == "Real" else "integer" for n in outputs}
        for name, kind in kinds.items():
            type_ = CosimVariableType.REAL if kind == "real" else CosimVariableType.INTEGER
            assert series.start_time_series(slave, variables[name].valueReference, type_)
        for number in range(steps):
            inputs = _inputs(stimuli, number * step)
            where = [variables[name].valueReference for name in inputs]
            if where:
                manipulator.slave_real_values(slave, where, list(inputs.values()))
            if not execution.step():
                raise RuntimeError("libcosim does not step")
        return {
            name: _samples(
                getattr(series, f"time_series_{kind}_samples"), slave, variables[name], steps
            )
            for name, kind in kinds.items()
        }


def _samples(read, slave, variable, steps):
    """Values at the start and after each step: asked for step 0, libcosimpy loses the last one."""
    first = read(slave, variable.valueReference, from_step=0, sample_count=2)[2][:1]
    rest = read(slave, variable.valueReference, from_step=1, sample_count=steps)[2]
    return np.array([*first, *rest], float)


def ecos(fmu, model, stop, step, start_values, stimuli, outputs, _state):
    for file in files("tbb"):
        if file.name == "libtbb.so.12":
            ctypes.CDLL(str(file.locate()))
    from ecospy import EcosSimulation, EcosSimulationStructure

    values = {f"fmu::{n}": v for n, v in _starts(model, start_values, stimuli).items()}
    kinds = {v.name: "real" if v.type == "Real" else "integer" for v in model.modelVariables}
    with EcosSimulationStructure() as structure, tempfile.TemporaryDirectory() as folder:
        structure.add_model("fmu", with_integers(fmu, folder))
        structure.add_parameter_set("start", values)
        with EcosSimulation(step_size=step, structure=structure) as simulation:
            read = [getattr(simulation, f"get_{kinds[name]}") for name in outputs]
            assert simulation.init(parameter_set="start")
            rows = [[get(f"fmu::{n}") for get, n in zip(read, outputs)]]
            for count in range(round(stop / step)):
                for name, value in _inputs(stimuli, count * step).items():
                    simulation.set_real(f"fmu::{name}", value)
                simulation.step()
                rows.append([get(f"fmu::{n}") for get, n in zip(read, outputs)])
            simulation.terminate()
    return {name: np.array([row[c] for row in rows], float) for c, name in enumerate(outputs)}


TOOLS = {"fmpy": None, "libcosim": libcosim, "ecos": ecos}


def shares(tool, fmu):
    """Of each experiment, the largest deviation over its tolerance, its output, or why there is none."""
    script = f"from tests.fmu.peers import in_this_process; in_this_process({tool!r}, {str(fmu)!r})"
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def in_this_process(tool, fmu):
    """Carry out all experiments of an FMU with a tool, and print the outcome."""
    found = runner()
    simulate = TOOLS[tool] or found["simulate"]

    def safely(*arguments):
        return simulate(*arguments)

    original = found["run"]

    def run(fmu, folder, experiment, simulate, states):
        try:
            return original(fmu, folder, experiment, safely, states)
        except Exception as error:  # whatever a tool says
            return float("inf"), f"{type(error).__name__}: {error}"

    found["run"] = run
    outcome = {
        name: (float(share) if np.isfinite(share) else None, output)
        for name, (share, output) in found["run_all"](fmu, safely).items()
    }
    print(json.dumps(outcome))


def main():
    """Print the table of the page: experiments within their tolerance, by component and tool."""
    from rockshed.components.catalogue import NAMES
    from rockshed.fmus.build import Fmi, Runtime, build

    print("| FMU | experiments | " + " | ".join(TOOLS) + " | fmpy, FMI 3.0 |")
    print("|---|---|" + "---|" * (len(TOOLS) + 1))
    with tempfile.TemporaryDirectory() as folder:
        for name in NAMES:
            two, three = (
                build(name, destination=Path(folder, str(fmi)), runtime=Runtime.NATIVE, fmi=fmi)
                for fmi in Fmi
            )
            outcomes = [shares(tool, two) for tool in TOOLS] + [shares("fmpy", three)]
            passed = [sum(v is not None and v <= 1.0 for v, _ in o.values()) for o in outcomes]
            print(f"| {name} | {len(outcomes[0])} | " + " | ".join(map(str, passed)) + " |")


if __name__ == "__main__":
    main()
