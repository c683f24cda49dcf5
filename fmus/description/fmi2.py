"""The ``modelDescription.xml`` of FMI 2.0, derived from a component's declarations.

That of FMI 3.0, :mod:`rockshed.fmus.description.fmi3`, shares what does not differ.
"""

from collections.abc import Collection, Mapping
from importlib.metadata import version

from lxml import etree

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Causality, Kind, Sizes, Variable
from rockshed.components.common.units import UNITS

from ..parts import Runtime
from ..python.conduct import LOG_CATEGORIES
from . import annotations

_CAPABILITIES = {
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "maxOutputDerivativeOrder": "0",
    "canRunAsynchronuously": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    # the shim allocates for itself, as pythonfmu's binary and Python do
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "false",
}


_NEEDS_TOOL = {Runtime.PYTHON: "true", Runtime.NATIVE: "false"}
"""An FMU with Python needs one with numpy and numba on the computer; the name of the tool stands in
generationTool."""


def generation_tool(runtime: Runtime) -> str:
    """Return the attribute ``generationTool``.

    Parameters
    ----------
    runtime : Runtime
        What carries out the kernels.
    """
    if runtime is Runtime.NATIVE:
        return f"rockshed {version('rockshed')}, native code"
    made_with = f"rockshed {version('rockshed')} with PythonFMU {version('pythonfmu')}"
    return f"{made_with}; runs in Python >= 3.11 with numpy and numba"


def model_description(
    component: Component, sizes: Mapping[str, int], guid: str, runtime: Runtime = Runtime.PYTHON
) -> bytes:
    """Return the complete ``modelDescription.xml``.

    The index of a variable is its value reference + 1; the sizes stand last.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        Sizes that the FMU is built with.
    guid : str
        Identifies the content of the FMU.
    runtime : Runtime
        What carries out the kernels.
    """
    root = etree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": component.name,
            "guid": guid,
            "description": component.title,
            "author": "the rockshed authors",
            "version": version("rockshed"),
            "copyright": "the rockshed authors",
            "license": "MIT",
            "generationTool": generation_tool(runtime),
            "variableNamingConvention": "structured",
        },
    )
    etree.SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": component.name,
            "needsExecutionTool": _NEEDS_TOOL[runtime],
            **_CAPABILITIES,
        },
    )
    unit_definitions(root, component)
    _type_definitions(root, component)
    log_categories_and_experiment(root, component)
    _annotate(root, "VendorAnnotations", annotations.of_component(component))
    _model_variables(root, component, sizes)
    _model_structure(root, component, sizes)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


_TOLERANCE = 1e-3
"""Relative accuracy that is meant with the steps of the start values; a round figure, no bound.

Most experiments keep 1e-6, single ones of sand and beam allow up to 2 %: what holds for an output
stands there. What an importer asks for changes nothing, as the internal step is a parameter."""


def log_categories_and_experiment(root: etree._Element, component: Component) -> None:
    """Append the elements LogCategories and DefaultExperiment to the root.

    Parameters
    ----------
    root : Element
        Root of the description, which grows.
    component : Component
        The component.
    """
    categories = etree.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        etree.SubElement(categories, "Category", name=name, description=description)
    etree.SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=repr(component.default_stop_time),
        tolerance=repr(_TOLERANCE),
        stepSize=repr(component.default_step),
    )


def used_units(component: Component) -> list[str]:
    """Return the units of the component's variables, in the order of :data:`UNITS`.

    Parameters
    ----------
    component : Component
        The component.

    Returns
    -------
    list of str
    """
    used = {v.unit for v in component.layout.variables if v.kind is Kind.REAL}
    return [unit for unit in UNITS if unit in used]


def unit_definitions(
    root: etree._Element, component: Component, others: Collection[str] = ()
) -> None:
    """Append the element UnitDefinitions to the root.

    Parameters
    ----------
    root : Element
        Root of the description, which grows.
    component : Component
        The component.
    others : collection of str
        Units that are defined besides those of its variables.
    """
    definitions = etree.SubElement(root, "UnitDefinitions")
    used = used_units(component)
    for name in [unit for unit in UNITS if unit in used or unit in others]:
        exponents = {base: str(exponent) for base, exponent in UNITS[name].base.items()}
        factor = {} if UNITS[name].factor == 1.0 else {"factor": repr(UNITS[name].factor)}
        etree.SubElement(
            etree.SubElement(definitions, "Unit", name=name), "BaseUnit", {**exponents, **factor}
        )


def _type_definitions(root: etree._Element, component: Component) -> None:
    definitions = etree.SubElement(root, "TypeDefinitions")
    for unit in used_units(component):
        simple_type = etree.SubElement(definitions, "SimpleType", name=UNITS[unit].quantity)
        etree.SubElement(simple_type, "Real", quantity=UNITS[unit].quantity, unit=unit)
    for variable in component.layout.ordered:
        if variable.kind is Kind.ENUMERATION:
            simple_type = etree.SubElement(
                definitions,
                "SimpleType",
                name=enumeration_name(component, variable),
                description=variable.description,
            )
            add_items(etree.SubElement(simple_type, "Enumeration"), variable)


def add_items(enumeration: etree._Element, variable: Variable) -> None:
    """Append the words of an enumeration with their numbers.

    Parameters
    ----------
    enumeration : Element
        Type of the enumeration, which grows.
    variable : Variable
        Its declaration.
    """
    for value, word in enumerate(variable.choices, start=1):
        etree.SubElement(enumeration, "Item", name=word, value=str(value))


