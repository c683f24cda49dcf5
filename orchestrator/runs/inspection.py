"""The content of an FMU or of a system, as texts and tables."""

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from pathlib import Path
from xml.etree import ElementTree

from ..checking.experiments.manifest import (
    FOLDER,
    MANIFEST,
    Remarks,
    Untrue,
    read_manifest,
    setups,
)
from ..core.errors import InputRefused, Problem
from ..core.fmu.description import Description, Port
from ..core.fmu.fmu_slave import (
    TERMINALS_FILE,
    UNREADABLE_XML,
    FmuFile,
    UnusableError,
    read_description,
)
from ..core.fmu.slave import REAL, Source
from ..core.fmu.terminals import terminals_of_bonds
from ..core.run import sources_of
from ..core.system.plan import Plan
from ..core.system.planning import make_plan
from ..core.system.system import SystemSpec
from ..core.system.values import written
from ..tables import Table
from ..temporary import TemporaryFolder
from .job import Job
from .subsystem import component_of
from .undriven import undriven

_ELEMENT = re.compile(r"\[[\d,]+\]")
_CAUSALITIES = ("parameter", "input", "output")


@dataclass(frozen=True)
class Overview:
    """Texts and tables, in the order in which they are read.

    Attributes
    ----------
    parts : sequence of str or Table
        A text is a paragraph.
    """

    parts: Sequence[str | Table]

    def __repr__(self) -> str:
        return "\n\n".join(map(str, self.parts))

    def _repr_html_(self) -> str:
        return "".join(
            part._repr_html_() if isinstance(part, Table) else f"<p>{escape(part)}</p>"
            for part in self.parts
        )


def describe_fmu(path: Path) -> Overview:
    """Describe an FMU, also a stranger's: name, flags, steps, variables, terminals.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    Overview
        A table of facts, one of the variables of each causality in which an array is one row, and
        one of the terminals.

    Raises
    ------
    InputRefused
        There is no such file, or it is no FMU for co-simulation that can be read.
    """
    file = FmuFile(path, to_run=False)
    xml = file.model_description()
    try:
        description = read_description(xml)
    except UnusableError as error:
        raise InputRefused([Problem(str(path), str(error), error.remedy)]) from error
    root = ElementTree.fromstring(xml)
    more = {
        "file": f"{path}  {path.stat().st_size / 1024:.0f} KiB",
        "platforms": ", ".join(file.platforms()) or "none",
        "experiments": _experiments(file),
    }
    facts = _facts(description, root, more)
    terminals = _terminals(file.content(TERMINALS_FILE)) or _bonds(description)
    remarks = [f"warning: {text}" for text in description.warnings] + _not_here(file)
    return Overview([facts, *_variables(description), *terminals, *remarks])


def _experiments(file: FmuFile) -> str:
    """Return how many experiments of each purpose an FMU carries."""
    if file.content((FOLDER / MANIFEST).as_posix()) is None:
        return "none"
    with TemporaryFolder() as folder:
        file.unpack(folder, FOLDER.as_posix())
        said = Remarks()
        try:
            found = setups(folder, read_manifest(folder, said), said)
        except Untrue as untrue:
            return f"cannot be read: {untrue}"
    counts = Counter(setup.purpose for setup in found)
    return ", ".join(f"{number} {purpose}" for purpose, number in counts.items()) or "none"


def _not_here(file: FmuFile) -> list[str]:
    """Return that this machine cannot run an FMU, where that is so."""
    problem = file.cannot_run
    if problem is None:
        return []
    return [f"warning: cannot run here: it {problem.what}; to run it, {problem.remedy}"]


def describe_component(name: str) -> Overview:
    """Describe a component of the catalogue in its default sizes: variables, as its FMU has them.

    Parameters
    ----------
    name : str
        Name of the component.

    Returns
    -------
    Overview
        A table of facts, and one of the variables of each causality.

    Raises
    ------
    UnknownName
        The catalogue has no component of this name.
    """
    from rockshed.fmus.description.fmi2 import model_description

    made = component_of(name)
    xml = model_description(made, made.with_sizes(), "none")
    root = ElementTree.fromstring(xml)
    sizes = ", ".join(f"{size} = {entry.default}" for size, entry in made.sizes.items())
    description = read_description(xml)
    facts = _facts(description, root, {"sizes": sizes or "none"}, ("model", "description"))
    return Overview([facts, *_variables(description)])


