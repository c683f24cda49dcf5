"""An SSP written again: its documents as they are, with other values, times or version in them."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from lxml import etree

from ..core.errors import InputRefused, Problem
from ..core.fmu.annotations import TOOL
from ..core.fmu.description import Port
from ..core.system.plan import Plan
from .documents import SSD, SSM, SSV, as_bytes, parsed, schema_problems
from .hints import annotation, hints_element
from .links import whole_arrays
from .reading import Imported
from .writing import hints_of, parameter_set, write_archive

_BEFORE_BINDINGS = ("Connectors", "ElementGeometry")
_BEHIND_SYSTEM = ("System", "Enumerations", "Units")
_DOCUMENTS = (".ssd", ".ssv", ".ssm")

Change = tuple[str, Port, float | str]
"""A component, a variable and what it gets."""


def rewrite_ssp(
    imported: Imported,
    plan: Plan,
    changes: Iterable[Change],
    file: Path,
    ssp_version: str | None = None,
) -> None:
    """Write an SSP again; what this program knows nothing of is kept.

    Parameters
    ----------
    imported : Imported
        The SSP.
    plan : Plan
        Its system as it is to be.
    changes : iterable of (str, Port, float or str)
        Values that are other than in the SSP: they become its last parameter binding.
    file : Path
        A new file.
    ssp_version : str, optional
        Version of all documents; by default they keep theirs.

    Raises
    ------
    InputRefused
        There is such a file, it cannot be written, or a document has elements that the version
        does not have.
    """
    package = imported.package
    contents: dict[str, bytes] = {}
    copied: dict[str, Path] = {}
    problems: list[Problem] = []
    for name in {package.main: None, **dict.fromkeys(package.names())}:
        if Path(name).suffix in _DOCUMENTS:
            content = (package.folder / name).read_bytes()
            contents[name] = _in_version(name, content, ssp_version, problems)
        else:
            copied[name] = package.folder / name
    if problems:
        raise InputRefused(problems)
    changed = list(changes)
    if changed or imported.options:
        root = parsed(contents[package.main], package.main)
        _change(root, imported, plan, changed)
        contents[package.main] = as_bytes(root)
    write_archive(file, contents, copied)


def _in_version(
    name: str, content: bytes, ssp_version: str | None, problems: list[Problem]
) -> bytes:
    """Return a document in a version of the standard; the very bytes where it is in it."""
    if ssp_version is None:
        return content
    root = parsed(content, name)
    if root.get("version") == ssp_version:
        return content
    for xml in root.iter(f"{{{SSD}}}*", f"{{{SSV}}}*", f"{{{SSM}}}*"):
        if "version" in xml.attrib:
            xml.set("version", ssp_version)
    problems += schema_problems(root, name, ssp_version)
    return as_bytes(root)


def _change(root: etree._Element, imported: Imported, plan: Plan, changes: list[Change]) -> None:
    system = root.find(f"{{{SSD}}}System")
    if changes:
        group = _group(system, "ParameterBindings", _BEFORE_BINDINGS)
        group.append(_binding(imported.names, changes, plan, root.get("version", "")))
    if imported.options:
        _set_times(root, imported, plan)
        own = annotation(system, TOOL)
        if own is not None:
            own.getparent().remove(own)
        annotations = system.find(f"{{{SSD}}}Annotations")
        if annotations is None:
            annotations = etree.SubElement(system, f"{{{SSD}}}Annotations")
        annotations.append(hints_element(hints_of(plan.system)))


def _binding(
    names: Mapping[str, str], changes: list[Change], plan: Plan, ssp_version: str
) -> etree._Element:
    """Return a binding of the outermost system, whose values go before all others."""
    binding = etree.Element(f"{{{SSD}}}ParameterBinding")
    values = etree.SubElement(binding, f"{{{SSD}}}ParameterValues")
    made = parameter_set(TOOL, (), ssp_version)
    for component in dict.fromkeys(component for component, _, _ in changes):
        arrays = {port.array for owner, port, _ in changes if owner == component}
        starts = [start for start in plan.starts[component] if start[0].array in arrays]
        whole = whole_arrays(plan.descriptions[component], starts)
        own = parameter_set(TOOL, whole, ssp_version, f"{names[component]}.")
        made[0].extend(own[0])
    values.append(made)
    return binding


def _set_times(root: etree._Element, imported: Imported, plan: Plan) -> None:
    experiment = _group(root, "DefaultExperiment", _BEHIND_SYSTEM)
    for key, attribute in (("start_time", "startTime"), ("stop_time", "stopTime")):
        if key in imported.options:
            experiment.set(attribute, repr(float(getattr(plan.system, key))))


def _group(parent: etree._Element, name: str, before: Iterable[str]) -> etree._Element:
    """Return a child; it is made behind those that stand before it where there is none."""
    found = parent.find(f"{{{SSD}}}{name}")
    if found is None:
        found = etree.Element(f"{{{SSD}}}{name}")
        tags = {f"{{{SSD}}}{other}" for other in before}
        parent.insert(sum(child.tag in tags for child in parent), found)
    return found
