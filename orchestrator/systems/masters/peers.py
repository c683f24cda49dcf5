"""Other tools that run an impact system, each as its documentation says.

Run as a script, ``run.py TOOL [step=S] JOB.json ANSWER.json ...``, by any Python that has the
tool. It needs nothing else: the job has everything. The answer has the times of the exchanges, the
values that were watched there, and the processor time of the steps (s), or the reason why there is
none.
"""

import argparse
import ctypes
import json
import shutil
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import files
from pathlib import Path
from typing import Any

JobData = Mapping[str, Any]
NamedPort = tuple[str, str]
ToolAnswer = dict[str, Any]


def answer(
    times: Sequence[float], series: Mapping[NamedPort, Sequence[float]], cpu: float
) -> ToolAnswer:
    """Return what a tool has computed."""
    values = {".".join(port): [float(v) for v in listed] for port, listed in series.items()}
    return {"times": [float(t) for t in times], "values": values, "cpu": cpu}


def watched(job: JobData) -> list[NamedPort]:
    """Return the outputs that are asked for."""
    return [(component, port) for component, port in job["watch"]]


def connections(job: JobData) -> list[tuple[NamedPort, NamedPort]]:
    """Return outputs and the inputs that they feed, element by element."""
    return [((a, b), (c, d)) for a, b, c, d in job["connections"]]


# ---------------------------------------------------------------------- fmpy


class FmpyInstance:
    """An FMU of either version with fmpy.

    Parameters
    ----------
    name, file : str
        Of the instance, and of the FMU.
    """

    def __init__(self, name: str, file: str) -> None:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        description = read_model_description(file)
        self.is_fmi_3 = description.fmiVersion.startswith("3")
        self.variables = {v.name: v for v in description.modelVariables}
        self.fmu = (FMU3Slave if self.is_fmi_3 else FMU2Slave)(
            instanceName=name,
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=extract(file),
        )
        self.fmu.instantiate()

    def _array(self, name: str) -> tuple[Any, int]:
        """Return the variable of a name, and the place of an element in it."""
        if name in self.variables:
            return self.variables[name], 0
        base, _, number = name.rstrip("]").rpartition("[")
        return self.variables[base], int(number) - 1

    def get(self, name: str) -> float:
        """Return the value of a real variable, or of an element of an array."""
        variable, place = self._array(name)
        if not self.is_fmi_3:
            return float(self.fmu.getReal([variable.valueReference])[0])
        count = max(1, variable_length(variable))
        return float(self.fmu.getFloat64([variable.valueReference], nValues=count)[place])

    def put(self, values: Mapping[str, Any]) -> None:
        """Set variables, arrays of FMI 3.0 as a whole."""
        whole: dict[str, list[float]] = {}
        for name, value in values.items():
            variable, place = self._array(name)
            count = max(1, variable_length(variable))
            if self.is_fmi_3 and variable.type == "Float64":
                if variable.name not in whole:
                    known = self.fmu.getFloat64([variable.valueReference], nValues=count)
                    whole[variable.name] = list(known)
                whole[variable.name][place] = value
            else:
                self._put(variable, value)
        for name, listed in whole.items():
            self.fmu.setFloat64([self.variables[name].valueReference], listed)

    def _put(self, variable: Any, value: Any) -> None:
        kind = variable.type
        if kind == "Real":
            self.fmu.setReal([variable.valueReference], [value])
        elif kind == "Boolean":
            self.fmu.setBoolean([variable.valueReference], [bool(value)])
        elif self.is_fmi_3:
            wide = "Int64" if kind == "Enumeration" else kind
            getattr(self.fmu, f"set{wide}")([variable.valueReference], [int(value)])
        else:
            self.fmu.setInteger([variable.valueReference], [int(value)])

    def begin(self) -> None:
        """Enter the initialisation mode at time 0."""
        if not self.is_fmi_3:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()

    def close(self) -> None:
        """Terminate and free the instance of the FMU."""
        self.fmu.terminate()
        self.fmu.freeInstance()


def variable_length(variable: Any) -> int:
    """Return the number of elements of a variable of FMI 3.0 with constant dimensions."""
    length = 1
    for dimension in getattr(variable, "dimensions", None) or []:
        length *= int(dimension.start if dimension.start is not None else dimension.variable.start)
    return length