def _facts(
    description: Description,
    root: ElementTree.Element,
    more: Mapping[str, str],
    named: Collection[str] = (),
) -> Table:
    """Return a table of facts of a model description; of all, or of the named ones."""
    facts = Table(("", ""))
    for name, value in {
        "model": description.model,
        "description": root.get("description", ""),
        "version": root.get("version", ""),
        "FMI": root.get("fmiVersion", ""),
        "GUID": description.guid,
        "generated by": description.generation_tool,
        **more,
        **_sections(root),
    }.items():
        if not named or name in named or name in more:
            facts.add(name, value)
    return facts


def _variables(description: Description) -> list[str | Table]:
    """Return a table of the variables of each causality."""
    parts: list[str | Table] = []
    for causality in _CAUSALITIES:
        if ports := description.named(causality):
            parts.append(_ports(f"{causality}s", ports))
    others = sum(port.causality not in _CAUSALITIES for port in description.ports.values())
    if others:
        noun = "variable" if others == 1 else "variables"
        parts.append(f"and {others} {noun} of other causality")
    return parts


def _terminals(xml: bytes | None) -> list[str | Table]:
    """Return the terminals of an FMU of FMI 3.0, as its file of terminals has them."""
    if xml is None:
        return []
    try:
        found = list(ElementTree.fromstring(xml).iter("Terminal"))
    except UNREADABLE_XML as error:
        return [f"warning: {TERMINALS_FILE} cannot be read: {error}"]
    table = Table(("terminals", "members", ""))
    for terminal in found:
        members = [
            member.get("variableName", "") for member in terminal.findall("TerminalMemberVariable")
        ]
        table.add(terminal.get("name", ""), ", ".join(members), terminal.get("description", ""))
    return [table] if found else []


def _bonds(description: Description) -> list[str | Table]:
    """Return the mechanical bonds of an FMU, which are connected as terminals are."""
    words = {bond["name"]: bond["description"] for bond in description.bonds}
    table = Table(("terminals", "members", ""))
    for name, terminal in terminals_of_bonds(description).items():
        members = ", ".join(member.variable for member in terminal.members.values())
        table.add(name, members, words[name])
    return [table] if words else []


def _sections(root: ElementTree.Element) -> dict[str, str]:
    """Return default experiment and flags, as the file has them."""
    sections = {}
    experiment = root.find("DefaultExperiment")
    if experiment is not None:
        sections["default"] = ", ".join(f"{k} {v}" for k, v in experiment.attrib.items())
    flags = root.find("CoSimulation")
    said = [k for k, v in flags.attrib.items() if v == "true"] if flags is not None else []
    return {**sections, "flags": ", ".join(said) or "none"}


def _ports(title: str, ports: Iterable[Port]) -> Table:
    table = Table((title, "unit", "start", "range", ""))
    for port, number in _arrays(ports):
        name = _ELEMENT.sub(f"[1..{number}]", port.name) if number > 1 else port.name
        table.add(name, _unit(port), _start(port), _range(port), port.description)
    return table


def _arrays(ports: Iterable[Port]) -> Iterator[tuple[Port, int]]:
    """Yield the first element of each array with their number; a scalar is an array of one."""
    for _, elements in groupby(ports, lambda port: _ELEMENT.sub("[]", port.name)):
        listed = list(elements)
        yield listed[0], len(listed)


def _unit(port: Port) -> str:
    return port.unit_name if port.unit_name != "1" else ""


def _start(port: Port) -> str:
    if port.start is None:
        return ""
    try:
        value = written(port, float(port.start))
    except ValueError:  # text, true or false
        return port.start
    return str(value) if port.items else f"{value:.6g}"


