"""Annotations of a description: what the standard has no words for.

This program's own annotation holds what a system file has besides components, values, connections
and times, in the form of a system file (TOML): schedule, steps, power bonds, what is recorded.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import tomli_w
from lxml import etree

from ..core.errors import InputRefused, Problem
from ..core.fmu.annotations import TOOL
from ..core.input_text import toml_content
from .documents import SSC, SSD
from .structure import FmuElement

OWN = "urn:org.rockshed:system"
"""Namespace of this program's own annotation."""
OSP = "http://opensimulationplatform.com/SSP/OSPAnnotations"
OSP_TYPE = "com.opensimulationplatform"
OMS = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"
OMS_TYPE = "org.openmodelica"


def annotation(xml: etree._Element, kind: str) -> etree._Element | None:
    """Return the annotation of a tool at an element; None if there is none."""
    for found in xml.iterfind(f"{{{SSD}}}Annotations/{{{SSC}}}Annotation"):
        if found.get("type") == kind:
            return found
    return None


def own_hints(system: etree._Element, where: str) -> dict[str, Any]:
    """Read this program's own annotation.

    Parameters
    ----------
    system : etree._Element
        The outermost ``ssd:System``.
    where : str
        Name of the file, for messages.

    Returns
    -------
    dict
        Keys of a system file; empty where there is none.

    Raises
    ------
    InputRefused
        It is no TOML, or has other things in the place of tables.
    """
    found = annotation(system, TOOL)
    told = None if found is None else found.find(f"{{{OWN}}}System")
    if told is None:
        return {}
    place = f"{where}, annotation of {TOOL}"
    hints = toml_content(Path(place), told.text or "")
    problems = [
        Problem(f"{place}: {key}", "is not of the form of a system file", "take it out")
        for key, fits in _FORMS.items()
        if key in hints and not fits(hints[key])
    ]
    if problems:
        raise InputRefused(problems)
    return hints


def _is_table_of_tables(value: Any) -> bool:
    return isinstance(value, dict) and all(isinstance(entry, dict) for entry in value.values())


def _is_list_of_tables(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(entry, dict) for entry in value)


def _are_shared(value: Any) -> bool:
    return _is_table_of_tables(value) and all(
        isinstance(entry.get("targets"), list) and all(isinstance(t, str) for t in entry["targets"])
        for entry in value.values()
    )


_FORMS: Mapping[str, Callable[[Any], bool]] = {
    "components": _is_table_of_tables,
    "connections": _is_list_of_tables,
    "shared": _are_shared,
}
"""Forms of the entries that are read before the system is checked."""


def hints_element(hints: Mapping[str, Any]) -> etree._Element:
    """Return this program's own annotation.

    Parameters
    ----------
    hints : mapping
        Keys of a system file.
    """
    element = etree.Element(f"{{{SSC}}}Annotation", type=TOOL)
    own = etree.SubElement(element, f"{{{OWN}}}System", nsmap={"rockshed": OWN})
    own.text = f"\n{tomli_w.dumps(hints)}"
    return element


def exchange_step(root: etree._Element) -> float | None:
    """Return the exchange step (s) that annotations of libcosim or OMSimulator name, if any.

    Parameters
    ----------
    root : etree._Element
        Outermost element of the description.
    """
    places = (
        (f".//{{{OSP}}}FixedStepAlgorithm", "baseStepSize"),
        (f"{{{SSD}}}System/{{{SSD}}}Annotations//{{{OMS}}}FixedStepMaster", "stepSize"),
    )
    for path, attribute in places:
        for found in root.iterfind(path):
            if (step := positive(found.get(attribute))) is not None:
                return step
    return None


def step_hint(component: FmuElement) -> float | None:
    """Return the communication step (s) that libcosim's annotation of a component names, if any."""
    found = annotation(component.xml, OSP_TYPE)
    told = None if found is None else found.find(f"{{{OSP}}}StepSizeHint")
    return None if told is None else positive(told.get("value"))


def positive(text: str | None) -> float | None:
    """Read a positive finite number; return None if the text is none."""
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if 0.0 < value < float("inf") else None
