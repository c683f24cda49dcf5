"""The check of an FMU: every probe of the table, each in processes of its own."""

import os
import zipfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from ..core.errors import InputRefused, Problem, all_causes
from ..core.fmu.archive import MOST_DESCRIPTION, Archive, ArchiveError
from ..core.system.names import nearest
from ..temporary import TemporaryFolder
from .processes import Server
from .server import ProbeJob
from .table import PROBES, Probe
from .verdicts import BAD, Check, Finding, Seen, Verdict, not_applicable

TIME_LIMIT = 30.0
"""Time (s) after which a process of a probe is ended."""
_DESCRIPTION = "modelDescription.xml"
_VERSIONS = ("2.0", "3.0")

ProbesCounted = Callable[[int, int], None]
"""Called with the number of probes done and that of all."""


@dataclass(frozen=True)
class _About:
    """Name, version of FMI and tool of an FMU."""

    model: str
    version: str
    tool: str


def check_fmu(
    fmu: str | Path,
    *,
    probes: Sequence[str] = (),
    step_size: float | None = None,
    time_limit: float = TIME_LIMIT,
    counted: ProbesCounted = lambda done, total: None,
) -> Check:
    """Check an FMU for co-simulation, FMI 2.0 or 3.0, of any origin.

    Its code runs, in processes of their own: a crash, an exit and a hang are findings.

    Parameters
    ----------
    fmu : str or Path
        The file.
    probes : sequence of str
        Names of probes, ``state/rollback``, or of themes, ``state``; by default all. What they need
        runs as well.
    step_size : float, optional
        Communication step (s); by default that of the FMU's description.
    time_limit : float
        Time (s) after which a process is ended.
    counted : callable
        Called after each probe with the numbers of those done and of all.

    Returns
    -------
    Check
        A finding for each probe; ``check.ok`` tells whether none has failed.

    Raises
    ------
    InputRefused
        There is no such file, it is no FMU, or one that has no co-simulation.

    Examples
    --------
    >>> import rockshed
    >>> fmu = rockshed.build_fmu("FallingRock", folder="fmus")
    >>> check = rockshed.check_fmu(fmu, probes=["description"])
    >>> check.ok
    True
    >>> check["description/schema"].what
    'valid against the schemas of FMI'
    """
    file = Path(fmu)
    with all_causes(lambda: _chosen(probes), lambda: _about(file)):
        if problems := [*_number_problems(step_size, time_limit)]:
            raise InputRefused(problems)
        chosen, about = _chosen(probes), _about(file)
    asked = [p for p in chosen if p.version in (0, int(about.version[0]))]
    with TemporaryFolder("rockshed-") as folder, Server() as server:
        run = _Running(file.absolute(), folder, server, step_size, time_limit)
        findings = []
        for number, probe in enumerate(asked, 1):
            findings.append(run.finding(probe))
            counted(number, len(asked))
    return Check(file, about.model, about.version, about.tool, tuple(findings))


def _number_problems(step_size: float | None, time_limit: float) -> Iterator[Problem]:
    for name, value in (("step_size", step_size), ("time_limit", time_limit)):
        if value is not None and not 0.0 < value < float("inf"):
            yield Problem(name, f"{value:g} is no positive number of seconds", "give one above 0")


def _chosen(names: Sequence[str]) -> list[Probe]:
    """Return the probes of some names and those that they need, in their order."""
    if not names:
        return list(PROBES)
    known = {probe.name: probe for probe in PROBES}
    themes = {probe.theme for probe in PROBES}
    wanted = {p.name for p in PROBES if p.name in names or p.theme in names}
    unknown = [name for name in names if name not in known and name not in themes]
    if unknown:
        every = [*themes, *known]
        raise InputRefused(
            [Problem(name, "is no probe and no theme", nearest(name, every)) for name in unknown]
        )
    while needed := {known[name].needs for name in wanted} - wanted - {""}:
        wanted |= needed
    return [probe for probe in PROBES if probe.name in wanted]


# ---------------------------------------------------------------- the file


