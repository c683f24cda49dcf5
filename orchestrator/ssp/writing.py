"""From a system to an SSP."""

import shutil
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from math import gcd
from pathlib import Path
from typing import Any

from lxml import etree

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.fmu.description import Description, Port, UnitDefinition
from ..core.fmu.slave import BOOLEAN, INTEGER, REAL, STRING
from ..core.fmu.types import TYPES, TYPES_2
from ..core.system.parts import Connection
from ..core.system.plan import End, Plan
from ..core.system.system import SystemSpec
from ..files import whole_file
from ..versions import version_of
from .documents import SSC, SSD, SSV, VERSIONS, as_bytes, schema_problems
from .hints import OMS, OMS_TYPE, OSP, OSP_TYPE, hints_element
from .links import Joint, linked, whole_arrays
from .package import MAIN

RESOURCES = "resources"
VALUES = "initialValues"
"""Name of the sets of values: ecos applies those of one name together."""
MULTI_RATE = "MultiRate.ssd"
"""Description with libcosim's steps of components, which OMSimulator does not take."""
_TIME = (1980, 1, 1, 0, 0, 0)
"""Of all files in an archive, so that the same system gives the same bytes."""
_OF_SSP = {"name", "description", "start_time", "stop_time"}
"""Keys of a system that SSP has words for."""
_TYPES = {REAL: "Real", INTEGER: "Integer", BOOLEAN: "Boolean", STRING: "String"}
_NAMES = {"ssd": SSD, "ssc": SSC, "ssv": SSV, "osp": OSP, "oms": OMS}
"""Prefixes, which libcosim takes for part of the names."""


def write_ssp(
    plan: Plan,
    files: Mapping[str, Path],
    file: Path,
    ssp_version: str = VERSIONS[0],
    shown: Sequence[End] = (),
) -> None:
    """Write a system as an SSP.

    Parameters
    ----------
    plan : Plan
        The system, checked against its FMUs.
    files : mapping of str to Path
        FMUs by component.
    file : Path
        A new file.
    ssp_version : str
        ``1.0`` or ``2.0``.
    shown : sequence of End
        Outputs that become connectors though nothing is connected with them, for tools that show
        connectors alone.

    Raises
    ------
    InputRefused
        There is such a file, or it cannot be written.
    """
    names = resource_names(files)
    contents = {
        MAIN: as_bytes(description(plan, names, ssp_version, shown=shown)),
        MULTI_RATE: as_bytes(description(plan, names, ssp_version, True, shown)),
    }
    copied = {f"{RESOURCES}/{names[component]}": files[component] for component in files}
    write_archive(file, contents, copied)


def write_archive(file: Path, contents: Mapping[str, bytes], copied: Mapping[str, Path]) -> None:
    """Write an archive as a whole or not at all.

    Parameters
    ----------
    file : Path
        A new file.
    contents : mapping of str to bytes
        By name in the archive.
    copied : mapping of str to Path
        Files that are copied, by name in the archive.

    Raises
    ------
    InputRefused
        There is such a file, or it cannot be written.
    """
    if file.exists():
        raise InputRefused([Problem(str(file), "is there already, and stays", "name a new file")])
    with (
        refusing_unwritable(file, "name another file"),
        whole_file(file) as temporary,
        zipfile.ZipFile(temporary, "w") as archive,
    ):
        for name, content in contents.items():
            archive.writestr(_entry(name, zipfile.ZIP_DEFLATED), content)
        for name, source in sorted(copied.items()):
            with source.open("rb") as opened, archive.open(_entry(name), "w") as target:
                shutil.copyfileobj(opened, target)


def _entry(name: str, compression: int = zipfile.ZIP_STORED) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name, _TIME)
    entry.compress_type = compression
    entry.external_attr = 0o644 << 16
    return entry


def resource_names(files: Mapping[str, Path]) -> dict[str, str]:
    """Return names for FMUs in the SSP by component; one file has one name.

    Parameters
    ----------
    files : mapping of str to Path
        FMUs by component.
    """
    names: dict[str, str] = {}
    contents: dict[str, Path] = {}
    for component, file in files.items():
        name = file.name
        other = contents.get(name, file)
        if other != file and other.read_bytes() != file.read_bytes():
            name = f"{component}-{name}"
        contents.setdefault(name, file)
        names[component] = name
    return names


