"""References of metrics: values of others that a run is compared with, as data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Reference:
    """A value to compare with.

    Attributes
    ----------
    value : float
        In SI units.
    note : str
        How the value was found if it is not printed as such; it then is only about right.
    """

    value: float
    note: str = ""


PAPER, EXPERIMENT = "paper", "experiment"
"""Sources that a paper with tests has: its own analysis, and its measurements."""
_OWN = (PAPER, EXPERIMENT)


@dataclass(frozen=True)
class Known:
    """The references of one metric, by who found them.

    Attributes
    ----------
    paper : Reference or None
        Computed in the analysis of the paper.
    experiment : Reference or None
        Measured.
    others : mapping of str to Reference
        By anybody else, by the name of the source.
    """

    paper: Reference | None = None
    experiment: Reference | None = None
    others: Mapping[str, Reference] = field(default_factory=dict)

    def by(self) -> dict[str, Reference]:
        """Return the references that there are, by who found them."""
        own = {PAPER: self.paper, EXPERIMENT: self.experiment, **self.others}
        return {who: reference for who, reference in own.items() if reference}

    @classmethod
    def of(cls, references: Mapping[str, Reference]) -> "Known":
        """Return references by who found them.

        Parameters
        ----------
        references : mapping of str to Reference
            As :meth:`by` gives them.
        """
        others = {who: found for who, found in references.items() if who not in _OWN}
        return cls(references.get(PAPER), references.get(EXPERIMENT), others)


@dataclass(frozen=True)
class References:
    """The references of a run.

    Attributes
    ----------
    known : mapping of str to Known
        By the name of the metric in words.
    remarks : sequence of str
        Why something is not compared, a sentence each.
    """

    known: Mapping[str, Known] = field(default_factory=dict)
    remarks: Sequence[str] = ()

    def as_data(self) -> dict[str, Any]:
        """Return the references as plain data, as the provenance of a run keeps them."""
        known = {
            name: {who: vars(reference) for who, reference in entry.by().items()}
            for name, entry in self.known.items()
        }
        return {"known": known, "remarks": list(self.remarks)}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> "References":
        """Read what :meth:`as_data` wrote.

        Parameters
        ----------
        data : mapping
            ``known`` and ``remarks``; what is missing is empty.

        Returns
        -------
        references : References
            Equal to those that were written.
        """
        known = {
            name: Known.of({who: Reference(**reference) for who, reference in entry.items()})
            for name, entry in data.get("known", {}).items()
        }
        return cls(known, tuple(data.get("remarks", ())))