def with_fmpy(job: JobData) -> ToolAnswer:
    """Let fmpy's slaves exchange at once after each step, each with its own step."""
    slaves = {name: FmpyInstance(name, file) for name, file in job["fmus"].items()}
    wires = connections(job)

    def transfer() -> None:
        found = [slaves[a].get(port) for (a, port), _ in wires]
        given: dict[str, dict[str, float]] = {}
        for (_, (component, port)), value in zip(wires, found, strict=True):
            given.setdefault(component, {})[port] = value
        for component, values in given.items():
            slaves[component].put(values)

    for name, slave in slaves.items():
        slave.put(job["starts"][name])
    for slave in slaves.values():
        slave.begin()
    for _ in slaves:
        transfer()
    for slave in slaves.values():
        slave.fmu.exitInitializationMode()
    transfer()
    step, exchanges = job["step"], job["exchanges"]
    parts = {name: round(step / job["steps"][name]) for name in slaves}
    ports = watched(job)
    rows = [[slaves[a].get(port) for a, port in ports]]
    begun = time.process_time()
    for n in range(exchanges):
        for name, slave in slaves.items():
            length = step / parts[name]
            for part in range(parts[name]):
                slave.fmu.doStep(n * step + part * length, length)
        transfer()
        rows.append([slaves[a].get(port) for a, port in ports])
    cpu = time.process_time() - begun
    for slave in slaves.values():
        slave.close()
    series = dict(zip(ports, zip(*rows, strict=True), strict=True))
    return answer([n * step for n in range(exchanges + 1)], series, cpu)


def with_fmpy_ssp(job: JobData) -> ToolAnswer:
    """Run the SSP by ``fmpy.ssp.simulation.simulate_ssp``; values are given as a parameter set.

    Its rows have the time of the beginning of their step: they are told by the end.
    """
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import Parameter, ParameterSet

    values = ParameterSet()
    values.parameters = []
    for component, starts in job["starts"].items():
        for name, value in starts.items():
            made = Parameter()
            made.name = f"{component}.{name}"
            made.value = value
            values.parameters.append(made)
    step, exchanges = job["step"], job["exchanges"]
    begun = time.process_time()
    found = simulate_ssp(
        job["ssp"], stop_time=(exchanges - 0.5) * step, step_size=step, parameter_set=values
    )
    cpu = time.process_time() - begun
    series = {port: found[".".join(port)] for port in watched(job)}
    return answer([(n + 1) * step for n in range(exchanges)], series, cpu)


# ---------------------------------------------------------------------- libcosim


def with_libcosim(job: JobData) -> ToolAnswer:
    """Run the SSP by libcosim's fixed-step algorithm, with its hints for the step of each FMU."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

    log_output_level(CosimLogLevel.ERROR)
    with zipfile.ZipFile(job["ssp"]) as archive:
        archive.extractall(job["work"])
    file = str(Path(job["work"]) / "MultiRate.ssd")
    return _stepped_by_libcosim(CosimExecution.from_ssp_file(ssp_path=file), job)


def _stepped_by_libcosim(execution: Any, job: JobData) -> ToolAnswer:
    """Step a system of libcosim and read what an observer has kept."""
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimObserver import CosimObserver

    per_exchange = round(job["step"] / min(job["steps"].values()))
    exchanges = job["exchanges"]
    steps = exchanges * per_exchange
    observer = CosimObserver.create_time_series(buffer_size=steps + 10)
    reference = {
        (slave.name.decode(), variable.name.decode()): (slave.index, variable.reference)
        for slave in execution.slave_infos()
        for variable in execution.slave_variables(slave.index)
    }
    if not execution.add_observer(observer):
        raise RuntimeError("libcosim takes no observer")
    for port in watched(job):
        observer.start_time_series(*reference[port], CosimVariableType.REAL)
    begun = time.process_time()
    if not execution.step(steps):
        raise RuntimeError("a step failed")
    cpu = time.process_time() - begun
    series = {}
    for port in watched(job):
        own = round(job["step"] / job["steps"][port[0]])
        found = observer.time_series_real_samples(*reference[port], 1, steps)[2]
        series[port] = found[own - 1 :: own][:exchanges]
    return answer([(n + 1) * job["step"] for n in range(exchanges)], series, cpu)


# ---------------------------------------------------------------------- ecos


def _load_tbb() -> None:
    """Load the library that ecos needs on Linux, where the package ``tbb`` has it."""
    for part in files("tbb") or []:
        if part.name == "libtbb.so.12":
            ctypes.CDLL(str(part.locate()))


def with_ecos(job: JobData) -> ToolAnswer:
    """Run the system by ecos, put together by its Python interface, a step hint for each FMU."""
    _load_tbb()
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        for name in job["order"]:
            structure.add_model(name, job["fmus"][name], job["steps"][name])
        for a, b, c, d in job["connections"]:
            structure.make_real_connection(f"{a}::{b}", f"{c}::{d}")
        values = {
            f"{component}::{name}": value
            for component, starts in job["starts"].items()
            for name, value in starts.items()
        }
        structure.add_parameter_set("start", values)
        finest = min(job["steps"].values())
        with EcosSimulation(step_size=finest, structure=structure) as simulation:
            return _stepped_by_ecos(simulation, job, "start")


def with_ecos_ssp(job: JobData) -> ToolAnswer:
    """Run the SSP with libcosim's hints by ecos, whose step is the shortest of them."""
    _load_tbb()
    from ecospy import EcosSimulation

    finest = min(job["steps"].values())
    with EcosSimulation(step_size=finest, ssp_path=job["multi_rate_ssp"]) as simulation:
        return _stepped_by_ecos(simulation, job, "initialValues")


