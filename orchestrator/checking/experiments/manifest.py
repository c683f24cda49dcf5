"""The manifest of FMI-LS-REF and the files of experiments that it names, read with care.

Nothing outside the FMU is looked at, whatever a manifest says.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from urllib.parse import unquote, urlsplit

from lxml import etree

from ...core.errors import InputRefused
from ...ssp.documents import parsed
from . import schemas

FOLDER = Path("extra", "org.fmi-standard.fmi-ls-ref")
MANIFEST = "fmi-ls-manifest.xml"
_MOST_BYTES = 64 << 20
"""Largest size (bytes) of a file that is read."""
EXPERIMENTS_TYPES = ("application/x-ma-hs-experiments", "application/x-ma-ls-experiments")
"""Names of the type of experiments: the second one stands in the example of FMI-LS-REF."""
SMOKE = "smoke-test"
STATE = "serialized-state"
"""Role of a state; its platform may follow behind a stroke."""
_OURS = "org.rockshed"


class Untrue(Exception):  # noqa: N818 (a statement, not a failure of this program)
    """A manifest, or a file that it names, says what is not so."""


@dataclass(frozen=True)
class Related:
    """An entry of a manifest.

    Attributes
    ----------
    source, role, type : str
        As they stand there.
    file : Path, optional
        Where it is inside the FMU.
    sha256 : str
        Its checksum, from an annotation of this program; empty where none is told.
    """

    source: str
    role: str
    type: str
    file: Path | None
    sha256: str = ""

    def content(self) -> bytes:
        """Return the content of the file.

        Raises
        ------
        Untrue
            It is not there, too large, or does not have the checksum that is told.
        """
        if self.file is None:
            raise Untrue(f"{self.source} is not in the FMU")
        found = content_of(self.file)
        checksum = hashlib.sha256(found).hexdigest()
        if self.sha256 not in ("", checksum):
            raise Untrue(
                f"{self.source} is not what the manifest says: its SHA-256 is {checksum[:12]}..., "
                f"not {self.sha256[:12]}..."
            )
        return found

    @property
    def damage(self) -> str:
        """Why its content cannot be had, in words; empty where it can."""
        try:
            self.content()
        except Untrue as untrue:
            return str(untrue)
        return ""


@dataclass(frozen=True)
class Setup:
    """An experiment as its file describes it.

    Attributes
    ----------
    name : str
        Its name.
    purpose : str
        Sub-role, ``validation``.
    start, stop, step : float, optional
        Times (s); None where nothing is said.
    tolerance : float, optional
        Share of the largest reference that results may be off.
    parameters, stimuli, references : Path, optional
        Files inside the FMU.
    tolerances : dict of str to float
        Absolute tolerances by variable, from an annotation of this program.
    state : Path, optional
        File of the state that it may begin with instead of the parameters, from such an annotation.
    """

    name: str
    purpose: str
    start: float | None = None
    stop: float | None = None
    step: float | None = None
    tolerance: float | None = None
    parameters: Path | None = None
    stimuli: Path | None = None
    references: Path | None = None
    tolerances: dict[str, float] = field(default_factory=dict)
    state: Path | None = None


def content_of(file: Path) -> bytes:
    """Return the content of a file.

    Raises
    ------
    Untrue
        It is not there, or too large.
    """
    if not file.is_file():
        raise Untrue(f"{file.name} is not in the FMU")
    size = file.stat().st_size
    if size > _MOST_BYTES:
        raise Untrue(
            f"{file.name} has {size / 1e6:.3g} MB; at most {_MOST_BYTES / 1e6:.3g} are read"
        )
    return file.read_bytes()


def place(fmu: Path, base: Path, source: str) -> Path:
    """Return the file of an address that counts from a folder inside an unpacked FMU.

    Raises
    ------
    Untrue
        It is an absolute address, leads out of the FMU, or to no file.
    """
    parts = urlsplit(source)
    if parts.scheme or parts.netloc or not parts.path:
        raise Untrue(f"{source or '(an empty address)'} is no file inside the FMU")
    file = (base / unquote(parts.path)).resolve()
    if not file.is_relative_to(fmu.resolve()):
        raise Untrue(f"{source} leads out of the FMU")
    if not file.is_file():
        raise Untrue(f"{source} is not in the FMU")
    return file


def _document(file: Path, rules: str) -> tuple[etree._Element, list[str]]:
    """Return an XML document and its departures from a schema."""
    try:
        root = parsed(content_of(file), file.name)
    except InputRefused as refused:
        raise Untrue("; ".join(str(problem) for problem in refused.problems)) from refused
    found = schemas.schema(rules)
    if found.validate(root):
        return root, []
    return root, [f"{file.name} line {e.line}: {e.message}" for e in found.error_log]


@dataclass
class Remarks:
    """Remarks on a manifest: departures from the schemas, and what is not so."""

    departures: list[str] = field(default_factory=list)
    untrue: list[str] = field(default_factory=list)


def read_manifest(fmu: Path, said: Remarks) -> list[Related]:
    """Return the entries of the manifest of an unpacked FMU.

    Parameters
    ----------
    fmu : Path
        Where it is unpacked.
    said : Remarks
        Gets the remarks.

    Raises
    ------
    Untrue
        It cannot be read at all.
    """
    base = fmu / FOLDER
    root, departures = _document(base / MANIFEST, schemas.MANIFEST)
    said.departures += departures
    related = []
    for element in root.iter("Related"):
        file = None
        source = element.get("source", "")
        try:
            file = place(fmu, base, source)
        except Untrue as untrue:
            said.untrue.append(str(untrue))
        kind = element.get("type", "application/octet-stream")
        told = [each.get("sha256", "") for each in _annotated(element, "Content")]
        related.append(Related(source, element.get("role", ""), kind, file, *told[:1]))
    told_sums = (entry for entry in related if entry.file and entry.sha256)
    said.untrue += [entry.damage for entry in told_sums if entry.damage]
    return related


def _annotated(element: etree._Element, name: str) -> Iterator[etree._Element]:
    """Yield the elements of a name in the annotations of this program."""
    for annotation in element.iter("Annotation"):
        if annotation.get("type") == _OURS:
            yield from annotation.iter(name)


def states_for(related: list[Related], platforms: tuple[str, ...]) -> list[Related]:
    """Return the states for a machine.

    Parameters
    ----------
    related : list of Related
        Entries of a manifest.
    platforms : tuple of str
        Names of the machine's platform.
    """
    roles = (STATE, *(f"{STATE}/{platform}" for platform in platforms))
    return [entry for entry in related if entry.role in roles]


def setups(fmu: Path, related: list[Related], said: Remarks) -> list[Setup]:
    """Return the experiments that a manifest names.

    Results that no experiment refers to are those of the FMU's default experiment.

    Parameters
    ----------
    fmu : Path
        Where the FMU is unpacked.
    related : list of Related
        Entries of its manifest.
    said : Remarks
        Gets the remarks.
    """
    found: list[Setup] = []
    for entry in related:
        role, _, purpose = entry.role.partition("/")
        if role != "experiment" or entry.file is None:
            continue
        if entry.type not in EXPERIMENTS_TYPES and entry.file.suffix != ".exp":
            said.untrue.append(f"{entry.source} is of the type {entry.type}, which is not known")
            continue
        try:
            found += _setups_in(fmu, entry.file, purpose or SMOKE, said)
        except Untrue as untrue:
            said.untrue.append(str(untrue))
    states = {entry.file for entry in related if entry.role.partition("/")[0] == STATE}
    for number, setup in enumerate(found):
        if setup.state and setup.state not in states:
            said.untrue.append(f"{setup.name}: {setup.state.name} is no state in the manifest")
            found[number] = replace(setup, state=None)
    known = {setup.references for setup in found}
    found += [
        Setup("default experiment", SMOKE, references=entry.file)
        for entry in related
        if entry.role == "result" and entry.type == "text/csv" and entry.file
        if entry.file not in known
    ]
    return found


def _setups_in(fmu: Path, file: Path, purpose: str, said: Remarks) -> Iterator[Setup]:
    root, departures = _document(file, schemas.EXPERIMENTS)
    said.departures += departures
    for element in root.iter("Experiment"):
        try:
            yield _setup(fmu, file, purpose, element)
        except (Untrue, ValueError) as error:
            said.untrue.append(f"{element.get('name')}: {error}")


def _setup(fmu: Path, file: Path, purpose: str, element: etree._Element) -> Setup:
    settings = element.find("TransientSimulation")
    if settings is None:  # the draft had the times among the attributes of the experiment
        kind = next((c.tag for c in element if c.tag not in _PARTS), None)
        if kind is not None:
            raise Untrue(f"is no simulation in time, but {kind}")
        settings = element
    files = {
        name: place(fmu, file.parent, part.get("source", ""))
        for name in _PARTS[:3]
        if (part := element.find(name)) is not None
    }
    tolerances = {
        each.get("variable", ""): float(each.get("absolute", "nan"))
        for each in _annotated(element, "Tolerance")
    }
    states = [each.get("source", "") for each in _annotated(element, "State")]
    return Setup(
        element.get("name", ""),
        purpose,
        _number(settings, "startTime"),
        _number(settings, "stopTime"),
        _number(settings, "stepSize"),
        _number(element, "tolerance"),
        files.get("Parameters"),
        files.get("Stimuli"),
        files.get("References"),
        tolerances,
        place(fmu, file.parent, states[0]) if states else None,
    )


_PARTS = ("Parameters", "Stimuli", "References", "Annotations")


def _number(element: etree._Element, name: str) -> float | None:
    text = element.get(name)
    return None if text is None else float(text)