def description(
    plan: Plan,
    names: Mapping[str, str],
    ssp_version: str,
    is_multi_rate: bool = False,
    shown: Sequence[End] = (),
) -> etree._Element:
    """Return the system structure description of a system.

    Parameters
    ----------
    plan : Plan
        The system, checked against its FMUs.
    names : mapping of str to str
        Names of the FMUs among the resources, by component.
    ssp_version : str
        ``1.0`` or ``2.0``.
    is_multi_rate : bool
        Components get libcosim's annotation of their steps.
    shown : sequence of End
        Outputs that become connectors without a connection.

    Returns
    -------
    etree._Element
        The outermost element, valid by the schemas of that version.
    """
    system = plan.system
    variant = " (a step for each component)" if is_multi_rate else ""
    root = etree.Element(
        f"{{{SSD}}}SystemStructureDescription",
        nsmap=_NAMES,
        version=ssp_version,
        name=f"{system.name}{variant}",
        generationTool=f"rockshed {version_of('rockshed')}",
    )
    inner = etree.SubElement(root, f"{{{SSD}}}System", name=system.name)
    if system.description:
        inner.set("description", system.description)
    links = linked(plan, ssp_version)
    ends = [*(end for link in links for end in (link.source, link.target)), *shown]
    units = _units(ends)
    elements = etree.SubElement(inner, f"{{{SSD}}}Elements")
    for name in plan.system.components:
        connectors = _connectors(ends, name, plan.descriptions[name], units)
        made = _component(plan, name, names[name], connectors, ssp_version)
        elements.append(made)
        if is_multi_rate:
            made.append(_step_hint(plan.system.step(name)))
    if links:
        inner.append(_connections(links))
    inner.append(_annotations(plan))
    if units:
        root.append(_group("Units", [_unit(units[name]) for name in sorted(units)]))
    root.append(_experiment(plan, is_multi_rate))
    etree.indent(root)
    problems = schema_problems(root, system.name, ssp_version)
    assert not problems, problems
    return root


# ---------------------------------------------------------------------- components


def _component(
    plan: Plan, name: str, file: str, connectors: Sequence[etree._Element], ssp_version: str
) -> etree._Element:
    made = etree.Element(
        f"{{{SSD}}}Component",
        name=name,
        type="application/x-fmu-sharedlibrary",
        source=f"{RESOURCES}/{file}",
    )
    if connectors:
        made.append(_group("Connectors", connectors))
    if plan.starts[name]:
        starts = whole_arrays(plan.descriptions[name], plan.starts[name])
        made.append(_bindings(starts, ssp_version))
    return made


def _step_hint(step: float) -> etree._Element:
    """Return libcosim's annotation of the step (s) of a component."""
    hint = _annotation(OSP_TYPE, f"{{{OSP}}}StepSizeHint", value=repr(step))
    return _group("Annotations", [hint])


def _connectors(
    ends: Iterable[End], component: str, known: Description, units: Mapping[str, UnitDefinition]
) -> list[etree._Element]:
    """Return those of some ports that a component has, in the order of its description."""
    own = {end.port.array: end.port for end in ends if end.component == component}
    order = {port.array: turn for turn, port in enumerate(known.ports.values())}
    return [_connector(own[name], units) for name in sorted(own, key=lambda name: order[name])]


def _connector(port: Port, units: Mapping[str, UnitDefinition]) -> etree._Element:
    """Return the connector of a port.

    It has no unit where another FMU means something else by its name: the unit is that of the FMU.
    """
    made = etree.Element(f"{{{SSD}}}Connector", name=port.array, kind=port.causality)
    told = etree.SubElement(made, f"{{{SSC}}}{_type_of(port)}")
    if port.kind == REAL and port.unit is not None and units.get(port.unit.name) == port.unit:
        told.set("unit", port.unit_name)
    for size in port.shape:
        etree.SubElement(made, f"{{{SSC}}}Dimension", size=str(size))
    return made


def _type_of(port: Port) -> str:
    """Return the type of a port in the words of SSP; those of FMI 3.0 are those of SSP 2.0."""
    is_of_2 = port.type in TYPES_2 or port.type not in TYPES
    return _TYPES[port.kind] if is_of_2 else TYPES[port.type].call


def _bindings(starts: Iterable[tuple[Port, float | str]], ssp_version: str) -> etree._Element:
    """Return the values of a component, in the units of its variables."""
    binding = etree.Element(f"{{{SSD}}}ParameterBinding")
    values = etree.SubElement(binding, f"{{{SSD}}}ParameterValues")
    values.append(parameter_set(VALUES, starts, ssp_version))
    return _group("ParameterBindings", [binding])


def parameter_set(
    name: str, values: Iterable[tuple[Port, float | str]], ssp_version: str, prefix: str = ""
) -> etree._Element:
    """Return a set of values.

    Parameters
    ----------
    name : str
        Of the set.
    values : iterable of (Port, float or str)
        Variables and what they get; enumerations go as numbers, which other tools take.
    ssp_version : str
        ``1.0`` or ``2.0``.
    prefix : str
        Stands before the names of the variables.
    """
    made = etree.Element(f"{{{SSV}}}ParameterSet", version=ssp_version, name=name)
    parameters = etree.SubElement(made, f"{{{SSV}}}Parameters")
    arrays: dict[str, etree._Element] = {}
    for port, value in values:
        if port.shape and port.array in arrays:
            _append(arrays[port.array], _text(port, value))
            continue
        told = etree.SubElement(parameters, f"{{{SSV}}}Parameter", name=prefix + port.array)
        held = etree.SubElement(told, f"{{{SSV}}}{_type_of(port)}", value=_text(port, value))
        arrays[port.array] = held
        for size in port.shape:
            etree.SubElement(told, f"{{{SSC}}}Dimension", size=str(size))
    return made


