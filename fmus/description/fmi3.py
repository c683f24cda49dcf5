"""The ``modelDescription.xml`` and ``terminalsAndIcons.xml`` of FMI 3.0.

An array is one variable, a power bond is a terminal.
"""

from importlib.metadata import version

from lxml import etree

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Bond, Causality, Kind, Sizes, Variable
from rockshed.components.common.units import UNITS

from ..parts import Files, Runtime, picture
from . import annotations
from .fmi2 import (
    add_items,
    enumeration_name,
    generation_tool,
    initial,
    literal,
    log_categories_and_experiment,
    type_and_bounds,
    unit_definitions,
    used_units,
    variability,
)

FMI_VERSION = "3.0"
TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
INTERNAL_STEP = "internal_step"
"""Name of the parameter that has the length of internal steps."""
TIME = "time"
"""Name of the independent variable."""
_TIME_UNIT = "s"

_CAPABILITIES = {
    "needsExecutionTool": "false",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "canHandleVariableCommunicationStepSize": "true",
}
_TYPES = {
    Kind.REAL: "Float64",
    Kind.INTEGER: "Int32",
    Kind.BOOLEAN: "Boolean",
    Kind.ENUMERATION: "Enumeration",
}
_TERMINAL_KIND = "_rockshed_mechanical_bond"
_ICON_CORNERS = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}


def model_description(component: Component, sizes: Sizes, token: str) -> bytes:
    """Return the complete ``modelDescription.xml`` of a native FMU of FMI 3.0.

    The value reference of a variable is that of its (first element's) scalar in FMI 2.0; sizes and
    time stand last.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        Sizes that the FMU is built with.
    token : str
        Identifies the content of the FMU.
    """
    root = etree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": FMI_VERSION,
            "modelName": component.name,
            "instantiationToken": token,
            "description": component.title,
            "author": "the rockshed authors",
            "version": version("rockshed"),
            "copyright": "the rockshed authors",
            "license": "MIT",
            "generationTool": generation_tool(Runtime.NATIVE),
            "variableNamingConvention": "structured",
        },
    )
    early = {"mightReturnEarlyFromDoStep": "true"} if component.next_event else {}
    more = early | _internal_step(component, sizes)
    etree.SubElement(
        root, "CoSimulation", {"modelIdentifier": component.name, **_CAPABILITIES, **more}
    )
    unit_definitions(root, component, [_TIME_UNIT])
    _type_definitions(root, component)
    log_categories_and_experiment(root, component)
    references = value_references(component, sizes)
    _model_variables(root, component, sizes, references)
    _model_structure(root, component, references)
    _annotate(root, annotations.of_component(component))
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def _internal_step(component: Component, sizes: Sizes) -> dict[str, str]:
    """Return the attribute fixedInternalStepSize, where the component divides every step so.

    One that goes from event to event has no such step, and an internal step that is longer than
    the communication step proposed is only a bound.
    """
    for variable in component.layout.variables:
        step = variable.start_at(0, sizes) if variable.name == INTERNAL_STEP else 0.0
        if 0.0 < step <= component.default_step and component.next_event is None:
            return {"fixedInternalStepSize": repr(step)}
    return {}


def value_references(component: Component, sizes: Sizes) -> dict[str, int]:
    """Return the value reference of every variable, then of the sizes, then of the time.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.

    Returns
    -------
    dict of str to int
        Value reference by name.
    """
    references = {}
    following = 0
    for variable in component.layout.ordered:
        references[variable.name] = following
        following += len(variable.element_names(sizes))
    return references | {name: following + number for number, name in enumerate([*sizes, TIME])}


def _type_definitions(root: etree._Element, component: Component) -> None:
    definitions = etree.SubElement(root, "TypeDefinitions")
    for unit in used_units(component):
        etree.SubElement(
            definitions,
            "Float64Type",
            name=UNITS[unit].quantity,
            quantity=UNITS[unit].quantity,
            unit=unit,
        )
    for variable in component.layout.ordered:
        if variable.kind is Kind.ENUMERATION:
            add_items(
                etree.SubElement(
                    definitions,
                    "EnumerationType",
                    name=enumeration_name(component, variable),
                    description=variable.description,
                ),
                variable,
            )