def _about(file: Path) -> _About:
    """Return what an FMU tells of itself; refuse what is none."""
    if not os.path.isfile(file):
        what = "is a folder" if os.path.isdir(file) else "there is no such file"
        raise InputRefused([Problem(str(file), what, "name an FMU, a file that ends in .fmu")])
    xml = _description(file)
    if xml is None:
        what = f"is no FMU: there is no {_DESCRIPTION} in it"
        is_ssp = file.suffix.lower() == ".ssp"
        remedy = "it is an SSP: unpack it, and check the FMUs in its folder resources"
        raise InputRefused([Problem(str(file), what, remedy if is_ssp else "export it again")])
    try:
        root = ElementTree.fromstring(xml)
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        what = f"its {_DESCRIPTION} cannot be read: {error}"
        raise InputRefused([Problem(str(file), what, "export it again")]) from error
    version = root.get("fmiVersion") or "without a version"
    if not version.startswith(_VERSIONS):
        what = f"is FMI {version}; FMI 2.0 and 3.0 are checked"
        raise InputRefused([Problem(str(file), what, "export it for one of them")])
    if root.find("CoSimulation") is None:
        what = "has no co-simulation, which is what is checked"
        raise InputRefused([Problem(str(file), what, "export it for co-simulation")])
    return _About(root.get("modelName") or "", version, root.get("generationTool") or "")


def _description(file: Path) -> bytes | None:
    """Return the description in a zip archive, also one whose other names lead outside."""
    try:
        with zipfile.ZipFile(file) as archive:
            info = archive.getinfo(_DESCRIPTION)
            if info.file_size > MOST_DESCRIPTION:
                raise ArchiveError(f"has a {_DESCRIPTION} of {info.file_size / 1e6:.3g} MB")
            return archive.read(info)
    except KeyError:
        return None
    except ArchiveError as error:
        raise InputRefused([Problem(str(file), str(error), error.remedy)]) from error
    except (OSError, RuntimeError, ValueError, zipfile.BadZipFile, NotImplementedError) as error:
        what = f"is no FMU, or damaged: {error}"
        raise InputRefused([Problem(str(file), what, "export it again")]) from error


# ---------------------------------------------------------------- the probes


class _Running:
    """Runs probes one after the other, and knows what others have found."""

    def __init__(
        self, file: Path, folder: Path, server: Server, step: float | None, limit: float
    ) -> None:
        self._file = file
        self._folder = folder
        self._server = server
        self._step = step
        self._limit = limit
        self._verdicts: dict[str, Verdict] = {}
        self._causes: dict[str, str] = {}
        self._unpacked: str | None = None
        self._count = 0

    def finding(self, probe: Probe) -> Finding:
        """Run a probe, unless something that it needs has failed."""
        obstacle = self._obstacle(probe)
        seen, seconds = (not_applicable(obstacle), 0.0) if obstacle else self._staged(probe)
        self._verdicts[probe.name] = seen.verdict
        return Finding(
            probe.theme,
            probe.name.partition("/")[2],
            seen.verdict,
            " ".join(seen.what.split()),
            seen.remedy,
            seconds,
            bool(obstacle),
        )

    def _obstacle(self, probe: Probe) -> str:
        """Return why a probe cannot run, by the probe that is the cause; empty where it can."""
        needed = self._verdicts.get(probe.needs)
        if needed in BAD or needed is Verdict.NOT_APPLICABLE:
            cause = self._causes.get(probe.needs, probe.needs)
            self._causes[probe.name] = cause
            return f"cannot be looked at: {cause} has not passed"
        if probe.needs and self._unpacked is None:
            self._unpacked = self._unpack()
        if probe.needs and self._unpacked:
            return f"cannot be unpacked: {self._unpacked}"
        return ""

    def _unpack(self) -> str:
        """Unpack the FMU; return why it cannot be, empty where it can."""
        target = self._folder / "fmu"
        target.mkdir()
        try:
            with Archive(self._file) as archive:
                archive.unpack(target)
        except ArchiveError as error:
            return str(error)
        return ""

    def _staged(self, probe: Probe) -> tuple[Seen, float]:
        """Run the processes of a probe until one has a verdict."""
        self._count += 1
        shared = self._folder / f"{self._count:02d}"
        shared.mkdir()
        seconds = 0.0
        for stage in range(len(probe.stages)):
            place = shared / f"process {stage}"
            place.mkdir()
            job = ProbeJob(
                probe.name,
                stage,
                str(self._file),
                str(self._folder / "fmu"),
                str(shared),
                str(place),
                self._step,
                self._limit,
            )
            seen, taken = self._server.run(job)
            seconds += taken
            if seen is not None:
                return seen, seconds
        raise AssertionError(f"the last process of {probe.name} has no verdict")
