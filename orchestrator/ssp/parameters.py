"""Parameter bindings: which value each variable of a component gets in the end."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree

from ..core.errors import InputRefused, Problem
from ..core.fmu.description import UnitDefinition
from ..core.system.fields import Value
from .conversion import UNCHANGED, Way
from .documents import SSC, SSD, SSM, SSV, read_document
from .package import OutsideError, Package
from .structure import ConnectorKey, Element, FmuElement, StructureReader, SystemElement, read_units
from .wiring import Wire

_REALS = ("Real", "Float64", "Float32")
_NOT_READ = ("Binary",)
_SET = "application/x-ssp-parameter-set"
_MAPPING = "application/x-ssp-parameter-mapping"


@dataclass(frozen=True)
class Bound:
    """A value for a variable.

    Attributes
    ----------
    value : Value
        As the set of values has it.
    unit : UnitDefinition or None
        In which it is given; None for that of the variable.
    converts : bool
        Whether it is converted into the unit of the variable.
    way : Way
        What becomes of the number then.
    place : str
        Of the value, for messages.
    """

    value: Value
    unit: UnitDefinition | None
    place: str
    converts: bool = True
    way: Way = UNCHANGED

    def mapped(self, converts: bool, way: Way) -> "Bound":
        """Return the value behind an entry of a mapping, or behind a connection."""
        if way == UNCHANGED and converts:
            return self
        return Bound(self.value, self.unit, self.place, self.converts and converts, way)


@dataclass
class Bindings:
    """The parameter bindings of a system and of everything in it.

    Attributes
    ----------
    package : Package
        With the files of values and mappings.
    reader : StructureReader
        Knows the name of the description, and collects faults.
    entrances : mapping of ConnectorKey to list of Wire
        Ways from connectors of systems to inputs and parameters of components.
    variable_of : callable
        Returns the name of the variable of a component that a name means; None if there is none.
    values : dict of ConnectorKey to Bound
        By full name of the component and name of the variable.
    """

    package: Package
    reader: StructureReader
    entrances: Mapping[ConnectorKey, list[Wire]]
    variable_of: Callable[[str, str], str | None]
    values: dict[ConnectorKey, Bound] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    _through: dict[ConnectorKey, Bound] = field(default_factory=dict)

    def read(self, root: SystemElement) -> None:
        """Read all bindings; those of outer systems and later ones go before others."""
        for element in [*root.every()][::-1]:
            for xml in element.bindings:
                for name, bound in self._of_binding(xml, element):
                    if not self._apply(element, name, bound):
                        nobody = f"{bound.place}: there is no {name}, and the value is passed over"
                        self.warnings.append(nobody)

    # ------------------------------------------------------------------ to whom

    def _apply(self, element: Element, name: str, bound: Bound) -> bool:
        """Give a value to all variables that a name means; tell whether there is any."""
        if isinstance(element, FmuElement):
            variable = self.variable_of(element.name, name)
            if variable is not None:
                self.values[element.name, variable] = bound
            return variable is not None
        if not isinstance(element, SystemElement):
            return False
        is_known = name in element.connectors
        for wire in self.entrances.get((element.name, name), []):
            self.values[wire.target] = bound.mapped(True, wire.way)
        for own, inner in element.elements.items():
            if name.startswith(f"{own}."):
                is_known |= self._apply(inner, name.removeprefix(f"{own}."), bound)
        return is_known

    # ------------------------------------------------------------------ one binding

    def _of_binding(self, xml: etree._Element, element: Element) -> Iterator[tuple[str, Bound]]:
        """Yield the names and values of a binding."""
        found = self._content(xml, xml.find(f"{{{SSD}}}ParameterValues"), "ParameterSet", element)
        if found is None:
            return
        prefix = xml.get("prefix", "")
        values = {f"{prefix}{name}": bound for name, bound in self._of_set(*found)}
        told = xml.find(f"{{{SSD}}}ParameterMapping")
        if told is None:
            yield from values.items()
            return
        mapping = self._content(told, told, "ParameterMapping", element)
        if mapping is not None:
            yield from self._mapped(values, *mapping)

    def _content(
        self, xml: etree._Element, inline: etree._Element | None, name: str, element: Element
    ) -> tuple[etree._Element, str] | None:
        """Return a set of values or a mapping with the name of its file; None if there is none.

        ``xml`` says where it is; it stands in ``inline`` where that names no file.
        """
        namespace, kind = (SSV, _SET) if name == "ParameterSet" else (SSM, _MAPPING)
        tag = f"{{{namespace}}}{name}"
        if xml.get("type", kind) != kind:
            self._refuse(xml, f"is of the type {xml.get('type')}", f"give it as {kind}", element)
            return None
        source = xml.get("source")
        if source is None:
            found = None if inline is None else inline.find(tag)
            if found is None:
                self._refuse(xml, f"holds no {name} and names no file", "give one", element)
                return None
            return found, self.reader.where
        if xml.get("sourceBase", "SSD") != "SSD":
            remedy = "put it beside the description"
            self._refuse(xml, f"takes its {name} from inside an FMU", remedy, element)
            return None
        return self._of_file(xml, source, tag, element)

    def _of_file(
        self, xml: etree._Element, source: str, tag: str, element: Element
    ) -> tuple[etree._Element, str] | None:
        try:
            file: Path = self.package.resolve(source)
            content = file.read_bytes()
        except OutsideError as error:
            self._refuse(xml, str(error), "put the file into the SSP", element)
            return None
        except OSError as error:
            what = f"names {source}, which cannot be read: {error.strerror or error}"
            self._refuse(xml, what, "put the file into the SSP", element)
            return None
        try:
            return read_document(content, source, tag), source
        except InputRefused as refusal:
            self.reader.problems += refusal.problems
            return None

    def _of_set(self, xml: etree._Element, where: str) -> Iterator[tuple[str, Bound]]:
        units = read_units(xml, SSV)
        for parameter in xml.iterfind(f"{{{SSV}}}Parameters/{{{SSV}}}Parameter"):
            name = parameter.get("name", "")
            place = f"{where}, line {parameter.sourceline}: parameter {name}"
            told = next(child for child in parameter if isinstance(child.tag, str))
            kind = etree.QName(told).localname
            if kind in _NOT_READ:
                problem = Problem(place, f"is {kind}, which is not read", "leave it out")
                self.reader.problems.append(problem)
                continue
            unit = told.get("unit")
            if unit and unit not in units:
                what = f"is in {unit}, which the set of values does not define"
                self.reader.problems.append(Problem(place, what, "define it under Units"))
                continue
            is_array = parameter.find(f"{{{SSC}}}Dimension") is not None
            for element, value in _values(name, kind, told, is_array):
                yield element, Bound(value, units.get(unit or ""), place)

    def _mapped(
        self, values: Mapping[str, Bound], xml: etree._Element, where: str
    ) -> Iterator[tuple[str, Bound]]:
        """Yield the values that a mapping passes on, under their new names."""
        taken: set[str] = set()
        for entry in xml.iterfind(f"{{{SSM}}}MappingEntry"):
            source, target = entry.get("source", ""), entry.get("target", "")
            place = f"{where}, line {entry.sourceline}: {source} -> {target}"
            if target in taken:
                problem = Problem(place, f"{target} is mapped to twice", "keep one entry")
                self.reader.problems.append(problem)
            taken.add(target)
            if source not in values:
                self.warnings.append(f"{place}: the set of values has no {source}")
                continue
            way = Way(*self.reader.transformation(entry, f"{source} -> {target}"))
            converts = entry.get("suppressUnitConversion", "false") not in ("true", "1")
            yield target, values[source].mapped(converts, way)

    def _refuse(self, xml: etree._Element, what: str, remedy: str, element: Element) -> None:
        words = f"a parameter binding of {element.name or 'the system'}"
        place = f"{self.reader.where}, line {xml.sourceline}: {words}"
        self.reader.problems.append(Problem(place, what, remedy))


def _values(
    name: str, kind: str, xml: etree._Element, is_array: bool
) -> Iterator[tuple[str, Value]]:
    """Yield the value of a parameter, or those of the elements of an array."""
    if kind in ("String", "Enumeration"):
        texts = [child.get("value", "") for child in xml] or [xml.get("value", "")]
    else:
        texts = xml.get("value", "").split()
    for number, text in enumerate(texts, 1):
        yield (f"{name}[{number}]" if is_array else name), _value(kind, text)


def _value(kind: str, text: str) -> Value:
    if kind in _REALS:
        return float(text)
    if kind == "Boolean":
        return text in ("true", "1")
    return text if kind in ("String", "Enumeration") else int(text)
