"""Metrics of a run: single values with unit and references, reached by identifiers that stay."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from html import escape
from typing import Any

from ..errors import UnknownName
from ..system.names import nearest


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
    """Turn a name in words into a stable identifier.

    ``peak transmitted force`` becomes ``peak_transmitted_force``; letters of any script stay.
    """
    return re.sub(r"[\W_]+", "_", name.lower()).strip("_")


@dataclass(frozen=True)
class Metric:
    """A named number that follows from the results of a run.

    Attributes
    ----------
    name : str
        In words, as tables show it.
    value : float, int or str
        In SI units.
    unit : str
        FMI unit, ``1`` where there is none.
    references : mapping of str to Beside
        What others found, by who found it: paper, experiment, or the name of a formula.
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
        KeyError, TypeError, AttributeError
            It is no entry of a summary.
        """
        references = {
            who: Beside(
                _of_kind(found["value"], int, float),
                _of_kind(found["deviation"], int, float),
                _of_kind(found.get("note", ""), str),
            )
            for who, found in entry.get("references", {}).items()
        }
        name, unit = _of_kind(entry["name"], str), _of_kind(entry.get("unit", "1"), str)
        return cls(name, _of_kind(entry["value"], int, float, str), unit, references)

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        value = f"{self.value:.6g}" if isinstance(self.value, float) else str(self.value)
        return value + unit

    def _repr_html_(self) -> str:
        rows = {"computed": str(self)}
        for who, found in self.references.items():
            beside = replace(self, value=found.value, references={})
            note = f" ({found.note})" if found.note else ""
            rows[who] = f"{beside}, deviation {100.0 * found.deviation:+.1f} %{note}"
        body = "".join(
            f"<tr><td>{escape(who)}</td><td>{escape(text)}</td></tr>" for who, text in rows.items()
        )
        return f"<table><caption>{escape(self.name)}</caption>{body}</table>"


def _of_kind(value: Any, *kinds: type) -> Any:
    """Return a value of a file, which has to be of one of some kinds."""
    if not isinstance(value, kinds):
        raise TypeError(f"{value!r:.40} is no {' or '.join(kind.__name__ for kind in kinds)}")
    return value


class Metrics(Mapping[str, Metric]):
    """Metrics of a run by identifier, in the order in which they were computed.

    Parameters
    ----------
    metrics : iterable of Metric
        Of two with one identifier, the later one counts.

    Examples
    --------
    >>> Metrics([Metric("simulated time", 0.1, "s")])["simulated_time"].value
    0.1
    """

    def __init__(self, metrics: Iterable[Metric] = ()) -> None:
        self._metrics = {metric.identifier: metric for metric in metrics}

    def __getitem__(self, identifier: str) -> Metric:
        if identifier not in self._metrics:
            raise UnknownName(f"there is no metric {identifier!r}; {self._nearest(identifier)}")
        return self._metrics[identifier]

    def __iter__(self) -> Iterator[str]:
        return iter(self._metrics)

    def __len__(self) -> int:
        return len(self._metrics)

    def _nearest(self, name: str) -> str:
        return nearest(identifier(name), self._metrics)

    def __repr__(self) -> str:
        width = max(map(len, self), default=0)
        return "\n".join(f"{name:{width}}  {metric}" for name, metric in self.items())

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(name)}</td><td>{escape(str(metric))}</td></tr>"
            for name, metric in self.items()
        )
        return f"<table>{rows}</table>"