def enumeration_name(component: Component, variable: Variable) -> str:
    """Return the name of the type of an enumeration.

    Parameters
    ----------
    component : Component
        The component.
    variable : Variable
        Its declaration.

    Returns
    -------
    str
    """
    return f"{component.name}.{variable.name}"


def _model_variables(root: etree._Element, component: Component, sizes: Sizes) -> None:
    variables = etree.SubElement(root, "ModelVariables")
    reference = 0
    for variable in component.layout.ordered:
        for number, name in enumerate(variable.element_names(sizes)):
            _variable(
                variables, component, variable, name, reference, variable.start_at(number, sizes)
            )
            reference += 1
    for name, value in sizes.items():
        constant = etree.SubElement(
            variables,
            "ScalarVariable",
            {
                "name": name,
                "valueReference": str(reference),
                "description": component.sizes[name].description,
                "causality": "local",
                "variability": "constant",
                "initial": "exact",
            },
        )
        etree.SubElement(constant, "Integer", start=str(value))
        reference += 1


def _variable(
    parent: etree._Element,
    component: Component,
    variable: Variable,
    name: str,
    reference: int,
    start: float,
) -> None:
    scalar = etree.SubElement(
        parent,
        "ScalarVariable",
        {
            "name": name,
            "valueReference": str(reference),
            "description": variable.description,
            "causality": variable.causality.value,
            "variability": variability(variable),
            **initial(variable),
        },
    )
    attributes = type_and_bounds(component, variable)
    if variable.causality is not Causality.OUTPUT:
        attributes["start"] = literal(variable.kind, start)
    etree.SubElement(scalar, variable.kind.value, attributes)
    _annotate(scalar, "Annotations", annotations.of_variable(variable))


def _annotate(parent: etree._Element, name: str, annotation: etree._Element | None) -> None:
    """Add an annotation, if there is one."""
    if annotation is not None:
        tools = etree.SubElement(parent, name)
        etree.SubElement(tools, "Tool", name=annotations.TOOL).append(annotation)


def initial(variable: Variable) -> dict[str, str]:
    """Return the attribute ``initial``; inputs have none.

    Parameters
    ----------
    variable : Variable
        Its declaration.

    Returns
    -------
    dict of str to str
        Attribute by its name, empty for an input.
    """
    kinds = {Causality.PARAMETER: "exact", Causality.OUTPUT: "calculated"}
    return {"initial": kinds[variable.causality]} if variable.causality in kinds else {}


def type_and_bounds(component: Component, variable: Variable) -> dict[str, str]:
    """Return the attributes that tell a variable's type, unit and range.

    Parameters
    ----------
    component : Component
        The component.
    variable : Variable
        Its declaration.

    Returns
    -------
    dict of str to str
        Attributes by name.
    """
    attributes = {}
    if variable.kind is Kind.REAL:
        attributes = {"declaredType": UNITS[variable.unit].quantity, "unit": variable.unit}
    elif variable.kind is Kind.ENUMERATION:
        attributes = {"declaredType": enumeration_name(component, variable)}
    if variable.kind is not Kind.BOOLEAN:
        bounds = {"min": variable.minimum, "max": variable.maximum}
        attributes |= {
            key: literal(variable.kind, bound) for key, bound in bounds.items() if bound is not None
        }
    return attributes


def variability(variable: Variable) -> str:
    """Return the attribute ``variability`` of a variable.

    Parameters
    ----------
    variable : Variable
        Its declaration.

    Returns
    -------
    str
        As FMI names it.
    """
    if variable.causality is Causality.PARAMETER:
        return "fixed"
    return "continuous" if variable.kind is Kind.REAL else "discrete"


def literal(kind: Kind, value: float) -> str:
    """Return a value as XML writes it for a variable of this kind.

    Parameters
    ----------
    kind : Kind
        Kind of the variable.
    value : float
        The value.

    Returns
    -------
    str
    """
    if kind is Kind.REAL:
        return repr(float(value))
    return str(bool(value)).lower() if kind is Kind.BOOLEAN else str(int(value))


def _model_structure(root: etree._Element, component: Component, sizes: Sizes) -> None:
    """Append outputs and initial unknowns.

    No output depends on an input between two steps; what it depends on at the start is declared
    with it.
    """
    indices: dict[str, list[int]] = {}
    for variable in component.layout.ordered:
        first = 1 + sum(map(len, indices.values()))
        indices[variable.name] = list(range(first, first + len(variable.element_names(sizes))))
    structure = etree.SubElement(root, "ModelStructure")
    outputs = etree.SubElement(structure, "Outputs")
    unknowns = etree.SubElement(structure, "InitialUnknowns")
    for variable in component.layout.ordered:
        if variable.causality is Causality.OUTPUT:
            known = variable.initial_dependencies
            # without the attribute an unknown depends on everything known: all parameters and
            # inputs
            depends = (
                {}
                if known is None
                else {"dependencies": " ".join(str(i) for name in known for i in indices[name])}
            )
            for index in indices[variable.name]:
                etree.SubElement(outputs, "Unknown", index=str(index), dependencies="")
                etree.SubElement(unknowns, "Unknown", {"index": str(index), **depends})
