"""From an SSP to a system: everything checked, systems in one another laid flat."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from lxml import etree

from ..core.errors import InputRefused, Problem, in_order
from ..core.fmu.description import Description, Port
from ..core.fmu.fmu_slave import FmuFile, UnusableError, read_description
from ..core.fmu.slave import BINARY, BOOLEAN, CLOCK, INTEGER, REAL, STRING, Source
from ..core.system.fields import RESERVED, Value
from ..core.system.in_si import fmu_of, numbers_in
from ..core.system.names import expand, nearest, split_name
from ..core.system.reading import system_from
from ..core.system.remaining import NoFmu, Remaining, other_problems
from ..core.system.system import SystemSpec
from ..core.system.values import written
from .conversion import UNCHANGED, between
from .documents import SSD, parsed, read_document
from .hints import exchange_step, own_hints, positive, step_hint
from .package import OutsideError, Package, open_package
from .parameters import Bindings, Bound
from .structure import Connector, ConnectorKey, Element, FmuElement, StructureReader, read_units
from .wiring import Units, Wire, Wiring, targets_of

ROOT = f"{{{SSD}}}SystemStructureDescription"
_KINDS = {
    **dict.fromkeys(("Real", "Float64", "Float32"), REAL),
    **dict.fromkeys(("Integer", "Int8", "UInt8", "Int16", "UInt16", "Int32"), INTEGER),
    **dict.fromkeys(("UInt32", "Int64", "UInt64", "Enumeration"), INTEGER),
    "Boolean": BOOLEAN,
    "String": STRING,
    "Binary": BINARY,
    "Clock": CLOCK,
}
"""Families of FMI calls by the type of a connector."""
_NO_LETTER = re.compile(r"[^A-Za-z0-9_]")
_PLACE = re.compile(r"[0-9]{1,9}")
"""Number of an element of an array, from 1."""

Describe = Callable[[Path], bytes]
"""Returns the ``modelDescription.xml`` of an FMU file, or refuses it with InputRefused."""


@dataclass(frozen=True)
class Imported:
    """An SSP as a system.

    Attributes
    ----------
    system : SystemSpec
        The system.
    package : Package
        Its files.
    names : mapping of str to str
        Full names of the components in the SSP by their names in the system.
    warnings : tuple of str
        For the user.
    options : mapping
        Keys of the system that were given in the place of those of the SSP.
    """

    system: SystemSpec
    package: Package
    names: Mapping[str, str]
    warnings: tuple[str, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)


def model_description(file: Path) -> bytes:
    """Return the ``modelDescription.xml`` of an FMU file."""
    return FmuFile(file, to_run=False).model_description()


def read_ssp(path: Path, options: Mapping[str, Any] | None = None) -> Imported:
    """Read an SSP.

    Parameters
    ----------
    path : Path
        Archive, folder or description.
    options : mapping, optional
        Keys of the system that go before those of the SSP: ``exchange_step``, ``stop_time``, ...

    Returns
    -------
    Imported

    Raises
    ------
    InputRefused
        Everything that is wrong with it.
    """
    return read_structure(open_package(path), options or {})


def read_structure(
    package: Package, options: Mapping[str, Any], describe: Describe = model_description
) -> Imported:
    """Read the description of a package, see :func:`read_ssp`.

    Parameters
    ----------
    package : Package
        With all files.
    options : mapping
        Keys of the system that go before those of the SSP.
    describe : callable
        Returns the model description of an FMU.
    """
    where = f"{package.path}" if package.path.suffix == ".ssd" else f"{package.path}/{package.main}"
    root = read_document(package.description, where, ROOT)
    return _Import(package, root, where, options, describe).imported()


@dataclass
class _Import:
    """Goes through a description part by part and collects problems."""

    package: Package
    root: etree._Element
    where: str
    options: Mapping[str, Any]
    describe: Describe
    problems: list[Problem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    descriptions: dict[str, Description] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    timed: bool = True

    def imported(self) -> Imported:
        """Return the system, or refuse it with every problem."""
        reader = StructureReader(self.where, self.problems)
        system_xml = self.root.find(f"{{{SSD}}}System")
        self.units = read_units(self.root)
        system = reader.system(system_xml)
        self.components = [e for e in system.every() if isinstance(e, FmuElement)]
        if not self.components:
            self._refuse(system.place, "has no component that can be run", "add one")
        for component in self.components:
            self._describe(component)
        for element in system.every():
            self._check_connectors(element)
        wires = Wiring(system, self._units_of, self.problems).wires()
        bindings = Bindings(self.package, reader, targets_of(wires), self._variable_of)
        bindings.read(system)
        self.warnings += bindings.warnings
        hints = self._hints(system_xml)
        data = self._data(system_xml, wires, bindings.values, hints)
        spec = self._formed({**data, **self.options})
        names = {clean: name for name, clean in self.names.items()}
        return Imported(spec, self.package, names, tuple(self.warnings), self.options)

    def _source_of(self, component: str, entry: Any) -> Source:
        return _Described(Path(fmu_of(entry)), self.describe)

    def _sources_of(self, system: SystemSpec) -> dict[str, Source]:
        return {name: self._source_of(name, spec) for name, spec in system.components.items()}

    def _hints(self, system_xml: etree._Element) -> dict[str, Any]:
        """Return this program's own annotation; of one that cannot be read, times to go on with."""
        try:
            return own_hints(system_xml, self.where)
        except InputRefused as refusal:
            self.problems += refusal.problems
            self.timed = False
            return {"exchange_step": 1.0, "stop_time": 1.0}

    def _formed(self, data: Mapping[str, Any]) -> SystemSpec:
        """Return the system, or refuse it with every problem, also of its hints and its FMUs."""
        is_whole = not self.problems
        told = {f"{self.where}: {problem.where}" for problem in self.problems}
        try:
            spec = system_from(data, self.where, self._source_of)
            if is_whole:
                return spec
        except InputRefused as refusal:
            self.problems += [p for p in refusal.problems if p.where not in told]
        unread = {clean for name, clean in self.names.items() if name not in self.descriptions}
        sound, _ = numbers_in(data, self._source_of)
        known = Remaining(sound, unread, self.timed, connected=is_whole)
        raise InputRefused(in_order([*self.problems, *other_problems(known, self._sources_of)]))

    def _refuse(self, where: str, what: str, remedy: str = "") -> None:
        self.problems.append(Problem(where, what, remedy))

    # ------------------------------------------------------------------ components

    def _describe(self, component: FmuElement) -> None:
        place = component.place
        try:
            file = self.package.resolve(component.source)
        except OutsideError as error:
            self._refuse(place, str(error), "put the FMU into the folder resources of the SSP")
            return
        self.files[component.name] = str(file)
        try:
            self.descriptions[component.name] = read_description(self.describe(file))
        except InputRefused as refusal:
            name = component.source
            self.problems += [
                Problem(place, f"{name} {p.what}", p.remedy) for p in refusal.problems
            ]
        except UnusableError as error:
            self._refuse(place, f"{component.source} {error}", error.remedy)

    def _variable_of(self, component: str, name: str) -> str | None:
        """Return the name of a variable; elements of arrays are counted row by row in an SSP."""
        known = self.descriptions.get(component)
        if known is None or name in known.ports:
            return name
        array, _, number = name.rpartition("[")
        elements = known.arrays[array].names if array in known.arrays else ()
        place = int(number[:-1]) if _PLACE.fullmatch(number[:-1]) else 0
        return elements[place - 1] if 0 < place <= len(elements) else None

    def _check_connectors(self, element: Element) -> None:
        """Refuse connectors that the FMU does not have, or has otherwise."""
        for connector in element.connectors.values():
            if connector.unit and connector.unit not in self.units:
                what = f"connector {connector.name} is in {connector.unit}, which is not defined"
                self._refuse(element.place, what, "define it under Units")
            known = self.descriptions.get(element.name)
            if isinstance(element, FmuElement) and known is not None:
                self._check_connector(element, connector, known)

    def _check_connector(self, element: Element, told: Connector, known: Description) -> None:
        port = _port_of(known, told.name)
        if port is None:
            what = f"connector {told.name} is no variable of the FMU"
            self._refuse(element.place, what, nearest(told.name, known.ports))
        elif told.kind not in (port.causality, "unspecified"):
            what = f"connector {told.name} is of the kind {told.kind}; the FMU has the causality"
            self._refuse(element.place, f"{what} {port.causality}", "correct the kind")
        elif told.type and _KINDS.get(told.type) != port.kind:
            what = f"connector {told.name} is {told.type}, and the FMU has {port.kind}"
            self._refuse(element.place, what, "correct the type")
        elif told.unit in self.units:
            try:
                between(port.unit, self.units[told.unit])
            except ValueError as error:
                self._refuse(element.place, f"connector {told.name}: {error}", "correct the unit")

    def _units_of(self, element: Element, connector: Connector) -> Units:
        told = self.units.get(connector.unit)
        known = self.descriptions.get(element.name)
        if not isinstance(element, FmuElement) or known is None:
            return Units(told, told)
        port = _port_of(known, connector.name)
        own = None if port is None else port.unit
        try:
            between(own, told)
        except ValueError:  # refused already
            return Units(own, own)
        return Units(told or own, own)

    # ------------------------------------------------------------------ the system

    def _data(
        self,
        system_xml: etree._Element,
        wires: list[Wire],
        values: Mapping[ConnectorKey, Bound],
        hints: dict[str, Any],
    ) -> dict[str, Any]:
        """Return the system as a system file has it."""
        self.names = self._clean_names()
        has_own = bool(hints)  # then these steps are the same, or none
        told = hints.pop("components", {})
        components = {
            self.names[c.name]: {
                "fmu": self.files.get(c.name, ""),
                **({} if has_own else self._step(c)),
                **told.get(self.names[c.name], {}),
                "parameters": {},
            }
            for c in self.components
        }
        fed = {wire.target for wire in wires if wire.from_component}
        for key, bound in values.items():
            if key in fed:
                self.warnings.append(f"{bound.place}: {'.'.join(key)} is connected, and not set")
            elif (value := self._value(key, bound)) is not None:
                components[self.names[key[0]]]["parameters"][key[1]] = value
        shared = self._shared(hints.pop("shared", {}), components)
        connections = self._connections(wires, hints.pop("connections", []))
        experiment = self.root.find(f"{{{SSD}}}DefaultExperiment")
        return {
            "name": system_xml.get("name") or self.root.get("name"),
            "description": system_xml.get("description", ""),
            "master": "jacobi",
            **self._times({} if experiment is None else experiment.attrib, hints),
            **hints,
            "components": components,
            "connections": connections,
            "shared": shared,
        }

    def _clean_names(self) -> dict[str, str]:
        """Return names that components can have in a system, by their full names."""
        cleaned: dict[str, str] = {}
        for component in self.components:
            parts = [_NO_LETTER.sub("_", part) or "_" for part in component.name.split(".")]
            name = ".".join(f"_{part}" if part[0].isdigit() else part for part in parts)
            if parts[0] in RESERVED:
                name = f"_{name}"
            while name in cleaned.values():
                name += "_"
            if name != component.name:
                self.warnings.append(f"{component.place} is called {name} here")
            cleaned[component.name] = name
        return cleaned

    def _step(self, component: FmuElement) -> dict[str, float]:
        step = step_hint(component)
        return {} if step is None else {"step": step}

    def _times(self, told: Mapping[str, str], hints: Mapping[str, Any]) -> dict[str, float]:
        times: dict[str, float] = {}
        for key, attribute in (("start_time", "startTime"), ("stop_time", "stopTime")):
            if attribute in told:
                times[key] = float(told[attribute])
        step = exchange_step(self.root)
        if step is not None:
            times["exchange_step"] = step
        known = {**times, **hints, **self.options}
        for key, attribute, chosen in (
            ("stop_time", "stopTime", max),
            ("exchange_step", "stepSize", min),
        ):
            if key in known:
                continue
            proposed = self._proposed(attribute)
            if not proposed:
                what = "is neither in the SSP nor proposed by its FMUs"
                self._refuse(key, what, f"give {key}=...")
                continue
            times[key] = chosen(proposed)
            said = f"{key} is not in the SSP; its FMUs propose {times[key]:g} s, which is taken"
            self.warnings.append(said)
        return times

    def _proposed(self, attribute: str) -> list[float]:
        """Return what the FMUs propose for a time (s) of a run (FMI: DefaultExperiment)."""
        found = []
        for name in self.descriptions:
            xml = parsed(self.describe(Path(self.files[name])), name)
            experiment = xml.find("DefaultExperiment")
            told = None if experiment is None else positive(experiment.get(attribute))
            found += [] if told is None else [told]
        return found

    def _connections(self, wires: list[Wire], told: list[dict[str, Any]]) -> list[Any]:
        """Return the connections of components, with what hints say of them besides."""
        more = {(entry.get("source"), entry.get("target")): entry for entry in told}
        connections = []
        for wire in wires:
            if not wire.from_component:
                continue
            source, target = (
                f"{self.names[name]}.{port}" for name, port in (wire.source, wire.target)
            )
            entry = {**more.get((source, target), {}), "source": source, "target": target}
            if wire.is_told:
                entry |= {"factor": wire.way.factor, "offset": wire.way.offset}
            connections.append(entry)
        return connections

    # ------------------------------------------------------------------ values

    def _value(self, key: ConnectorKey, bound: Bound) -> Value | None:
        """Return a value in the unit of its variable; None where it is refused."""
        known = self.descriptions.get(key[0])
        port = None if known is None else known.ports[key[1]]
        if port is None:
            return None
        is_number = isinstance(bound.value, int | float) and not isinstance(bound.value, bool)
        if is_number and port.items:
            return written(port, float(bound.value))
        if not isinstance(bound.value, float):
            return bound.value
        try:
            way = between(bound.unit, port.unit) if bound.converts else UNCHANGED
        except ValueError as error:
            self._refuse(bound.place, f"{'.'.join(key)}: {error}", "give it in another unit")
            return None
        return way.then(bound.way).of(bound.value)

    def _shared(
        self, hints: Mapping[str, Any], components: dict[str, dict[str, Any]]
    ) -> dict[str, Any]:
        """Return the shared values whose targets still have one value, which they then lose."""
        shared: dict[str, Any] = {}
        for name, entry in hints.items():
            targets = [
                (owner, key)
                for target in entry["targets"]
                for owner, key in self._targets(target, components)
            ]
            given = [components[owner]["parameters"].get(key) for owner, key in targets]
            if not given or given[0] is None or any(value != given[0] for value in given):
                self.warnings.append(f"{name} is no longer one value for {entry['targets']}")
                continue
            for owner, key in targets:
                del components[owner]["parameters"][key]
            shared[name] = {"value": given[0], "targets": entry["targets"]}
        return shared

    def _targets(self, target: str, components: Mapping[str, Any]) -> list[ConnectorKey]:
        """Return the variables that a target of a shared value stands for."""
        owner, name = split_name(target, components)
        full = next((n for n, clean in self.names.items() if clean == owner), "")
        known = self.descriptions.get(full)
        return [] if known is None else [(owner, key) for key in expand(name, known.ports)]


class _Described(NoFmu):
    """An FMU of an SSP, which is described and not run."""

    def __init__(self, path: Path, describe: Describe) -> None:
        super().__init__()
        self.path = str(path)
        self._describe = describe

    def model_description(self) -> bytes:
        """Return the ``modelDescription.xml`` of the FMU."""
        return self._describe(Path(self.path))


def _port_of(known: Description, name: str) -> Port | None:
    """Return the port of a connector; of an array, its first element."""
    if name in known.ports or name not in known.arrays:
        return known.ports.get(name)
    return known.ports[known.arrays[name].names[0]]