def _stepped_by_ecos(simulation: Any, job: JobData, values: str) -> ToolAnswer:
    """Initialise and step a system of ecos."""
    if not simulation.init(parameter_set=values):
        raise RuntimeError("ecos could not initialise the system")
    per_exchange = round(job["step"] / min(job["steps"].values()))
    ports = ["::".join(port) for port in watched(job)]
    rows = [[simulation.get_real(port) for port in ports]]
    begun = time.process_time()
    for _ in range(job["exchanges"]):
        simulation.step(per_exchange)
        rows.append([simulation.get_real(port) for port in ports])
    cpu = time.process_time() - begun
    simulation.terminate()
    series = dict(zip(watched(job), zip(*rows, strict=True), strict=True))
    return answer([n * job["step"] for n in range(job["exchanges"] + 1)], series, cpu)


# ---------------------------------------------------------------------- FMU container


def with_container(job: JobData) -> ToolAnswer:
    """Put the system into one FMU with ``fmucontainer``, and run that with fmpy.

    Fmpy is that of the Python in ``job["fmpy"]``, as the toolbox does not need it.
    """
    folder = Path(job["work"])
    (folder / "container.json").write_text(json.dumps(_container(job)), encoding="utf-8")
    made = _said(
        [
            *(sys.executable, "-m", "fmu_manipulation_toolbox.cli.fmucontainer"),
            *("-fmi", job["fmi"][0], "-fmu-directory", str(folder)),
            *("-container", "container.json"),
        ]
    )
    file = folder / "container.fmu"
    if not file.is_file():
        raise RuntimeError(f"fmucontainer: {made[-300:]}")
    shown = [["container", f"shown.{a}.{b}"] for a, b in watched(job)]
    alone = {**job, "fmus": {"container": str(file)}, "starts": {"container": {}}}
    alone |= {"steps": {"container": job["step"]}, "connections": [], "watch": shown}
    (folder / "job.json").write_text(json.dumps(alone), encoding="utf-8")
    said = _said(
        [job["fmpy"], __file__, "fmpy", str(folder / "job.json"), str(folder / "answer.json")]
    )
    if not (folder / "answer.json").is_file():
        raise RuntimeError(said[-300:])
    found: ToolAnswer = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
    if "reason" in found:
        return found
    begin = "container.shown."
    found["values"] = {k.removeprefix(begin): v for k, v in found["values"].items()}
    return found


def _container(job: JobData) -> dict[str, Any]:
    """Return the description of a container."""
    names = {component: f"{component}.fmu" for component in job["fmus"]}
    return {
        "name": "container.fmu",
        "step_size": job["step"],
        "auto_link": False,
        "auto_input": False,
        "auto_output": False,
        "sequential": job["scheme"] == "sequential",
        "fmu": [names[component] for component in job["order"]],
        "path": {names[component]: file for component, file in job["fmus"].items()},
        "link": [[names[a], b, names[c], d] for a, b, c, d in job["whole_connections"]],
        "output": [[names[a], b, f"shown.{a}.{b}"] for a, b in watched(job)],
        "start": [
            [names[component], name, value]
            for component, starts in job["starts"].items()
            for name, value in starts.items()
        ],
    }


def _said(command: Sequence[str]) -> str:
    """Run a program and return what it has printed, without what is only for information."""
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = (ran.stdout + ran.stderr).splitlines()
    return " ".join(line.strip() for line in lines if not line.startswith("INFO"))


# ---------------------------------------------------------------------- CoFmuPy


