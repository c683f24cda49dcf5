"""Data of a system with numbers in the place of quantities, ``20 mm``: in the units of its FMUs.

Times have one unit and are read where their type is declared (:mod:`.fields`); the unit of
everything else is that of a variable.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from ..errors import InputRefused
from ..fmu.description import Description, Port, UnitDefinition
from ..fmu.fmu_slave import UnusableError, read_description
from ..fmu.slave import REAL, Source
from .clock import seconds_in
from .names import expand, select, split_name
from .quantities import defined, in_si, in_unit, is_quantity
from .renaming import present_name
from .signals import TIME
from .values import start_value

KeyPath = tuple[str | int, ...]
"""Keys and numbers of elements that lead to a value: ``("connections", 0, "factor")``."""
SourceOf = Callable[[str, Any], Source]
"""Makes the source of a component from its name and what the system has of it."""
_CONDITION = re.compile(r"(?P<begin>\s*[^<>=]+?\s*[<>]=?\s*)(?P<number>[^<>=]+)")


class _NoVariableError(Exception):
    """A quantity is for a variable that there is not, which is told with the rest of the system."""


@dataclass
class Descriptions:
    """Descriptions of the FMUs of a system as plain data, read when they are asked for.

    Attributes
    ----------
    components : mapping of str to Any
        Of the system, or as they stand in a file.
    source_of : callable
        Makes the source of a component.
    """

    components: Mapping[str, Any]
    source_of: SourceOf
    _known: dict[str, Description | None] = field(default_factory=dict)

    def of(self, component: str) -> Description | None:
        """Return the description of a component; None where none can be read."""
        if component not in self._known:
            self._known[component] = self._read(component)
        return self._known[component]

    def _read(self, component: str) -> Description | None:
        entry = self.components.get(component)
        if not fmu_of(entry):
            return None
        try:
            return read_description(self.source_of(component, entry).model_description())
        except (InputRefused, UnusableError):  # told with the rest of the system
            return None

    def port(self, name: Any) -> Port | None:
        """Return the variable of a name, ``component.variable``; of an array, the first element."""
        owner, variable = split_name(str(name), self.components)
        known = self.of(owner)
        return None if known is None else port_of(known, variable)

    def outputs(self, pattern: Any) -> list[Port]:
        """Return the outputs whose names, ``component.output``, fit a pattern."""
        named = {
            f"{component}.{port.name}": port
            for component in self.components
            if (known := self.of(component))
            for port in known.named("output")
        }
        return [named[name] for name in select(str(pattern), [*named])]


def fmu_of(entry: Any) -> str:
    """Return the FMU that a component names, also as plain data; empty where it names none."""
    fmu = entry.get("fmu") if isinstance(entry, Mapping) else getattr(entry, "fmu", "")
    return fmu if isinstance(fmu, str) else ""


def port_of(known: Description, name: str) -> Port | None:
    """Return the variable of a name; of an array or a shorthand, the first element.

    Parameters
    ----------
    known : Description
        Of the FMU.
    name : str
        Of the variable, also an older one.
    """
    present = present_name(known, name)
    if present in known.arrays:
        return known.ports[known.arrays[present].names[0]]
    try:
        names = expand(present, known.ports)
    except ValueError:  # told with the rest of the system
        return None
    return known.ports.get(names[0]) if names else None


def numbers_in(
    data: Mapping[str, Any], source_of: SourceOf
) -> tuple[dict[str, Any], dict[KeyPath, str]]:
    """Return the data of a system with its quantities as numbers in the units of its variables.

    Parameters
    ----------
    data : mapping
        Keys and values as in a TOML file, of whatever form.
    source_of : callable
        Makes the source of a component, whose variables have the units.

    Returns
    -------
    data : dict
        Texts that are no quantities stay. In the place of a wrong quantity stands a value with
        which the rest can be looked at.
    wrong : dict of KeyPath to str
        What is wrong, by the place of the quantity.
    """
    components = data.get("components")
    known = Descriptions(components if isinstance(components, Mapping) else {}, source_of)
    reader = _Reader({key: _copied(entry) for key, entry in data.items()}, known)
    reader.read()
    return reader.data, reader.wrong


@dataclass
class _Reader:
    """Goes through the data of a system, and replaces quantities by numbers."""

    data: dict[str, Any]
    known: Descriptions
    wrong: dict[KeyPath, str] = field(default_factory=dict)

    def read(self) -> None:
        """Replace what is a quantity, part by part."""
        for name, component in _tables(self.data, "components"):
            for _, parameters in _tables(component, "parameters", whole=True):
                self._parameters(("components", name, "parameters"), str(name), parameters)
        for name, shared in _tables(self.data, "shared"):
            targets = shared.get("targets")
            target = targets[0] if isinstance(targets, list) and targets else None
            self._value(("shared", name, "value"), shared, target)
        for place, connection in _tables(self.data, "connections"):
            self._connection(("connections", place), connection)
        for _, alarm in _tables(self.data, "energy_alarm", whole=True):
            self._quantity(("energy_alarm", "reference"), alarm, lambda text: in_si(text, "J"))
        for _, iteration in _tables(self.data, "iteration", whole=True):
            self._iteration(iteration)
        for _, scenario in _tables(self.data, "scenario", whole=True):
            self._scenario(scenario)

    # ------------------------------------------------------------------ single values

    @contextmanager
    def _told(self, key: KeyPath) -> Iterator[None]:
        """Note why a quantity is wrong; one for nothing is refused with the rest of the system."""
        try:
            yield
        except _NoVariableError:
            pass
        except ValueError as error:
            self.wrong[key] = str(error)

    def _quantity(
        self, key: KeyPath, table: Any, read: Callable[[str], float], instead: float = 1.0
    ) -> None:
        """Replace an entry of a table or list, which the last part of the key names."""
        text = _quantity_at(key, table)
        if text:
            table[key[-1]] = instead
            with self._told(key):
                table[key[-1]] = read(text)

    def _value(self, key: KeyPath, table: dict[str, Any], variable: Any) -> None:
        """Replace the value of a variable; what is none for a number stays."""
        port = self.known.port(variable) if _quantity_at(key, table) else None
        if port is not None and port.kind == REAL:
            begin = start_value(port)
            instead = begin if isinstance(begin, float) else 0.0
            self._quantity(key, table, lambda text: in_unit(text, port.unit), instead)

    def _in_unit_of(self, variable: Any, text: str, is_difference: bool = False) -> float:
        """Read a quantity that can be nothing but a number in the unit of a variable."""
        return in_unit(text, self._real(variable, text).unit, is_difference)

    def _real(self, variable: Any, text: str) -> Port:
        """Return a variable that has a unit, if it can be found.

        Raises
        ------
        ValueError
            It has none, or its FMU cannot be read.
        _NoVariableError
            There is no such variable, no such component, or it names no FMU.
        """
        port = self.known.port(variable)
        owner = split_name(str(variable), self.known.components)[0]
        is_told = self.known.of(owner) or not fmu_of(self.known.components.get(owner))
        if port is None and is_told:
            raise _NoVariableError
        if port is None or port.kind != REAL:
            why = f"of {variable} no unit is known"
            raise ValueError(f"must be a number: {why} (given: {text!r})")
        return port

    # ------------------------------------------------------------------ parts of a system

    def _parameters(self, above: KeyPath, component: str, parameters: dict[str, Any]) -> None:
        for name in parameters:
            self._value((*above, name), parameters, f"{component}.{name}")

    def _connection(self, above: KeyPath, connection: dict[str, Any]) -> None:
        source, target = connection.get("source"), connection.get("target")

        def factor(text: str) -> float:
            return in_unit(text, _quotient(self._real(target, text), self._real(source, text)))

        self._quantity((*above, "factor"), connection, factor)
        offset = partial(self._in_unit_of, target, is_difference=True)
        self._quantity((*above, "offset"), connection, offset, 0.0)

    def _iteration(self, iteration: dict[str, Any]) -> None:
        def of_all(text: str) -> float:
            raise ValueError(
                f"is in the unit of each source: write a number, and quantities in "
                f"iteration.connections (given: {text!r})"
            )

        self._quantity(("iteration", "absolute"), iteration, of_all)
        for place, entry in _tables(iteration, "connections"):
            read = partial(self._of_sources, entry.get("source", "*"))
            self._quantity(("iteration", "connections", place, "absolute"), entry, read)

    def _of_sources(self, pattern: Any, text: str) -> float:
        """Read a difference in the unit that all outputs have which fit a pattern."""
        ports = [port for port in self.known.outputs(pattern) if port.kind == REAL]
        units = {port.unit_name: port.unit for port in ports}
        if len(units) != 1:
            names = ", ".join(sorted(units)) or "none that is known"
            why = f"must be a number, or name sources of one unit: these have {names}"
            raise ValueError(f"{why} (given: {text!r})")
        return in_unit(text, next(iter(units.values())), is_difference=True)

    def _scenario(self, scenario: dict[str, Any]) -> None:
        for place, entry in _tables(scenario, "set"):
            self._value(("scenario", "set", place, "value"), entry, entry.get("port"))
            self._condition(("scenario", "set", place, "when"), entry)
        for place, entry in _tables(scenario, "fault"):
            read = partial(self._in_unit_of, entry.get("port"), is_difference=True)
            self._quantity(("scenario", "fault", place, "deviation"), entry, read)
        for _, columns in _tables(scenario, "inputs", whole=True):
            for name, values in columns.items():
                self._column(("scenario", "inputs", name), str(name), values)

    def _column(self, above: KeyPath, name: str, values: Any) -> None:
        read = seconds_in if name == TIME else partial(self._in_unit_of, name)
        texts = isinstance(values, list) and any(isinstance(value, str) for value in values)
        for place in range(len(values) if texts else 0):
            self._quantity((*above, place), values, read, 0.0)

    def _condition(self, key: KeyPath, entry: dict[str, Any]) -> None:
        """Replace the quantity in a comparison of an output."""
        found = _CONDITION.fullmatch(str(entry.get("when")))
        number = found["number"].strip() if found else ""
        if found is None or not is_quantity(number):
            return
        entry["when"] = f"{found['begin']}0.0"
        with self._told(key):
            output = re.split("[<>]", found["begin"])[0].strip()
            entry["when"] = f"{found['begin']}{self._in_unit_of(output, number)!r}"


def _quantity_at(key: KeyPath, table: Any) -> str:
    """Return the quantity in an entry of a table or list; empty where there is none."""
    text = table.get(key[-1]) if isinstance(table, dict) else table[key[-1]]
    return text if isinstance(text, str) and is_quantity(text) else ""


def _copied(data: Any) -> Any:
    """Return tables and lists anew."""
    if isinstance(data, dict):
        return {key: _copied(entry) for key, entry in data.items()}
    return [*map(_copied, data)] if isinstance(data, list) else data


def _tables(data: Any, key: str, whole: bool = False) -> Iterator[tuple[str | int, dict[str, Any]]]:
    """Yield the tables in an entry by their places, or the entry as the only one."""
    entry = data.get(key) if isinstance(data, Mapping) else None
    found: Sequence[tuple[str | int, Any]] = []
    if whole:
        found = [(key, entry)]
    elif isinstance(entry, dict):
        found = [*entry.items()]
    elif isinstance(entry, list):
        found = [*enumerate(entry)]
    yield from ((place, table) for place, table in found if isinstance(table, dict))


def _quotient(one: Port, other: Port) -> UnitDefinition | None:
    """Return the unit of what the value of one port is for each unit of another."""
    above, below = (defined(port.unit or UnitDefinition("1", {})) for port in (one, other))
    if above is None or below is None or above.base is None or below.base is None:
        return UnitDefinition(f"{one.unit_name} per {other.unit_name}")
    base = {
        symbol: above.base.get(symbol, 0) - below.base.get(symbol, 0)
        for symbol in {**above.base, **below.base}
    }
    name = above.name if below.name == "1" else f"{above.name} per {below.name}"
    return UnitDefinition(name, base, above.factor / below.factor)
