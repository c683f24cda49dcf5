"""Annotations that a model description carries for this program.

They tell roles, older names, figures, pictures and power bonds. An FMU of another tool has none,
and nothing is missing then.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.etree.ElementTree import Element

TOOL = "org.rockshed"


@dataclass(frozen=True)
class Annotation:
    """Annotation of a variable.

    Attributes
    ----------
    role : str
        Its meaning to metrics, balance of energy, tables and pictures; empty for none.
    label : str
        Its short name in legends.
    formerly : tuple of str
        Older names under which a value for it is still taken.
    reported : tuple of mappings
        Figures that are reported of it: name, statistic, unit on the screen, decimals.
    """

    role: str = ""
    label: str = ""
    formerly: tuple[str, ...] = ()
    reported: tuple[Mapping[str, Any], ...] = ()

    def as_data(self) -> dict[str, Any]:
        """Return what metrics and pictures need of it, as plain data."""
        data = {"role": self.role, "label": self.label, "reported": list(self.reported)}
        return {key: value for key, value in data.items() if value}


NOTHING = Annotation()
"""Annotation of a variable of which nothing is told."""


@dataclass(frozen=True)
class Annotations:
    """Annotations of a whole model description.

    Attributes
    ----------
    variables : mapping of str to Annotation
        By the name of the variable, as the description has it.
    contents : str
        What a serialized state holds, for readers that know how to draw or measure it.
    pictures : tuple of mappings
        Pictures of the outputs as data: name, panels with their curves.
    bonds : tuple of mappings
        Power bonds: name, variables of their members, what is so while nothing drives them.
    """

    variables: Mapping[str, Annotation] = field(default_factory=dict)
    contents: str = ""
    pictures: tuple[Mapping[str, Any], ...] = ()
    bonds: tuple[Mapping[str, Any], ...] = ()


def read_annotations(root: Element) -> Annotations:
    """Read the annotations of a model description of FMI 2.0 or 3.0.

    Parameters
    ----------
    root : Element
        Root of ``modelDescription.xml``.
    """
    own = _own(root, "VendorAnnotations/Tool", "Annotations/Annotation")
    component = None if own is None else own.find("Component")
    variables = root.find("ModelVariables")
    return Annotations(
        {
            variable.get("name", ""): annotation
            for variable in ([] if variables is None else variables)
            if (annotation := _of_variable(variable)) is not None
        },
        "" if component is None else component.get("contents", ""),
        () if component is None else tuple(map(_picture, component.findall("Picture"))),
        () if component is None else _bonds(component),
    )


def _own(element: Element, *paths: str) -> Element | None:
    """Return the annotation of this program among those of all tools."""
    for path in paths:
        for tool in element.findall(path):
            if TOOL in (tool.get("name"), tool.get("type")):
                return tool
    return None


def _of_variable(variable: Element) -> Annotation | None:
    own = _own(variable, "Annotations/Tool", "Annotations/Annotation")
    told = None if own is None else own.find("Variable")
    if told is None:
        return None
    return Annotation(
        told.get("role", ""),
        told.get("label", ""),
        tuple(told.get("formerly", "").split()),
        tuple(map(_reported, told.findall("Reported"))),
    )


def _reported(element: Element) -> dict[str, Any]:
    return {
        "name": element.get("name", ""),
        "statistic": element.get("statistic", "largest"),
        "unit": element.get("unit", "1"),
        "decimals": int(element.get("decimals", "0")),
    }


def _picture(element: Element) -> dict[str, Any]:
    """Read a picture; a panel of no curves shows nothing and is passed over."""
    readers = {"Panel": _panel, "Envelope": _envelope}
    panels = [readers[child.tag](child) for child in element if child.tag in readers]
    shown = [panel for panel in panels if panel.get("curves", True)]
    return {"name": element.get("name", ""), "panels": shown}


def _bonds(component: Element) -> tuple[dict[str, Any], ...]:
    """Read the bonds; one without members, as older FMUs have them, is passed over."""
    return tuple(bond for bond in map(_bond, component.findall("Bond")) if bond["members"])


def _bond(element: Element) -> dict[str, Any]:
    names = ("name", "description", "idle")
    data: dict[str, Any] = {name: element.get(name, "") for name in names}
    members = {m.get("name", ""): m.get("variable", "") for m in element.findall("Member")}
    return {**data, "members": members, "unless": tuple(element.get("unless", "").split())}


def _panel(element: Element) -> dict[str, Any]:
    return {
        "label": element.get("label", ""),
        "unit": element.get("unit", "1"),
        "second_unit": element.get("second_unit", ""),
        "downwards": element.get("downwards") == "true",
        "common": element.get("common") == "true",
        "references": element.get("references", ""),
        "curves": [_curve(curve) for curve in element.findall("Curve")],
    }


def _envelope(element: Element) -> dict[str, Any]:
    names = ("label", "unit", "variable", "along", "ends")
    data: dict[str, Any] = {name: element.get(name, "") for name in names}
    return {**data, "at_edges": element.get("at_edges") == "true"}


def _curve(element: Element) -> dict[str, Any]:
    return {
        "variable": element.get("variable", ""),
        "label": element.get("label", ""),
        "factor": float(element.get("factor", "1")),
        "from_start": element.get("from_start") == "true",
        "dashed": element.get("dashed") == "true",
    }
