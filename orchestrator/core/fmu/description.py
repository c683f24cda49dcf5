"""What a model description tells about a subsystem, as far as a co-simulation needs it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from .annotations import NOTHING, Annotation
from .slave import STRING

UNIT_TOLERANCE = 1e-12
"""Relative difference between two conversion factors that counts as none."""


@dataclass(frozen=True)
class Unit:
    """A unit and its meaning: value in base units = ``factor`` * value + ``offset``.

    base: exponents of the SI base units (kg, m, s, A, K, mol, cd, rad) other than zero; None where the description names the
        unit and does not say what it is.
    """

    name: str
    base: Mapping[str, int] | None = None
    factor: float = 1.0
    offset: float = 0.0

    def agrees_with(self, other: "Unit") -> bool | None:
        """Whether a value means the same in both units; None where that cannot be known."""
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

    kind: the family of FMI calls that moves it: Real, Integer, Boolean or String.
    causality: parameter, input, output, local, ... as in the model description.
    items: names of an enumeration's values; empty for anything else.
    annotation: role, older names and figures, where the description tells them.
    """

    name: str
    reference: int
    kind: str
    causality: str
    unit: Unit | None = None
    minimum: float | None = None
    maximum: float | None = None
    items: Mapping[str, int] = field(default_factory=dict)
    start: str | None = None
    description: str = ""
    annotation: Annotation = NOTHING

    @property
    def unit_name(self) -> str:
        """The unit's name; "1" where there is none."""
        return self.unit.name if self.unit else "1"

    @property
    def is_number(self) -> bool:
        """Whether a float can carry the value."""
        return self.kind != STRING


@dataclass(frozen=True)
class Description:
    """The model description of an FMU.

    warnings: where it does not keep to the standard, without being useless.
    contents: what a serialized state holds; empty where the description does not tell.
    pictures: pictures of the outputs, as data.
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

    @cached_property
    def renamed_bases(self) -> dict[str, str]:
        """Present names of variables by their older ones; of arrays without the number of an element."""
        return {
            old: port.name.partition("[")[0]
            for port in self.ports.values()
            for old in port.annotation.formerly
        }

    def named(self, causality: str) -> list[Port]:
        """The ports of this causality, in the order of the description."""
        return [port for port in self.ports.values() if port.causality == causality]
