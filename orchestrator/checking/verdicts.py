"""Verdicts of probes, and the result of a check."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from ..core.errors import counted
from ..tables import Table

LOADING = "the loading of the library"
"""The call in which the code of an FMU comes into a process."""


class Verdict(StrEnum):
    """The outcome of a probe."""

    PASSED = "passed"
    WARNING = "warning"
    FAILED = "failed"
    NOT_APPLICABLE = "not applicable"
    CRASHED = "crashed"
    TIMED_OUT = "timed out"


BAD = (Verdict.FAILED, Verdict.CRASHED, Verdict.TIMED_OUT)
"""Verdicts with which an FMU fails a check."""
_SHOWN = (*BAD, Verdict.WARNING)
"""Verdicts that are shown with everything."""


@dataclass(frozen=True)
class Seen:
    """A verdict, with one sentence of what was seen and, where something is wrong, a remedy."""

    verdict: Verdict
    what: str
    remedy: str = ""


def passed(what: str) -> Seen:
    """Return that all is well."""
    return Seen(Verdict.PASSED, what)


def failed(what: str, remedy: str) -> Seen:
    """Return that FMI or the FMU's own description is broken."""
    return Seen(Verdict.FAILED, what, remedy)


def warned(what: str, remedy: str) -> Seen:
    """Return that something will trouble users, which FMI allows."""
    return Seen(Verdict.WARNING, what, remedy)


def not_applicable(what: str) -> Seen:
    """Return that there is nothing to look at."""
    return Seen(Verdict.NOT_APPLICABLE, what)


@dataclass(frozen=True)
class Finding:
    """The outcome of one probe.

    Attributes
    ----------
    theme, probe : str
        Its place in the table of probes.
    verdict : Verdict
        The outcome.
    what : str
        One sentence of what was seen.
    remedy : str
        Something to do about it; empty where nothing is wrong.
    seconds : float
        Time that the probe took (s).
    passed_over : bool
        Whether it did not run, as something that it needs has not passed.
    """

    theme: str
    probe: str
    verdict: Verdict
    what: str
    remedy: str = ""
    seconds: float = 0.0
    passed_over: bool = False

    @property
    def name(self) -> str:
        """Theme and probe as one word: ``state/rollback``."""
        return f"{self.theme}/{self.probe}"


@dataclass(frozen=True)
class Check:
    """The result of :func:`rockshed.check_fmu`.

    Attributes
    ----------
    fmu : Path
        The file.
    model, version, tool : str
        Name of the model, version of FMI and tool that made it, as far as they can be read.
    findings : tuple of Finding
        In the order of the table of probes.
    """

    fmu: Path
    model: str
    version: str
    tool: str
    findings: tuple[Finding, ...]

    @property
    def ok(self) -> bool:
        """Tell whether no probe has failed, crashed or timed out."""
        return not self.bad

    @property
    def bad(self) -> list[Finding]:
        """Findings with which the FMU fails."""
        return [finding for finding in self.findings if finding.verdict in BAD]

    @property
    def silent(self) -> bool:
        """Tell whether there is nothing to say: no warning either."""
        return not any(finding.verdict in _SHOWN for finding in self.findings)

    def __getitem__(self, name: str) -> Finding:
        """Return a finding by the name of its probe, ``state/rollback``.

        Raises
        ------
        KeyError
            There is no such probe.
        """
        for finding in self.findings:
            if finding.name == name:
                return finding
        raise KeyError(f"there is no probe {name}")

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    def __repr__(self) -> str:
        return f"{self.table()}\n{self.summary}"

    @property
    def summary(self) -> str:
        """Numbers of the verdicts in a line."""
        counts = Counter(finding.verdict for finding in self.findings)
        told = ", ".join(f"{counts[verdict]} {verdict}" for verdict in Verdict if counts[verdict])
        return f"{counted(len(self.findings), 'probe')}: {told}"

    def table(self) -> Table:
        """Return a row for each probe that ran, and one for those passed over for a cause."""
        about = ", ".join(filter(None, (self.model, f"FMI {self.version}", self.tool)))
        table = Table(("probe", "verdict", "seen"), title=f"{self.fmu.name}: {about}")
        for finding in self.findings:
            remedy = f" → {finding.remedy}" if finding.remedy else ""
            if not finding.passed_over:
                table.add(finding.name, finding.verdict, finding.what + remedy)
        for what, number in Counter(f.what for f in self.findings if f.passed_over).items():
            table.add(f"{number} more", Verdict.NOT_APPLICABLE, what)
        return table

    def as_data(self) -> dict[str, Any]:
        """Return everything as data for JSON."""
        return {
            "fmu": str(self.fmu),
            "model": self.model,
            "fmi_version": self.version,
            "generation_tool": self.tool,
            "ok": self.ok,
            "findings": [asdict(finding) for finding in self.findings],
        }
