"""Values by formulas, each with its source and how far it can be relied on."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

FORCE = "peak force on the rock"
"""Quantity: the name of the metric of a run that the estimate stands beside."""
PENETRATION = "penetration"
"""Quantity: likewise."""
THICKNESS = "least thickness of the cushion"
"""Quantity: a rule for the design, no forecast."""


@dataclass(frozen=True)
class FormulaValue:
    """A value by a formula of practice.

    Attributes
    ----------
    name : str
        Of the formula.
    quantity : str
        :data:`FORCE`, :data:`PENETRATION` or :data:`THICKNESS`.
    value : float
        In SI units.
    unit : str
        FMI unit.
    source : str
        Publication.
    verified : bool
        Whether the formula was compared with its source, a printed table or a derivation.
    within_range : bool or None
        Whether the impact lies within what the formula was found for; None where that is not known.
    validity : str
        That range in words.
    remark : str
        Parameters that were used, and how the formula was verified.
    """

    name: str
    quantity: str
    value: float
    unit: str
    source: str
    verified: bool
    within_range: bool | None
    validity: str
    remark: str = ""

    def as_data(self) -> dict[str, Any]:
        """Return the estimate as plain data, as the provenance of a run keeps it."""
        return asdict(self)

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> "FormulaValue":
        """Read what :meth:`as_data` wrote; entries of later versions are passed over."""
        return cls(**{name: data[name] for name in cls.__dataclass_fields__ if name in data})
