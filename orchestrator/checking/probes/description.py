"""Probes of the description, modelDescription.xml, and of the terminals."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
from fmpy.validation import validate_model_description
from lxml import etree

from ...core.errors import counted
from ..subject.subject import Subject
from ..subject.variables import Declared, listed
from ..verdicts import Seen, failed, passed, warned

_SCHEMAS = Path(fmpy.__file__).parent / "schema"
_DESCRIPTIONS = {2: "fmi2/fmi2ModelDescription.xsd", 3: "fmi3/fmi3ModelDescription.xsd"}
_TERMINALS = "fmi3/fmi3TerminalsAndIcons.xsd"


def schema(subject: Subject) -> Seen:
    """Validate the description, and in FMI 3.0 the terminals, against the schemas."""
    is_three = _is_three(subject.folder / "modelDescription.xml")
    files = {"modelDescription.xml": _DESCRIPTIONS[3 if is_three else 2]}
    if is_three:
        files["terminalsAndIcons/terminalsAndIcons.xml"] = _TERMINALS
    errors = []
    for name, xsd in files.items():
        file = subject.folder / name
        if file.is_file():
            errors += [f"{name} line {line}: {text}" for line, text in _errors(file, xsd)]
    if errors:
        return failed(listed(errors, 2), "keep to the schema of FMI")
    return passed("valid against the schemas of FMI")


def _is_three(file: Path) -> bool:
    """Tell whether a description is of FMI 3.0."""
    root = etree.parse(str(file), etree.XMLParser(resolve_entities=False)).getroot()
    return str(root.get("fmiVersion")).startswith("3")


def _errors(file: Path, xsd: str) -> list[tuple[int, str]]:
    """Return line and text of everything that breaks a schema."""
    rules = etree.XMLSchema(etree.parse(str(_SCHEMAS / xsd)))
    try:
        document = etree.parse(str(file), etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        return [(error.lineno or 0, str(error))]
    if rules.validate(document):
        return []
    return [(error.line, error.message) for error in rules.error_log]


def readable(subject: Subject) -> Seen:
    """Read the description as tools do."""
    try:
        number = len(subject.variables)
    except Exception as error:  # whatever a broken description does to the reader
        return failed(
            f"the description cannot be understood: {type(error).__name__}: {error}",
            "correct the indices and references in it",
        )
    return passed(f"{counted(number, 'variable')} that can be moved at any time")


def structure(subject: Subject) -> Seen:
    """Look at rules of FMI that the schema cannot express."""
    problems = [
        *_names(subject.model),
        *validate_model_description(subject.model, validate_model_structure=True),
    ]
    if problems:
        return failed(listed([str(problem) for problem in problems], 2), "correct the description")
    if subject.model.defaultExperiment is None:
        return warned(
            "there is no DefaultExperiment: nobody knows a step that fits",
            "tell a stepSize and a stopTime",
        )
    return passed("names, starts, causalities and ModelStructure are in order")


_PART = r"(?:[A-Za-z_]\w*|'(?:[^'\\]|\\.)+')(?:\[\d+(?:,\d+)*\])?"
_IDENTIFIER = rf"{_PART}(?:\.{_PART})*"
_STRUCTURED = re.compile(rf"{_IDENTIFIER}|der\({_IDENTIFIER}(?:,\d+)?\)", re.ASCII)
"""Names of the naming convention ``structured``. fmpy's own reader takes seconds for them."""


def _names(model: Any) -> Iterator[str]:
    """Yield the names of variables that their naming convention does not allow."""
    is_structured = model.variableNamingConvention == "structured"
    for variable in model.modelVariables:
        name = variable.name
        fits = _STRUCTURED.fullmatch(name) if is_structured else not re.search(r"[\r\n\t]", name)
        if not fits:
            yield f"{name!r} is no name of the convention {model.variableNamingConvention}"


def ranges(subject: Subject) -> Seen:
    """Look for start values beyond their own range, and ranges without a number in them."""
    wrong = [text for v in subject.variables if (text := _range_problem(v))]
    if wrong:
        return failed(listed(wrong), "correct start, min or max")
    return passed("every start value is in its declared range")


def _range_problem(variable: Declared) -> str:
    low, high = variable.lowest, variable.highest
    if low is not None and high is not None and low > high:
        return f"{variable.name}: min {low:g} exceeds max {high:g}"
    for value in variable.start or ():
        if variable.items and value not in variable.items:
            return f"{variable.name}: start {value} is no item of its enumeration"
        if isinstance(value, bool) or not isinstance(value, int | float):
            continue
        if (low is not None and value < low) or (high is not None and value > high):
            return f"{variable.name}: start {value:g} is outside min and max"
    return ""
