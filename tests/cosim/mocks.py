"""Slaves made of a few lines of Python, for tests of everything that needs no FMU file."""

import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

_UNITS = {
    "N": "kg='1' m='1' s='-2'",
    "m": "m='1'",
    "kN": "kg='1' m='1' s='-2' factor='1000'",
    "J": "kg='1' m='2' s='-2'",
    "s": "s='1'",
    "kg": "kg='1'",
    "m/s": "m='1' s='-1'",
    "N/m": "kg='1' s='-2'",
    "K": "K='1'",
    "degC": "K='1' offset='273.15'",
    "mm": "m='1' factor='0.001'",
}

Values = dict[str, float]


@dataclass(frozen=True)
class Port:
    name: str
    causality: str
    start: float = 0.0
    unit: str = ""
    kind: str = "Real"
    extra: str = ""
    formerly: str = ""
    role: str = ""

    def xml(self, reference: int) -> str:
        start = (
            ""
            if self.causality == "output"
            else f"start='{self.start if self.kind == 'Real' else int(self.start)}'"
        )
        variability = {"parameter": "fixed"}.get(
            self.causality, "continuous" if self.kind == "Real" else "discrete"
        )
        unit = f"unit={quoteattr(self.unit)}" if self.unit else ""
        told = f"role={quoteattr(self.role)} formerly={quoteattr(self.formerly)}"
        annotation = (
            f"<Annotations><Tool name='org.rockshed'><Variable {told}/></Tool></Annotations>"
        )
        return (
            f"<ScalarVariable name={quoteattr(self.name)} valueReference='{reference}' causality='{self.causality}' "
            f"variability='{variability}'><{self.kind} {start} {unit} {self.extra}/>"
            f"{annotation if self.formerly or self.role else ''}</ScalarVariable>"
        )


def inp(name: str, unit: str = "", start: float = 0.0, **rest: Any) -> Port:
    return Port(name, "input", start, unit, **rest)


def out(name: str, unit: str = "", **rest: Any) -> Port:
    return Port(name, "output", 0.0, unit, **rest)


def par(name: str, start: float, unit: str = "", **rest: Any) -> Port:
    return Port(name, "parameter", start, unit, **rest)


@dataclass
class Mock:
    """A source: step(values, time, step) advances; start(values) is called when the outputs at the start are wanted.

    Either may return a (status, text) to log and return. Calls are noted in ``calls``. ``units`` are those that mean
    something else than elsewhere.
    """

    ports: list[Port]
    step: Callable[[Values, float, float], Any] = lambda v, t, h: None
    start: Callable[[Values], Any] = lambda v: None
    once: bool = False
    serializes: bool = True
    varies: bool = True
    types: str = ""
    units: Mapping[str, str] = field(default_factory=dict)
    origin: dict[str, str] = field(default_factory=lambda: {"mock": "yes"})
    calls: list[tuple[Any, ...]] = field(default_factory=list)

    def model_description(self) -> bytes:
        meanings = {**_UNITS, **self.units}
        used = sorted({port.unit for port in self.ports} & set(meanings))
        units = "".join(
            f"<Unit name={quoteattr(unit)}><BaseUnit {meanings[unit]}/></Unit>" for unit in used
        )
        variables = "".join(port.xml(i) for i, port in enumerate(self.ports))
        outputs = "".join(
            f"<Unknown index='{i + 1}'/>"
            for i, p in enumerate(self.ports)
            if p.causality == "output"
        )
        flag = str(self.serializes).lower()
        return f"""<?xml version='1.0'?><fmiModelDescription fmiVersion='2.0' modelName='Mock' guid='mock-guid'>
            <CoSimulation modelIdentifier='Mock' canGetAndSetFMUstate='{flag}' canSerializeFMUstate='{flag}'
             canHandleVariableCommunicationStepSize='{str(self.varies).lower()}'
             canBeInstantiatedOnlyOncePerProcess='{str(self.once).lower()}'/>
            {f"<UnitDefinitions>{units}</UnitDefinitions>" if units else ""}{self.types}
            <ModelVariables>{variables}</ModelVariables>
            <ModelStructure>{f"<Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}</InitialUnknowns>" if outputs else ""}
            </ModelStructure></fmiModelDescription>""".encode()

    def instantiate(self, name: str) -> "MockSlave":
        return MockSlave(self, name)