def _append(held: etree._Element, text: str) -> None:
    """Add the value of the next element of an array."""
    if etree.QName(held).localname != "String":
        held.set("value", f"{held.get('value')} {text}")
        return
    if "value" in held.attrib:  # several texts stand in elements of their own
        etree.SubElement(held, f"{{{SSV}}}Value", value=held.attrib.pop("value"))
    etree.SubElement(held, f"{{{SSV}}}Value", value=text)


def _text(port: Port, value: float | str) -> str:
    if isinstance(value, str):
        return value
    if port.kind == BOOLEAN:
        return str(bool(value)).lower()
    return repr(float(value)) if port.kind == REAL else str(int(value))


# ---------------------------------------------------------------------- the system


def _connections(links: Iterable[Joint]) -> etree._Element:
    made = []
    for link in links:
        told = etree.Element(
            f"{{{SSD}}}Connection",
            startElement=link.source.component,
            startConnector=link.source.port.array,
            endElement=link.target.component,
            endConnector=link.target.port.array,
        )
        if link.way is not None:
            factor, offset = link.way
            told.set("suppressUnitConversion", "true")
            numbers = {"factor": repr(factor), "offset": repr(offset)}
            etree.SubElement(told, f"{{{SSC}}}LinearTransformation", numbers)
        made.append(told)
    return _group("Connections", made)


def _annotations(plan: Plan) -> etree._Element:
    """Return the annotations of the system; OMSimulator wants its own first."""
    step = repr(plan.system.exchange_step)
    told = _annotation(OMS_TYPE, f"{{{OMS}}}Annotations")
    information = etree.SubElement(told[0], f"{{{OMS}}}SimulationInformation")
    etree.SubElement(information, f"{{{OMS}}}FixedStepMaster", description="oms-ma", stepSize=step)
    return _group("Annotations", [told, hints_element(hints_of(plan.system))])


def hints_of(system: SystemSpec) -> dict[str, Any]:
    """Return what SSP has no words for, in the form of a system file.

    Parameters
    ----------
    system : SystemSpec
        The system.
    """
    data = system.model_dump(mode="json", exclude_defaults=True, exclude=_OF_SSP)
    components = {
        name: {key: value for key, value in spec.items() if key not in ("fmu", "parameters")}
        for name, spec in data.pop("components").items()
    }
    connections = [_more(c) for c in system.connections if not c.terminals]
    data["master"] = system.master
    data["connections"] = [told for told in connections if len(told) > 2]
    data["components"] = {name: told for name, told in components.items() if told}
    return {key: value for key, value in data.items() if value != {} and value != []}


def _more(connection: Connection) -> dict[str, Any]:
    """Return a connection with what SSP has no words for."""
    return connection.model_dump(mode="json", exclude_defaults=True, exclude={"factor", "offset"})


def _units(ends: Iterable[End]) -> dict[str, UnitDefinition]:
    """Return the units of all connectors by name; of two with one name, the first."""
    used: dict[str, UnitDefinition] = {}
    for end in ends:
        unit = end.port.unit
        if end.port.kind == REAL and unit is not None and unit.base is not None:
            used.setdefault(unit.name, unit)
    return used


def _unit(unit: UnitDefinition) -> etree._Element:
    made = etree.Element(f"{{{SSC}}}Unit", name=unit.name)
    base = {symbol: str(power) for symbol, power in (unit.base or {}).items() if power}
    if unit.factor != 1.0:
        base["factor"] = repr(unit.factor)
    if unit.offset:
        base["offset"] = repr(unit.offset)
    etree.SubElement(made, f"{{{SSC}}}BaseUnit", base)
    return made


def _experiment(plan: Plan, is_multi_rate: bool) -> etree._Element:
    """Return times of the run, and libcosim's base step.

    It is the exchange step, or the longest that the steps of all components are made of.
    """
    system = plan.system
    made = etree.Element(
        f"{{{SSD}}}DefaultExperiment",
        startTime=repr(system.start_time),
        stopTime=repr(system.stop_time),
    )
    steps = plan.timing.steps.values() if is_multi_rate else ()
    base = plan.timing.lasts(gcd(plan.timing.exchange, *steps))
    told = _annotation(OSP_TYPE, f"{{{OSP}}}Algorithm")
    etree.SubElement(told[0], f"{{{OSP}}}FixedStepAlgorithm", baseStepSize=repr(base))
    made.append(_group("Annotations", [told]))
    return made


def _annotation(kind: str, tag: str, **attributes: str) -> etree._Element:
    made = etree.Element(f"{{{SSC}}}Annotation", type=kind)
    etree.SubElement(made, tag, attributes)
    return made


def _group(name: str, children: Iterable[etree._Element]) -> etree._Element:
    made = etree.Element(f"{{{SSD}}}{name}")
    made.extend(children)
    return made
