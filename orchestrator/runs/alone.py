"""One FMU alone, with its inputs from a table: a system of two components."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from ..core.errors import InputRefused, Problem, all_causes
from ..core.fmu.description import Description, Port
from ..core.fmu.fmu_slave import FmuFile, UnusableError, read_description
from ..core.system.fields import RESERVED, Value
from ..core.system.names import nearest, select
from ..core.system.reading import system_from
from ..core.system.signals import Signals, signals_of
from .job import Job
from .signals import SignalSource, read_signals
from .system import System
from .values_in_si import value_of_port

INPUT = "input"
"""Component whose outputs are the columns of the table."""
_STEPS = 500
"""Steps into which an experiment is divided whose step is told nowhere."""


@dataclass(frozen=True)
class _Fmu:
    """An FMU that is to run alone.

    Attributes
    ----------
    path : Path
        The file.
    description : Description
        What it has.
    held : frozenset of str
        Inputs that are not continuous: their values are held between two rows.
    experiment : mapping of str to float
        The DefaultExperiment: startTime, stopTime, stepSize (s), as far as they are told.
    """

    path: Path
    description: Description
    held: frozenset[str]
    experiment: Mapping[str, float]

    @property
    def name(self) -> str:
        """Name of the component in the system."""
        name = re.sub(r"\W", "_", self.description.model, flags=re.ASCII) or "model"
        name = f"_{name}" if name[0].isdigit() else name
        return f"{name}_" if name in (*RESERVED, INPUT) else name


def alone(
    fmu: str | Path,
    inputs: str | Path | Mapping[str, Sequence[float]] | None = None,
    *,
    start_time: float | None = None,
    stop_time: float | None = None,
    step_size: float | None = None,
    output_interval: float | None = None,
    start_values: Mapping[str, Value] | None = None,
    output_variables: Sequence[str] = (),
    tolerance: float | None = None,
) -> System:
    """Return a system of one FMU whose inputs follow a table.

    Between two rows the values of continuous inputs are interpolated linearly, those of all others
    are held; the FMU gets them at the begin of each of its steps. The same time twice is a jump.

    Parameters
    ----------
    fmu : str or Path
        The file, of any origin.
    inputs : str, Path or mapping, optional
        A CSV file with the column ``time`` (s) and one for each input, in the unit of the input; or
        the columns by name. Without it, inputs keep their start values.
    start_time, stop_time : float, optional
        Times (s), by default those of the FMU's DefaultExperiment; the last time of the table where
        it has no end.
    step_size : float, optional
        Communication step (s), by default that of the DefaultExperiment, or the output interval.
    output_interval : float, optional
        Time between two rows of the results (s), by default the step.
    start_values : mapping of str to Value, optional
        Parameters and inputs by name that differ from their start values: numbers in the unit of
        the variable, or texts with a unit of their own.
    output_variables : sequence of str
        Variables that are recorded, by default all outputs; ``*`` stands for any text.
    tolerance : float, optional
        Relative tolerance of the FMU's solver.

    Returns
    -------
    System
        To be run by :func:`rockshed.simulate`. The FMU is called like its model, the table
        ``input``.

    Raises
    ------
    InputRefused
        Everything that is wrong with FMU, table and values.

    Examples
    --------
    >>> import rockshed
    >>> fmu = rockshed.build_fmu("FallingRock", folder="fmus")
    >>> push = {"time": [0.0, 0.1], "force.x": [0.0, 50.0]}  # N, rising
    >>> system = rockshed.alone(fmu, push, stop_time=0.1, step_size=0.001)
    >>> run = rockshed.simulate(system)
    >>> round(float(run["input.force.x"][-1]), 3)
    50.0
    """
    with all_causes(lambda: inputs is None or _signals(inputs)):
        of_fmu = _read(Path(fmu))
        table = None if inputs is None else _signals(inputs)
    problems = [*_column_problems(of_fmu, table, inputs)]
    problems += _name_problems(of_fmu, start_values or {}, output_variables)
    values = _in_si(of_fmu, start_values or {}, problems)
    times = {"start_time": start_time, "stop_time": stop_time}
    steps = {"exchange_step": step_size, "output_interval": output_interval}
    chosen = _times(of_fmu, table, times, steps)
    if "stop_time" not in chosen:
        what = "nobody tells an end: the FMU has no DefaultExperiment, and there is no table"
        problems.append(Problem("stop_time", what, "give stop_time=... (s)"))
    if problems:
        raise InputRefused(problems)
    data = {
        "name": of_fmu.name,
        "description": of_fmu.description.model,
        "master": "jacobi",
        **chosen,
        **({} if tolerance is None else {"tolerance": tolerance}),
    }
    return _system(of_fmu, table, data, values, output_variables)


def _system(
    of_fmu: _Fmu,
    table: Signals | None,
    data: Mapping[str, Any],
    values: Mapping[str, Value],
    recorded: Sequence[str],
) -> System:
    name = of_fmu.name
    components: dict[str, Any] = {name: {"fmu": str(of_fmu.path), "parameters": dict(values)}}
    sources: dict[str, Any] = {}
    connections: list[str] = []
    if table is not None:
        ports = [of_fmu.description.ports[column] for column in table.columns]
        sources[INPUT] = SignalSource(table, ports, of_fmu.held, {INPUT: "table"})
        components[INPUT] = {"fmu": "table of inputs"}
        connections = [f"{INPUT}.{port.name} -> {name}.{port.name}" for port in ports]
    record = {"record": [f"{name}.{variable}" for variable in recorded]} if recorded else {}
    spec = system_from(
        {**data, **record, "components": components, "connections": connections}, name
    )
    return System(Job(spec.name, spec, sources, {"fmu_file": str(of_fmu.path)}))


# ---------------------------------------------------------------- what there is


def _read(path: Path) -> _Fmu:
    xml = FmuFile(path).model_description()
    try:
        description = read_description(xml)
    except UnusableError as error:
        raise InputRefused([Problem(str(path), str(error), error.remedy)]) from error
    root = ElementTree.fromstring(xml)
    held = frozenset(port.name for port in description.named("input") if port.is_held)
    return _Fmu(path, description, held, dict(_experiment(root)))


def _experiment(root: ElementTree.Element) -> Iterator[tuple[str, float]]:
    """Yield the finite numbers of the DefaultExperiment."""
    found = root.find("DefaultExperiment")
    for name, text in () if found is None else found.items():
        try:
            value = float(text)
        except ValueError:
            continue
        if math.isfinite(value):
            yield name, value


def _signals(inputs: str | Path | Mapping[str, Sequence[float]]) -> Signals:
    if isinstance(inputs, str | Path):
        return read_signals(Path(inputs))
    return signals_of(inputs, "inputs")


# ---------------------------------------------------------------- what is asked


def _column_problems(of_fmu: _Fmu, table: Signals | None, inputs: Any) -> Iterator[Problem]:
    """Refuse columns that are no inputs, or inputs whose values are no numbers."""
    where = str(inputs) if isinstance(inputs, str | Path) else "inputs"
    ports = of_fmu.description.ports
    known = [port.name for port in of_fmu.description.named("input")]
    for name in table.columns if table else ():
        if name not in ports:
            yield Problem(f"{where}: {name}", "is no variable of the FMU", nearest(name, known))
        elif ports[name].causality != "input":
            what = f"is no input of the FMU, but of the causality {ports[name].causality}"
            yield Problem(f"{where}: {name}", what, nearest(name, known))
        elif not ports[name].is_number:
            what = f"is of the type {ports[name].kind}, and a table has numbers"
            yield Problem(f"{where}: {name}", what, "leave it out")


def _name_problems(
    of_fmu: _Fmu, values: Mapping[str, Value], recorded: Sequence[str]
) -> Iterator[Problem]:
    """Refuse names that no variable has, before the system writes its own in front of them."""
    ports: Mapping[str, Port] = of_fmu.description.ports
    for name in values:
        if not select(name, list(ports)):
            yield Problem(f"start_values {name}", "is no variable of the FMU", nearest(name, ports))
    for name in recorded:
        if not select(name, list(ports)):
            what = "is no variable of the FMU"
            yield Problem(f"output_variables {name}", what, nearest(name, ports))


def _in_si(of_fmu: _Fmu, values: Mapping[str, Value], problems: list[Problem]) -> dict[str, Value]:
    """Return start values in the units of their variables; one of another kind is a problem."""
    kept: dict[str, Value] = {}
    for name, value in values.items():
        found = select(name, list(of_fmu.description.ports))
        port = of_fmu.description.ports[found[0]] if found else None
        try:
            kept[name] = value_of_port(port, value)
        except ValueError as error:
            problems.append(Problem(f"start_values {name}", str(error)))
    return kept


def _times(
    of_fmu: _Fmu,
    table: Signals | None,
    times: Mapping[str, float | None],
    steps: Mapping[str, float | None],
) -> dict[str, float]:
    """Return times and steps (s): those that are asked for, or what FMU and table tell."""
    found = {name: value for name, value in {**times, **steps}.items() if value is not None}
    told = of_fmu.experiment
    found.setdefault("start_time", told.get("startTime", 0.0))
    if "stopTime" in told:
        found.setdefault("stop_time", told["stopTime"])
    elif table is not None:
        found.setdefault("stop_time", float(table.time[-1]))
    if "stepSize" in told:
        found.setdefault("exchange_step", told["stepSize"])
    elif "output_interval" in found:
        found.setdefault("exchange_step", found["output_interval"])
    elif "stop_time" in found:
        length = found["stop_time"] - found["start_time"]
        found.setdefault("exchange_step", length / _STEPS)
    return found