def with_cofmupy(job: JobData) -> ToolAnswer:
    """Run the system by CoFmuPy's coordinator; inputs begin with the values that feed them.

    Its configuration can name start values of inputs, and nothing else would pass them on.
    """
    from cofmupy import Coordinator

    config = {
        "cosim_method": job["scheme"].removeprefix("iterative-").replace("-", "_"),
        "iterative": job["scheme"].startswith("iterative-"),
        "fmus": [
            {
                "id": component,
                "path": file,
                "initialization": {**job["starts"][component], **job["inputs"].get(component, {})},
            }
            for component, file in job["fmus"].items()
        ],
        "connections": [
            {
                "source": {"id": a, "variable": b, "unit": "", "type": "fmu"},
                "target": [{"id": c, "variable": d, "unit": "", "type": "fmu"}],
            }
            for a, b, c, d in job["connections"]
        ],
    }
    coordinator = Coordinator()
    coordinator.start(conf_path=config)
    begun = time.process_time()
    for _ in range(job["exchanges"]):
        coordinator.do_step(step_size=job["step"])
    cpu = time.process_time() - begun
    found = coordinator.get_results()
    series = {port: found[port] for port in watched(job)}
    return answer([(n + 1) * job["step"] for n in range(job["exchanges"])], series, cpu)


TOOLS: Mapping[str, Callable[[JobData], ToolAnswer]] = {
    "fmpy": with_fmpy,
    "fmpy-ssp": with_fmpy_ssp,
    "libcosim": with_libcosim,
    "ecos": with_ecos,
    "ecos-ssp": with_ecos_ssp,
    "container": with_container,
    "cofmupy": with_cofmupy,
}


SSP_TOOLS = ("fmpy-ssp", "libcosim", "ecos-ssp")
"""Tools that read an SSP, in which exchange steps are written down."""
STEP = "step="
"""Beginning of the word for another exchange step (s)."""
SAME = 1e-9
"""Two times are the same if they differ by less than this part."""


def read_job(file: Path, step: float | None = None) -> dict[str, Any]:
    """Return a job, of another exchange step (s) where one is given.

    Its files are relative to its folder. The steps of all FMUs change in the same ratio.
    """
    job: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    folder = file.resolve().parent
    job["fmus"] = {name: str(folder / fmu) for name, fmu in job["fmus"].items()}
    if missing := [fmu for fmu in job["fmus"].values() if not Path(fmu).is_file()]:
        raise ValueError(f"there is no {', no '.join(missing)}")
    for key in ("ssp", "multi_rate_ssp"):
        job[key] = str(folder / job.get(key, ""))
    if step is not None:
        stop = job["step"] * job["exchanges"]
        exchanges = round(stop / step) if 0.0 < step <= stop else 0
        if abs(exchanges * step - stop) > SAME * stop:
            raise ValueError(f"{step:g} s is no part of the {stop:g} s until the end")
        steps = {name: step * own / job["step"] for name, own in job["steps"].items()}
        job |= {"step": step, "exchanges": exchanges, "steps": steps}
    return {"scheme": "jacobi", "fmpy": sys.executable, "inputs": {}, **job}


def answer_of(tool: str, file: Path, work: Path, step: float | None) -> ToolAnswer:
    """Run a job, and return its answer or the reason why there is none."""
    try:
        if step is not None and tool in SSP_TOOLS:
            raise ValueError(f"{tool} reads its exchange step from the SSP")
        work.mkdir(exist_ok=True)
        return TOOLS[tool]({**read_job(file, step), "work": str(work)})
    except Exception as error:
        words = str(error).strip().splitlines() or [""]
        return {"reason": f"{type(error).__name__}: {words[-1]}"}
    finally:
        shutil.rmtree(work, ignore_errors=True)


def main() -> int:
    """Run some jobs one after the other, and return the exit code: 1 if one has no result."""
    parser = argparse.ArgumentParser(
        description="Run jobs of impact systems in a tool.",
        usage="run.py TOOL [step=S] JOB.json ANSWER.json ...",
    )
    parser.add_argument("tool", choices=TOOLS)
    parser.add_argument("files", nargs="+", metavar="JOB.json ANSWER.json")
    steps = [word.removeprefix(STEP) for word in sys.argv[1:] if word.startswith(STEP)]
    words = parser.parse_args([word for word in sys.argv[1:] if not word.startswith(STEP)])
    try:
        step = float(steps[-1]) if steps else None
    except ValueError:
        parser.error(f"{STEP}{steps[-1]}: is no number")
    if len(words.files) % 2:
        parser.error("each JOB.json needs an ANSWER.json behind it")
    code = 0
    for job, place in zip(words.files[::2], words.files[1::2], strict=True):
        found = answer_of(words.tool, Path(job), Path(f"{place}.parts"), step)
        if "reason" in found:
            print(f"{job}: {found['reason']}", file=sys.stderr)
            code = 1
        try:
            Path(place).write_text(json.dumps(found), encoding="utf-8")
        except OSError as error:
            parser.error(f"{place}: {error.strerror}")
    return code


if __name__ == "__main__":
    sys.exit(main())
