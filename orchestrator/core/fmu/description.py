"""A model description, as far as a co-simulation needs it."""

import itertools
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from .annotations import NOTHING, Annotation
from .slave import NUMBERS

Dependencies = Mapping[str, tuple[str, ...]]

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
    """A variable of a subsystem, or an element of an array.

    Attributes
    ----------
    name : str
        Without the component.
    reference : int
        Value reference. The elements of an array of FMI 3.0 have one in common.
    kind : str
        Real, Integer, Boolean, String, Binary or Clock.
    causality : str
        parameter, input, output, local, ... as in the model description.
    type : str
        Type of the FMI calls that move it; of numbers, a key of
        :data:`rockshed.core.fmu.types.TYPES`.
    shape : tuple of int
        Of the array of FMI 3.0 whose element it is; empty for anything else.
    element : int
        Place in that array, row by row, counted from 0.
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
    is_alias : bool
        Whether it is another name of a variable.
    is_tunable : bool
        Whether a parameter may be set between two steps (FMI: ``variability`` is tunable).
    is_discrete : bool
        Whether it changes at events alone (FMI: ``variability`` is discrete).
    """

    name: str
    reference: int
    kind: str
    causality: str
    type: str
    shape: tuple[int, ...] = ()
    element: int = 0
    unit: UnitDefinition | None = None
    minimum: float | None = None
    maximum: float | None = None
    items: Mapping[str, int] = field(default_factory=dict)
    start: str | None = None
    description: str = ""
    annotation: Annotation = NOTHING
    has_own_start: bool = False
    is_constant: bool = False
    is_alias: bool = False
    is_tunable: bool = False
    is_discrete: bool = False

    @property
    def is_held(self) -> bool:
        """Tell whether a value holds until the next one; else it may be interpolated."""
        return self.kind != "Real" or self.is_discrete

    @property
    def can_be_set(self) -> bool:
        """Tell whether a value can be given before the initialisation."""
        may_be = self.has_own_start or self.causality in ("parameter", "input", SIZE)
        return may_be and not self.is_constant

    @property
    def unit_name(self) -> str:
        """Name of the unit; "1" where there is none."""
        return self.unit.name if self.unit else "1"

    @property
    def is_number(self) -> bool:
        """Tell whether a float can carry the value."""
        return self.kind in NUMBERS

    @property
    def array(self) -> str:
        """Return the name without the number of an element."""
        return self.name.rpartition("[")[0] if self.shape else self.name

    @property
    def length(self) -> int:
        """Number of values that a call moves for its reference."""
        return math.prod(self.shape)


SIZE = "structuralParameter"
"""Causality of a parameter that other variables take their sizes from."""

_ELEMENT = re.compile(r"(.+)\[(\d{1,9}(?:,\d{1,9})*)\]")


@dataclass(frozen=True)
class Array:
    """Variables that make an array: one of FMI 3.0, or those of FMI 2.0 that are named like one.

    Attributes
    ----------
    shape : tuple of int
        Number of elements in each direction.
    names : tuple of str
        Of all elements, row by row.
    """

    shape: tuple[int, ...]
    names: tuple[str, ...]


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
    version : str
        Of FMI, as the description has it.
    may_return_early : bool
        A step may end before its end, at an event (FMI 3.0).
    keeps_state : bool
        The state can be got and set again, in memory.
    varies_step : bool
        Its communication steps may have any length.
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
    version: str = "2.0"
    may_return_early: bool = False
    keeps_state: bool = False
    varies_step: bool = False
    dependencies: Dependencies = field(default_factory=dict)
    initial_dependencies: Dependencies = field(default_factory=dict)

    @property
    def is_fmi_3(self) -> bool:
        """Tell whether the FMU is called by the functions of FMI 3.0."""
        return self.version.startswith("3.")

    @cached_property
    def arrays(self) -> dict[str, Array]:
        """All arrays by name.

        Those of FMI 2.0 are seen by their elements ``x[1]``, ``x[2]``, ... if none is missing.
        """
        elements: dict[str, dict[tuple[int, ...], str]] = {}
        for name in self.ports:
            if found := _ELEMENT.fullmatch(name):
                index = tuple(map(int, found.group(2).split(",")))
                elements.setdefault(found.group(1), {})[index] = name
        return {
            name: array
            for name, named in elements.items()
            if (array := _array_of(named)) is not None
        }

    def elements_of(self, port: Port) -> list[Port]:
        """Return all elements of the array of FMI 3.0 that a port belongs to; else the port."""
        if not port.shape:
            return [port]
        return [self.ports[name] for name in self.arrays[port.array].names]

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


def _array_of(elements: Mapping[tuple[int, ...], str]) -> Array | None:
    """Return the array that elements make, by their indices; None where they make none."""
    directions = {len(index) for index in elements}
    if len(directions) > 1:
        return None
    shape = tuple(map(max, zip(*elements)))
    if math.prod(shape) != len(elements):
        return None
    indices = itertools.product(*(range(1, length + 1) for length in shape))
    try:
        return Array(shape, tuple(elements[index] for index in indices))
    except KeyError:
        return None
