"""One figure of a run: value, unit, and what others found for it."""

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True)
class Beside:
    """A reference that a metric is compared with.

    Attributes
    ----------
    value : float
        What the source gives (SI).
    deviation : float
        metric / value - 1.
    note : str
        How the value was found, where it is not printed as such.
    """

    value: float
    deviation: float
    note: str = ""


def identifier(name: str) -> str:
    """Turn a name in words into a stable identifier: ``peak transmitted force`` -> ``peak_transmitted_force``."""
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")


@dataclass(frozen=True)
class Metric:
    """A named figure that follows from the results of a run.

    Attributes
    ----------
    name : str
        In words, as tables show it.
    value : float, int or str
        In SI units.
    unit : str
        FMI unit, ``1`` where there is none.
    references : mapping of str to Beside
        What others found, by who found it: paper, experiment, handbook.
    """

    name: str
    value: float | int | str
    unit: str = "1"
    references: Mapping[str, Beside] = field(default_factory=dict)

    @property
    def identifier(self) -> str:
        """Key of the metric in ``Run.metrics``; it does not change between releases."""
        return identifier(self.name)

    def as_entry(self) -> dict[str, Any]:
        """Return the entry of ``summary.json``; references only where there are any."""
        entry = {"id": self.identifier, **asdict(self)}
        return {key: value for key, value in entry.items() if key != "references" or value}

    @classmethod
    def from_entry(cls, entry: Mapping[str, Any]) -> "Metric":
        """Read an entry of a summary; what other programs have added to the entry is passed over.

        Raises
        ------
        KeyError, TypeError
            It is no entry of a summary.
        """
        references = {
            who: Beside(found["value"], found["deviation"], found.get("note", ""))
            for who, found in entry.get("references", {}).items()
        }
        return cls(entry["name"], entry["value"], entry.get("unit", "1"), references)
