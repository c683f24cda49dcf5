"""A model description, as far as a co-simulation needs it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from .annotations import NOTHING, Annotation
from .slave import STRING

UNIT_TOLERANCE = 1e-12
"""Relative difference between two conversion factors that counts as none."""


@dataclass(frozen=True)
class UnitDefinition:
    """A unit and its meaning: value in base units = ``factor`` * value + ``offset``.

    Attributes
    ----------
    name : str
        As the description has it.
    base : mapping of str to int, optional
        Exponents of the SI base units (kg, m, s, A, K, mol, cd, rad) other than zero; None where
        the description names the unit and does not define it.
    factor, offset : float
        Of the conversion.
    """

    name: str
    base: Mapping[str, int] | None = None
    factor: float = 1.0
    offset: float = 0.0

    def agrees_with(self, other: "UnitDefinition") -> bool | None:
        """Tell whether a value means the same in both units; None where that cannot be known."""
        if self.base is None or other.base is None:
            return True if self.name == other.name else None
        return (
            self.base == other.base
            and self.offset == other.offset
            and abs(self.factor - other.factor) <= UNIT_TOLERANCE * abs(self.factor)
        )


@dataclass(frozen=True)
class Port:
    """A variable of a subsystem.

    Attributes
    ----------
    name : str
        Without the component.
    reference : int
        Value reference.
    kind : str
        Family of FMI calls that moves it: Real, Integer, Boolean or String.
    causality : str
        parameter, input, output, local, ... as in the model description.
    unit : UnitDefinition, optional
        Of the value.
    minimum, maximum : float, optional
        Range.
    items : mapping of str to int
        Names of an enumeration's values; empty for anything else.
    start : str, optional
        Start value as the description has it.
    description : str
        In words.
    annotation : Annotation
        Role, older names and figures, where the description has them.
    has_own_start : bool
        Whether an output or a local variable begins with a start value that may be set (FMI:
        ``initial`` is exact or approx).
    is_constant : bool
        Whether nobody can set it.
    """

    name: str
    reference: int
    kind: str
    causality: str
    unit: UnitDefinition | None = None
    minimum: float | None = None
    maximum: float | None = None
    items: Mapping[str, int] = field(default_factory=dict)
    start: str | None = None
    description: str = ""
    annotation: Annotation = NOTHING
    has_own_start: bool = False
    is_constant: bool = False

    @property
    def can_be_set(self) -> bool:
        """Tell whether a value can be given before the initialisation."""
        may_be = self.has_own_start or self.causality in ("parameter", "input")
        return may_be and not self.is_constant

    @property
    def unit_name(self) -> str:
        """Name of the unit; "1" where there is none."""
        return self.unit.name if self.unit else "1"

    @property
    def is_number(self) -> bool:
        """Tell whether a float can carry the value."""
        return self.kind != STRING


@dataclass(frozen=True)
class Description:
    """The model description of an FMU.

    Attributes
    ----------
    model, guid, identifier, generation_tool : str
        As in the file.
    once_per_process : bool
        There may be one instance only.
    serializes_state : bool
        The state can be got, and serialized.
    ports : mapping of str to Port
        All variables by name.
    warnings : tuple of str
        Departures from the standard that do no harm.
    contents : str
        Kind of data in a serialized state; empty where the description does not tell.
    pictures : tuple of mapping
        Pictures of the outputs, as data.
    bonds : tuple of mapping
        Power bonds, as data.
    tolerance : float, optional
        Relative tolerance that the description proposes (FMI: DefaultExperiment).
    """

    model: str
    guid: str
    identifier: str
    generation_tool: str
    once_per_process: bool
    serializes_state: bool
    ports: Mapping[str, Port]
    warnings: tuple[str, ...] = ()
    contents: str = ""
    pictures: tuple[Mapping[str, Any], ...] = ()
    bonds: tuple[Mapping[str, Any], ...] = ()
    tolerance: float | None = None

    @cached_property
    def renamed_bases(self) -> dict[str, str]:
        """Present names of variables by their older ones; of arrays without an element."""
        return {
            old: port.name.partition("[")[0]
            for port in self.ports.values()
            for old in port.annotation.formerly
        }

    def named(self, causality: str) -> list[Port]:
        """Return the ports of a causality in the order of the description."""
        return [port for port in self.ports.values() if port.causality == causality]