def _range(port: Port) -> str:
    if port.items:
        return " | ".join(f"{number} = {name}" for name, number in port.items.items())
    if port.minimum is None and port.maximum is None:
        return "" if port.kind == REAL else port.kind
    low, high = ("" if bound is None else f"{bound:g}" for bound in (port.minimum, port.maximum))
    return f"{low} .. {high}"


def describe_system(job: Job) -> Overview:
    """Describe a system: components, values that differ from the FMUs' own, connections, bonds.

    Parameters
    ----------
    job : Job
        The system with the sources of its components.

    Returns
    -------
    Overview
        Texts, and tables of components, values and shared values.

    Raises
    ------
    InputRefused
        The system does not fit its FMUs.
    """
    system = job.system
    sources = {**sources_of(system, to_run=False), **job.sources}
    with job.refused_in_place():
        plan = make_plan(system, sources)
    parts: list[str | Table] = [
        f"{system.name}{': ' if system.description else ''}{system.description}\n"
        f"{system.master} master, order {', '.join(plan.order)}; exchange every "
        f"{system.exchange_step:g} s until {system.stop_time:g} s; {len(plan.inputs)} values a "
        f"time in {len(system.connections)} connections"
    ]
    components = Table(("component", "model", "step (s)", "FMU"))
    for name in system.components:
        components.add(
            name, plan.descriptions[name].model, f"{system.step(name):g}", job.fmus[name]
        )
    parts.append(components)
    if len(values := _values(plan)):
        parts.append(values)
    if system.shared:
        parts.append(_shared(system))
    if system.bonds:
        bonds = (f"{name} ({bond.giver} -> {bond.taker})" for name, bond in system.bonds.items())
        parts.append(f"power bonds: {', '.join(bonds)}")
    if plan.scenario:
        parts.append(_scenario(plan))
    for when, loops in (("", plan.loops), (" at the start", plan.loops_at_start)):
        parts += [f"algebraic loop{when}: {loop}" for loop in loops]
    parts += [f"warning: {text}" for text in undriven(plan)]
    return Overview([*parts, *_that_cannot_run(sources)])


def _that_cannot_run(sources: Mapping[str, Source]) -> list[str]:
    """Return for each component whose FMU this machine cannot run, that it is so."""
    problems = {name: getattr(source, "cannot_run", None) for name, source in sources.items()}
    return [
        f"warning: {name} cannot run here: {problem.where} {problem.what}; to run it, "
        f"{problem.remedy}"
        for name, problem in problems.items()
        if problem is not None
    ]


def _scenario(plan: Plan) -> Table:
    """Return what happens to the system from outside, in the order in which it is given."""
    timing = plan.timing
    table = Table(("scenario", "port", "from"))
    for end in plan.scenario.driven:
        table.add("column of inputs", end.name, f"{timing.seconds(0):g} s")
    for switch in plan.scenario.switches:
        at = (
            switch.condition.text
            if switch.condition
            else f"{timing.seconds(switch.exchange or 0):g} s"
        )
        table.add(f"= {switch.value:g}", switch.end.name, at)
    for fault in plan.scenario.faults:
        span = f"{timing.seconds(fault.begin):g} s to {timing.seconds(fault.stop):g} s"
        table.add(fault.kind, fault.end.name, span)
    return table


def _values(plan: Plan) -> Table:
    """Return the values that differ from the FMUs' own."""
    values = Table(("value", "", "unit", "FMU's own", " "))
    for name in plan.order:
        for port, value in plan.starts[name]:
            shown = _short(value if isinstance(value, str) else written(port, value))
            if shown != (own := _short(_own(port))):
                values.add(f"{name}.{port.name}", shown, _unit(port), own, port.description)
    return values


def _own(port: Port) -> str:
    try:
        return str(written(port, float(port.start or "nan")))
    except ValueError:
        return port.start or ""


def _short(value: object) -> str:
    try:
        return f"{float(str(value)):.6g}"
    except ValueError:
        return str(value)


def _shared(system: SystemSpec) -> Table:
    table = Table(("shared value", "", "set in"))
    for name, entry in system.shared.items():
        table.add(name, _short(entry.value), ", ".join(entry.targets))
    return table
