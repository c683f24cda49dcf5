"""Annotations of a model description for what FMI has no words for.

They tell roles, older names, figures, pictures and power bonds. Each variable that has any, and the
component, carry an element with the name of this program; other tools pass it over.
"""

from dataclasses import fields
from typing import Any

from lxml import etree

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Bond, Variable

TOOL = "org.rockshed"
"""Name of the tool that the annotations are for."""
_OF_VARIABLES = ("role", "label", "formerly", "reported")
_OF_COMPONENTS = ("contents", "pictures")
_OF_BONDS = ("name", "description", "idle", "unless")


def of_variable(variable: Variable) -> etree._Element | None:
    """Return the annotation of a variable, or None where nothing is to be told.

    Parameters
    ----------
    variable : Variable
        Its declaration.
    """
    return _filled(etree.Element("Variable"), variable, _OF_VARIABLES)


def of_component(component: Component) -> etree._Element | None:
    """Return the annotation of a component, or None where nothing is to be told.

    Parameters
    ----------
    component : Component
        Its declaration.
    """
    element = etree.Element("Component")
    element.extend(_bond(bond, component) for bond in component.bonds)
    return _filled(element, component, _OF_COMPONENTS)


def _bond(bond: Bond, component: Component) -> etree._Element:
    """Return the element of a bond, with the variable of each of its members."""
    element = etree.Element("Bond")
    _filled(element, bond, _OF_BONDS)
    for member, variable in bond.members(component.layout.variables).items():
        etree.SubElement(element, "Member", name=member, variable=variable.name)
    return element


def _filled(element: etree._Element, declared: Any, names: tuple[str, ...]) -> Any:
    """Fill in the fields that are set: text as attributes, declarations as children.

    Returns None where there are none.
    """
    for name in names:
        value = getattr(declared, name)
        if isinstance(value, tuple) and not all(isinstance(entry, str) for entry in value):
            element.extend(_child(entry) for entry in value)
        elif value:
            element.set(name, _text(value))
    return element if element.attrib or len(element) else None


def _child(declared: Any) -> etree._Element:
    """Return the element of a declaration, which is named after its class."""
    names = tuple(field.name for field in fields(declared))
    element = etree.Element(type(declared).__name__)
    _filled(element, declared, names)
    return element


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return " ".join(value)
    return "true" if value is True else str(value)
