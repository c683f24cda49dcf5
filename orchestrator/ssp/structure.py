"""Content of a system structure description: systems, components, connectors, connections."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from lxml import etree

from ..core.errors import Problem
from ..core.fmu.description import UnitDefinition
from .documents import SSC, SSD

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_FMU = "application/x-fmu-sharedlibrary"
_TRUE = ("true", "1")

ConnectorKey = tuple[str, str]
"""Full name of an element and name of a connector."""


@dataclass(frozen=True)
class Connector:
    """A connector of an element.

    Attributes
    ----------
    name, kind : str
        As in the document.
    type : str
        Real, Integer, ...; empty where none is told.
    unit : str
        Name of its unit; empty where none is told.
    """

    name: str
    kind: str
    type: str = ""
    unit: str = ""


@dataclass(frozen=True)
class Element:
    """A system or a component.

    Attributes
    ----------
    name : str
        Full name: those of the systems around it and its own with dots; empty of the root.
    place : str
        File, line and name, for messages.
    connectors : mapping of str to Connector
        By name.
    bindings : sequence of etree._Element
        Parameter bindings.
    """

    name: str
    place: str
    connectors: Mapping[str, Connector]
    bindings: list[etree._Element]


@dataclass(frozen=True)
class FmuElement(Element):
    """An FMU.

    Attributes
    ----------
    source : str
        Reference to its file.
    xml : etree._Element
        Its element.
    """

    source: str
    xml: etree._Element


@dataclass(frozen=True)
class Link:
    """A connection as it stands in the document.

    Attributes
    ----------
    start, end : ConnectorKey
        Its connectors; an element is empty where it is the system itself.
    factor, offset : float
        Of its linear transformation.
    converts : bool
        Units are converted.
    place : str
        For messages.
    """

    start: ConnectorKey
    end: ConnectorKey
    factor: float
    offset: float
    converts: bool
    place: str


@dataclass(frozen=True)
class SystemElement(Element):
    """A system with its elements by their own names."""

    elements: Mapping[str, Element] = field(default_factory=dict)
    links: list[Link] = field(default_factory=list)

    def every(self) -> Iterator[Element]:
        """Yield this system and everything in it, from above."""
        yield self
        for element in self.elements.values():
            if isinstance(element, SystemElement):
                yield from element.every()
            else:
                yield element


class StructureReader:
    """Reads the elements of a description and collects what is wrong with them.

    Parameters
    ----------
    where : str
        Name of the file, for messages.
    problems : list of Problem
        Gets the faults.
    """

    def __init__(self, where: str, problems: list[Problem]) -> None:
        self.where = where
        self.problems = problems

    def system(self, xml: etree._Element, name: str = "") -> SystemElement:
        """Read a system with everything in it.

        Parameters
        ----------
        xml : etree._Element
            ``ssd:SystemElement``.
        name : str
            Its full name.
        """
        elements: dict[str, Element] = {}
        for child in _children(xml, "Elements"):
            element = self._element(child, name)
            own = child.get("name", "")
            if own in elements:
                self._refuse(child, f"a second element is called {own}", "give it another name")
            elif element is not None:
                elements[own] = element
        place = self._place(xml, f"system {xml.get('name', '')}")
        made = SystemElement(name, place, self._connectors(xml), _bindings(xml), elements)
        made.links.extend(self._link(child) for child in _children(xml, "Connections"))
        return made

    def _element(self, xml: etree._Element, around: str) -> Element | None:
        own = xml.get("name", "")
        name = f"{around}.{own}" if around else own
        kind = etree.QName(xml).localname
        if kind == "System":
            return self.system(xml, name)
        if kind != "Component":
            remedy = "connect the components directly"
            self._refuse(xml, f"{own} is a {kind}, which is not carried out", remedy)
            return None
        if xml.get("type", _FMU) != _FMU:
            what = f"component {name} is of the type {xml.get('type')}, and FMUs are run"
            self._refuse(xml, what, "put its systems in its place, or export it as an FMU")
            return None
        if xml.get("implementation", "any") not in ("any", "CoSimulation"):
            what = f"component {name} is to be run for {xml.get('implementation')}"
            self._refuse(xml, what, "export it for co-simulation")
        place = self._place(xml, f"component {name}")
        return FmuElement(
            name, place, self._connectors(xml), _bindings(xml), xml.get("source", ""), xml
        )

    def _connectors(self, xml: etree._Element) -> dict[str, Connector]:
        found: dict[str, Connector] = {}
        for child in _children(xml, "Connectors"):
            name = child.get("name", "")
            if name in found:
                what = f"a second connector of {xml.get('name', '')} is called {name}"
                self._refuse(child, what, "take one of them out")
            found[name] = _connector(name, child)
        return found

    def _link(self, xml: etree._Element) -> Link:
        start = (xml.get("startElement", ""), xml.get("startConnector", ""))
        end = (xml.get("endElement", ""), xml.get("endConnector", ""))
        words = f"{'.'.join(filter(None, start))} -> {'.'.join(filter(None, end))}"
        if xml.get("startIndices") or xml.get("endIndices"):
            remedy = "connect the whole arrays"
            self._refuse(xml, f"{words} connects single elements of an array", remedy)
        factor, offset = self.transformation(xml, words)
        converts = xml.get("suppressUnitConversion", "false") not in _TRUE
        return Link(start, end, factor, offset, converts, self._place(xml, words))

    def transformation(self, xml: etree._Element, words: str) -> tuple[float, float]:
        """Return factor and offset of a connection or of an entry of a mapping.

        Parameters
        ----------
        xml : etree._Element
            The connection or entry.
        words : str
            Names it in a message.
        """
        for child in xml:
            name = etree.QName(child).localname if isinstance(child.tag, str) else ""
            if name == "LinearTransformation":
                return float(child.get("factor", "1")), float(child.get("offset", "0"))
            if name.endswith("MappingTransformation"):
                remedy = "map the values in one of the FMUs"
                self._refuse(xml, f"{words} has a {name}, which is not carried out", remedy)
        return 1.0, 0.0

    def _place(self, xml: etree._Element, words: str) -> str:
        return f"{self.where}, line {xml.sourceline}: {words}"

    def _refuse(self, xml: etree._Element, what: str, remedy: str) -> None:
        place = f"{self.where}, line {xml.sourceline}"
        self.problems.append(Problem(place, what, remedy))


def _children(xml: etree._Element, group: str) -> list[etree._Element]:
    """Return the elements of a group; comments are passed over."""
    found = xml.find(f"{{{SSD}}}{group}")
    return [] if found is None else [child for child in found if isinstance(child.tag, str)]


def _bindings(xml: etree._Element) -> list[etree._Element]:
    return _children(xml, "ParameterBindings")


def _connector(name: str, xml: etree._Element) -> Connector:
    tags = [child for child in xml if isinstance(child.tag, str)]
    names = [etree.QName(child) for child in tags]
    of_type = [
        (child, tag.localname)
        for child, tag in zip(tags, names)
        if tag.namespace == SSC and tag.localname != "Dimension"
    ]
    kind = xml.get("kind", "")
    if not of_type:
        return Connector(name, kind)
    first, told = of_type[0]
    return Connector(name, kind, told, first.get("unit", ""))


def read_units(root: etree._Element, namespace: str = SSD) -> dict[str, UnitDefinition]:
    """Return the units that a document defines, by name.

    Parameters
    ----------
    root : etree._Element
        Outermost element of a description or of a set of values.
    namespace : str
        Of that document.
    """
    units = {}
    for xml in root.iterfind(f"{{{namespace}}}Units/{{{SSC}}}Unit"):
        base = xml.find(f"{{{SSC}}}BaseUnit")
        powers = {s: int(base.get(s, "0")) for s in BASE_UNITS}
        name = xml.get("name", "")
        units[name] = UnitDefinition(
            name,
            {s: n for s, n in powers.items() if n},
            float(base.get("factor", "1")),
            float(base.get("offset", "0")),
        )
    return units