class MockSlave:
    addresses = None

    def __init__(self, mock: Mock, name: str) -> None:
        self.name, self.mock, self.messages = name, mock, []
        self.names = [port.name for port in mock.ports]
        self.values: Values = {port.name: port.start for port in mock.ports}
        self.running = False

    def set(self, references, values, kind="Real") -> int:
        for reference, value in zip(references, values):
            self.values[self.names[reference]] = float(value)
        self.mock.calls.append(("set", self.name, *(self.names[r] for r in references)))
        return 0 if self.running else self._said(self.mock.start(self.values))

    def get(self, references, out, kind="Real") -> int:
        out[:] = [self.values[self.names[reference]] for reference in references]
        return 0

    def set_text(self, reference, text) -> int:
        self.values[self.names[reference]] = text
        return 0

    def set_texts(self, reference, texts) -> int:
        return self.set_text(reference, texts[0])

    def get_texts(self, reference, count) -> tuple[int, list[str]]:
        return 0, [str(self.values[self.names[reference]])]

    def setup_experiment(self, start, stop, tolerance=None) -> int:
        return 0

    def enter_initialisation(self) -> int:
        return self._said(self.mock.start(self.values))

    def exit_initialisation(self) -> int:
        self.running = True
        return 0

    def step(self, time, step) -> int:
        self.mock.calls.append(("step", self.name, time, step))
        return self._said(self.mock.step(self.values, time, step))

    def _said(self, answer) -> int:
        if answer is None:
            return 0
        self.messages.append(answer)
        return answer[0]

    def state(self) -> bytes:
        return pickle.dumps(self.values)

    def restore(self, content) -> None:
        self.values = pickle.loads(content)

    def mark(self) -> None:
        self.marked = self.state()

    def roll_back(self) -> None:
        self.restore(self.marked)

    def reset(self) -> int:
        return 0

    def terminate(self) -> int:
        return 0

    def free(self) -> None:
        pass


class CalledBack:
    """An FMU file whose instances hide their C functions, as slaves in Python that have none."""

    def __init__(self, path: Any) -> None:
        from rockshed.core.fmu.fmu_slave import FmuFile

        self._file = FmuFile(path)
        self.origin = self._file.origin

    def model_description(self) -> bytes:
        return self._file.model_description()

    def instantiate(self, name: str) -> Any:
        slave = self._file.instantiate(name)
        slave.addresses = None
        return slave


def called_back(system: Any) -> dict[str, CalledBack]:
    """The FMUs of a system, to be called through Python."""
    return {name: CalledBack(Path(spec.fmu)) for name, spec in system.components.items()}


def mass(weight: float = 1.0, position: float = 0.0, velocity: float = 0.0) -> Mock:
    """A mass under a force that is held: moves exactly."""

    def step(v: Values, _t: float, h: float) -> None:
        a = v["force"] / v["mass"]
        v["position"] += h * (v["velocity"] + 0.5 * a * h)
        v["velocity"] += a * h

    def start(v: Values) -> None:
        v["position"], v["velocity"] = v["position0"], v["velocity0"]

    return Mock(
        [
            par("mass", weight, "kg", extra="min='1e-3'"),
            par("position0", position, "m"),
            par("velocity0", velocity, "m/s"),
            inp("force", "N"),
            out("position", "m"),
            out("velocity", "m/s"),
        ],
        step,
        start,
    )


def spring(stiffness: float = 1.0, ends: int = 1) -> Mock:
    """A spring between a wall and a point, or between two points; forces on the points; positions are held over a step."""

    def step(v: Values, _t: float = 0.0, _h: float = 0.0) -> None:
        stretch = v["end1.position"] - (v["end2.position"] if ends == 2 else 0.0)
        v["end1.force"] = -v["stiffness"] * stretch
        if ends == 2:
            v["end2.force"] = v["stiffness"] * stretch

    ports = [par("stiffness", stiffness, "N/m")]
    for i in range(1, ends + 1):
        ports += [inp(f"end{i}.position", "m"), out(f"end{i}.force", "N")]
    return Mock(ports, step, step)


def wired(
    mocks: Mapping[str, Mock], connections: list[str], **settings: Any
) -> tuple[Any, Mapping[str, Mock]]:
    """A system of mocks and its sources."""
    from rockshed.core.system.reading import system_from

    specs = settings.pop("components", {})
    data = {
        "name": "test",
        "components": {name: {"fmu": "mock", **specs.get(name, {})} for name in mocks},
        "connections": connections,
        "stop_time": 1.0,
        "exchange_step": 0.1,
        **settings,
    }
    return system_from(data), mocks