def _model_variables(
    root: etree._Element, component: Component, sizes: Sizes, references: dict[str, int]
) -> None:
    variables = etree.SubElement(root, "ModelVariables")
    for variable in component.layout.ordered:
        element = etree.SubElement(
            variables,
            _TYPES[variable.kind],
            {
                "name": variable.name,
                "valueReference": str(references[variable.name]),
                "description": variable.description,
                "causality": variable.causality.value,
                "variability": variability(variable),
                **initial(variable),
                **type_and_bounds(component, variable),
                **_start(variable, sizes),
            },
        )
        _annotate(element, annotations.of_variable(variable))
        if variable.size is not None:
            etree.SubElement(element, "Dimension", start=str(sizes[variable.size]))
    for name, value in sizes.items():
        _size(variables, name, value, component.sizes[name].description, references[name])
    etree.SubElement(
        variables,
        "Float64",
        name=TIME,
        valueReference=str(references[TIME]),
        description="time",
        causality="independent",
        variability="continuous",
        unit=_TIME_UNIT,
    )


def _size(
    variables: etree._Element, name: str, value: int, description: str, reference: int
) -> None:
    """Append a size, which is a constant that arrays refer to."""
    etree.SubElement(
        variables,
        "Int32",
        {
            "name": name,
            "valueReference": str(reference),
            "description": description,
            "causality": "local",
            "variability": "constant",
            "initial": "exact",
            "start": str(value),
        },
    )


def _annotate(parent: etree._Element, annotation: etree._Element | None) -> None:
    """Add an annotation, if there is one."""
    if annotation is not None:
        entries = etree.SubElement(parent, "Annotations")
        etree.SubElement(entries, "Annotation", type=annotations.TOOL).append(annotation)


def _start(variable: Variable, sizes: Sizes) -> dict[str, str]:
    """Return the start values of all elements; outputs have none."""
    if variable.causality is Causality.OUTPUT:
        return {}
    numbers = range(len(variable.element_names(sizes)))
    return {
        "start": " ".join(
            literal(variable.kind, variable.start_at(number, sizes)) for number in numbers
        )
    }


def _model_structure(
    root: etree._Element, component: Component, references: dict[str, int]
) -> None:
    """Append outputs and initial unknowns.

    No output depends on an input between two steps; what it depends on at the start is declared
    with it.
    """
    structure = etree.SubElement(root, "ModelStructure")
    outputs = [v for v in component.layout.ordered if v.causality is Causality.OUTPUT]
    for variable in outputs:
        etree.SubElement(
            structure, "Output", valueReference=str(references[variable.name]), dependencies=""
        )
    for variable in outputs:
        known = variable.initial_dependencies
        # without the attribute an unknown depends on everything known: all parameters and inputs
        depends = (
            {}
            if known is None
            else {"dependencies": " ".join(str(references[name]) for name in known)}
        )
        etree.SubElement(
            structure,
            "InitialUnknown",
            {"valueReference": str(references[variable.name]), **depends},
        )


# --- terminals and icon


def terminals_and_icon(component: Component) -> Files:
    """Return terminals of the power bonds and the icon, as far as the component has them.

    Parameters
    ----------
    component : Component
        The component.

    Returns
    -------
    Files
        Content by path; empty without bonds and icon.
    """
    icon = picture(component, "terminalsAndIcons/icon.png")
    if not icon and not component.bonds:
        return {}
    root = etree.Element("fmiTerminalsAndIcons", fmiVersion=FMI_VERSION)
    if icon:
        etree.SubElement(etree.SubElement(root, "GraphicalRepresentation"), "Icon", _ICON_CORNERS)
    if component.bonds:
        etree.SubElement(root, "Terminals").extend(
            [_terminal(bond, component) for bond in component.bonds]
        )
    return icon | {
        TERMINALS: etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)
    }


def _terminal(bond: Bond, component: Component) -> etree._Element:
    """Return the terminal of a power bond.

    Both ends of a bond have the same values: the force is that on the body on either side, so it is
    a signal, and no flow.
    """
    terminal = etree.Element(
        "Terminal",
        name=bond.name,
        matchingRule="plug",
        terminalKind=_TERMINAL_KIND,
        description=bond.description,
    )
    for member, variable in bond.members(component.layout.variables).items():
        etree.SubElement(
            terminal,
            "TerminalMemberVariable",
            variableName=variable.name,
            memberName=member,
            variableKind="signal",
        )
    return terminal
