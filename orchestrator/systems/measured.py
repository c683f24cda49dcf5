"""Measurements of the impact systems, as data."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field


@dataclass(frozen=True)
class MasterRun:
    """One run of one system by one master.

    Attributes
    ----------
    system, master, variant : str
        Names of the system, the master, and the kind of FMUs.
    step : float
        Exchange step (s); of an adaptive one the longest.
    exchanges : int
        Number of exchanges; of an adaptive step that of those which were kept.
    reason : str
        Why there is no result; empty where there is one.
    error : float or None
        Largest error of the quantity, as a part of its largest true value.
    energy : float or None
        Energy that the coupling has made, as a part of the impact energy; None where the system
        has no such account.
    cost : float or None
        Processor time of all exchanges (s).
    deviation : float or None
        Largest difference from the reference master, as a part of the largest true value; 0 where
        all bits are equal.
    """

    system: str
    master: str
    variant: str
    step: float
    exchanges: int
    reason: str = ""
    error: float | None = None
    energy: float | None = None
    cost: float | None = None
    deviation: float | None = None


@dataclass(frozen=True)
class SuiteRuns:
    """All measurements, with what they were made with.

    Attributes
    ----------
    rows : sequence of MasterRun
        System by system; costs are medians over the rounds.
    versions : mapping of str to str or None
        Of the tools' packages; None of those that are not installed.
    platform : str
        Machine and system.
    quick : bool
        Whether it is a part of the whole only.
    stamps : mapping of str to str
        Of the kernels, by system, see :mod:`rockshed.systems.stamps`.
    rounds : int
        Rounds in which all masters took their turns.
    wall_time : float
        Time (s) that all turns took.
    """

    rows: Sequence[MasterRun]
    versions: Mapping[str, str | None]
    platform: str
    quick: bool
    stamps: Mapping[str, str] = field(default_factory=dict)
    rounds: int = 1
    wall_time: float = 0.0

    def as_text(self) -> str:
        """Return everything as JSON, a row a line."""
        facts = {"versions": dict(self.versions), "platform": self.platform, "quick": self.quick}
        facts |= {"stamps": dict(self.stamps), "rounds": self.rounds, "wall_time": self.wall_time}
        rows = ",\n".join(json.dumps(asdict(row)) for row in self.rows)
        return json.dumps(facts, indent=1)[:-2] + f',\n "rows": [\n{rows}\n]}}\n'


def from_text(text: str) -> SuiteRuns:
    """Return measurements as :meth:`SuiteRuns.as_text` wrote them."""
    content = json.loads(text)
    rows = [MasterRun(**row) for row in content.pop("rows")]
    return SuiteRuns(rows, **content)
