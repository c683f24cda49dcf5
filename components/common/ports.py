"""Variables of a component, each declared once.

Everything else derives from these declarations: the place of a value in the component's buffers,
the indices that kernels use, the model description of the FMU, the checks of the orchestrator and
the tables of the documentation.

A component keeps three flat buffers:

- ``w``, float64, what the outside sees: parameters, inputs and outputs. **The FMI value reference
  of a variable is its index.**
- ``x``, float64, hidden state (positions of sand discs, contact springs, ...).
- ``k``, int64, hidden integers, beginning with a table of the arrays: two entries an array, its
  offset and its length.

Scalars stand first in ``w``, in the order of their declaration, so their index is a constant that a
kernel may use. The place of an array depends on the sizes the component was built with; kernels
find it with :func:`.kernels.view`.
"""

from collections import namedtuple
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from .plausible import Plausible
from .roles import Role
from .shown import Reported
from .units import UNITS

Sizes = Mapping[str, int]
"""Sizes a component is built with, by name: ``{"elements": 24}``."""

Start = float | Callable[[int, Sizes], float]
"""Start value, or for arrays a function of the element's number (from 0) and the sizes."""


class Causality(StrEnum):
    """The relation of a variable to the outside, in the words of FMI."""

    PARAMETER = "parameter"
    INPUT = "input"
    OUTPUT = "output"


class Kind(StrEnum):
    """FMI type of a variable.

    In the buffer ``w`` all of them are float64; an enumeration counts its choices from 1.
    """

    REAL = "Real"
    INTEGER = "Integer"
    BOOLEAN = "Boolean"
    ENUMERATION = "Enumeration"


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of a component, scalar or array.

    Attributes
    ----------
    name : str
        Structured name without index, ``rock.position.x``.
    causality : Causality
        Parameter, input or output.
    description : str
        Its meaning with direction and sign.
    unit : str
        Key of :data:`rockshed.components.common.units.UNITS`.
    start : float or callable
        Start value; of an array also a function of the element's number and the sizes.
    minimum, maximum : float, optional
        Allowed range, ends included; None where there is no bound.
    kind : Kind
        FMI type.
    choices : tuple of str
        Words of an enumeration.
    size : str, optional
        Name of the size that gives an array its length; None for a scalar. Elements are named
        ``name[1]``, ``name[2]``, ...
    initial_dependencies : tuple of str, optional
        For outputs, names of the parameters and inputs that the value at the end of the
        initialisation depends on. None means: all of them. No output changes with an input between
        two steps.
    source : str
        Paper and equation or table the variable or its start value comes from.
    role : Role, optional
        Its meaning to metrics, balance of energy, tables and pictures.
    label : str
        Its short name in legends; energies of one label are drawn as one layer of the balance.
    reported : tuple of Reported
        Figures that are reported of it.
    formerly : tuple of str
        Older names under which a user's value is still taken, with a warning.
    plausible : Plausible, optional
        Range beyond which a value is doubted.
    """

    name: str
    causality: Causality
    description: str
    unit: str = "1"
    start: Start = 0.0
    minimum: float | None = None
    maximum: float | None = None
    kind: Kind = Kind.REAL
    choices: tuple[str, ...] = ()
    size: str | None = None
    initial_dependencies: tuple[str, ...] | None = None
    source: str = ""
    role: Role | None = None
    label: str = ""
    reported: tuple[Reported, ...] = ()
    formerly: tuple[str, ...] = ()
    plausible: Plausible | None = None

    def __post_init__(self) -> None:
        if self.unit not in UNITS:
            raise ValueError(
                f"{self.name}: unknown unit {self.unit!r}; known are {', '.join(UNITS)}"
            )
        if (self.kind is Kind.ENUMERATION) != bool(self.choices):
            raise ValueError(f"{self.name}: an enumeration has choices, and nothing else has")

    def start_at(self, number: int, sizes: Sizes) -> float:
        """Return the start value of an element.

        Parameters
        ----------
        number : int
            Number of the element, from 0; a scalar has the element 0.
        sizes : mapping of str to int
            All sizes.

        Returns
        -------
        float
            Start value, in the unit of the variable.
        """
        return float(self.start(number, sizes) if callable(self.start) else self.start)

    def element_names(self, sizes: Sizes) -> list[str]:
        """Return the names as the outside sees them.

        Parameters
        ----------
        sizes : mapping of str to int
            All sizes.

        Returns
        -------
        list of str
            The name itself, or ``name[1]``, ``name[2]``, ... for an array.
        """
        if self.size is None:
            return [self.name]
        return [f"{self.name}[{i + 1}]" for i in range(sizes[self.size])]


def param(name: str, description: str, start: Start, unit: str = "1", **rest: Any) -> Variable:
    """Declare a real parameter: set before the initialisation, fixed afterwards.

    Parameters
    ----------
    name, description : str
        As in :class:`Variable`.
    start : float or callable
        Start value, in ``unit``.
    unit : str
        Key of :data:`rockshed.components.common.units.UNITS`.
    **rest
        Other attributes of :class:`Variable`.

    Returns
    -------
    Variable
        The parameter.
    """
    return Variable(name, Causality.PARAMETER, description, unit, start, **rest)


def choice(
    name: str, description: str, choices: Sequence[str], start: str, **rest: Any
) -> Variable:
    """Declare a parameter that selects one of ``choices``.

    Kernels see its number, counted from 1.

    Parameters
    ----------
    name, description : str
        As in :class:`Variable`.
    choices : sequence of str
        The words.
    start : str
        The word at the start.
    **rest
        Other attributes of :class:`Variable`.

    Returns
    -------
    Variable
        The parameter.
    """
    number = float(choices.index(start) + 1)
    return Variable(
        name,
        Causality.PARAMETER,
        description,
        "1",
        number,
        1.0,
        float(len(choices)),
        Kind.ENUMERATION,
        tuple(choices),
        **rest,
    )


def switch(name: str, description: str, start: bool, **rest: Any) -> Variable:
    """Declare a parameter that is on or off.

    Parameters
    ----------
    name, description : str
        As in :class:`Variable`.
    start : bool
        Whether it is on at the start.
    **rest
        Other attributes of :class:`Variable`.

    Returns
    -------
    Variable
        The parameter.
    """
    return Variable(
        name, Causality.PARAMETER, description, "1", float(start), kind=Kind.BOOLEAN, **rest
    )


def count(name: str, description: str, start: int, **rest: Any) -> Variable:
    """Declare a parameter that is a whole number.

    Parameters
    ----------
    name, description : str
        As in :class:`Variable`.
    start : int
        Start value.
    **rest
        Other attributes of :class:`Variable`.

    Returns
    -------
    Variable
        The parameter.
    """
    return Variable(
        name, Causality.PARAMETER, description, "1", float(start), kind=Kind.INTEGER, **rest
    )


def inp(name: str, description: str, unit: str = "1", start: Start = 0.0, **rest: Any) -> Variable:
    """Declare an input that is a real number.

    Parameters
    ----------
    name, description : str
        As in :class:`Variable`.
    unit : str
        Key of :data:`rockshed.components.common.units.UNITS`.
    start : float or callable
        Start value, in ``unit``.
    **rest
        Other attributes of :class:`Variable`.

    Returns
    -------
    Variable
        The input.
    """
    return Variable(name, Causality.INPUT, description, unit, start, **rest)


def out(name: str, description: str, unit: str = "1", **rest: Any) -> Variable:
    """Declare an output that is a real number.

    It has no start value: the component computes it when it is initialised.

    Parameters
    ----------
    name, description : str
        As in :class:`Variable`.
    unit : str
        Key of :data:`rockshed.components.common.units.UNITS`.
    **rest
        Other attributes of :class:`Variable`.

    Returns
    -------
    Variable
        The output.
    """
    return Variable(name, Causality.OUTPUT, description, unit, **rest)


BOND_MEMBERS = (
    "position.x",
    "position.y",
    "angle",
    "velocity.x",
    "velocity.y",
    "angular_velocity",
    "force.x",
    "force.y",
    "torque",
    "position",
    "velocity",
    "force",
    "wave",
    "impedance",
)
"""Names of what a power bond may carry, in this order: in the plane, then along a rod."""


@dataclass(frozen=True, slots=True)
class Bond:
    """A mechanical power bond to another component.

    It carries the motion of a body, which one of both computes, and the force on it. Its members
    are the inputs and outputs of the component that are named ``prefix`` + one of
    :data:`BOND_MEMBERS`, or as ``named`` says, be they scalars or arrays. Two components fit
    together if their bonds have the same members.

    Attributes
    ----------
    name : str
        Name of the terminal that FMI 3.0 makes of it.
    description : str
        Body and force in words.
    prefix : str
        Beginning of the names of its members.
    idle : str
        What is so while nothing drives its inputs, where that is hardly meant; a run warns of it.
        Empty where a component does something sensible without a partner.
    unless : tuple of str
        A parameter and the word of it with which the bond plays no part; empty for none.
    named : mapping of str to str
        Variables of those members whose names do not follow from ``prefix``.
    """

    name: str
    description: str
    prefix: str = ""
    idle: str = ""
    unless: tuple[str, ...] = ()
    named: Mapping[str, str] = field(default_factory=dict)

    def members(self, variables: Sequence[Variable]) -> dict[str, Variable]:
        """Return the variables of the bond by member, in the order of :data:`BOND_MEMBERS`.

        Parameters
        ----------
        variables : sequence of Variable
            Variables of the component.
        """
        ports = {v.name: v for v in variables if v.causality is not Causality.PARAMETER}
        names = {member: self.named.get(member, self.prefix + member) for member in BOND_MEMBERS}
        return {member: ports[name] for member, name in names.items() if name in ports}


@dataclass(frozen=True, slots=True)
class NextEvent:
    """The output by which a component announces its next event.

    A communication step may end there.

    Attributes
    ----------
    time : str
        Output (s). A step that ends at this time has the event behind it, and the results are the
        same, bit for bit, however the time is divided into steps. Until the first step it counts
        from the start, which kernels do not know.
    while_zero : tuple of str
        Inputs that must be zero for that to hold.
    """

    time: str
    while_zero: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Indices:
    """Numbers of a hidden array that kernels use as indices.

    A restored state is refused where one of them is out of its range.

    Attributes
    ----------
    high : callable
        Largest allowed value, a function of the sizes.
    low : callable or int
        Smallest allowed value.
    first, every : int
        Place of the first such number in the array, and the distance to the next.
    multiple : int
        Each is a multiple of this number.
    bits : tuple of int, optional
        Where an integer holds several numbers: the lowest bit of this one, and how many it has.
    ascending : bool
        None is less than the one before it.
    """

    high: Callable[[Sizes], int]
    low: Callable[[Sizes], int] | int = 0
    first: int = 0
    every: int = 1
    multiple: int = 1
    bits: tuple[int, int] = (0, 64)
    ascending: bool = False


@dataclass(frozen=True, slots=True)
class IndexRange:
    """Indices at their place in a buffer.

    Attributes
    ----------
    array : str
        Name of the hidden array.
    integer : bool
        Whether the buffer is ``k``; else ``x``.
    places : slice
        Places in the buffer.
    low, high : int
        Range, ends included.
    declared : Indices
        The declaration.
    """

    array: str
    integer: bool
    places: slice
    low: int
    high: int
    declared: Indices


@dataclass(frozen=True, slots=True)
class State:
    """A hidden array: its name, its length as a function of the sizes, and the indices in it."""

    name: str
    length: Callable[[Sizes], int]
    integer: bool = False
    indices: tuple[Indices, ...] = ()


@dataclass(frozen=True)
class Layout:
    """Places of the variables and hidden arrays of a component, whatever its sizes.

    Dots in names become underscores: ``scalar.rock_position_x``. Both tuples are constants to
    numba.

    Attributes
    ----------
    variables : tuple of Variable
        In the order of their declaration.
    states : tuple of State
        Hidden arrays.
    scalar : named tuple
        Index in ``w`` of each scalar.
    array : named tuple
        Place in ``k`` of the table entry of each array, variables and hidden arrays alike.
    """

    variables: tuple[Variable, ...]
    states: tuple[State, ...] = ()
    scalar: Any = field(init=False)
    array: Any = field(init=False)

    def __post_init__(self) -> None:
        names = [v.name for v in self.variables] + [s.name for s in self.states]
        if len(set(names)) != len(names):
            raise ValueError(
                f"declared twice: {sorted(n for n in set(names) if names.count(n) > 1)}"
            )
        older = [name for v in self.variables for name in v.formerly]
        if taken := {name for name in older if name in names or older.count(name) > 1}:
            raise ValueError(f"older names that are taken: {sorted(taken)}")
        scalars = [v.name for v in self.variables if v.size is None]
        arrays = [v.name for v in self.variables if v.size is not None] + [
            s.name for s in self.states
        ]
        object.__setattr__(self, "scalar", _constants("Scalar", scalars, 1))
        object.__setattr__(self, "array", _constants("Array", arrays, 2))

    @property
    def renamed(self) -> dict[str, str]:
        """Present names of variables by their older ones."""
        return {old: v.name for v in self.variables for old in v.formerly}

    @property
    def ordered(self) -> list[Variable]:
        """The variables in the order they have in ``w``: scalars first."""
        return [v for v in self.variables if v.size is None] + [
            v for v in self.variables if v.size is not None
        ]

    def table(self, sizes: Sizes) -> tuple[list[int], int, int, int]:
        """Return offsets and lengths of all arrays, and the lengths of the buffers.

        Parameters
        ----------
        sizes : mapping of str to int
            Sizes that the component is built with.

        Returns
        -------
        entries : list of int
            Offset and length of each array.
        w, x, k : int
            Lengths of the buffers.
        """
        entries: list[int] = []
        w = sum(v.size is None for v in self.variables)
        x, k = 0, 2 * len(self.array)
        for variable in self.ordered:
            if variable.size is not None:
                entries += [w, sizes[variable.size]]
                w += sizes[variable.size]
        for state in self.states:
            length = state.length(sizes)
            entries += [k if state.integer else x, length]
            if state.integer:
                k += length
            else:
                x += length
        return entries, w, x, k

    def index_ranges(self, sizes: Sizes) -> list[IndexRange]:
        """Return all indices in hidden arrays, with their places and ranges.

        Parameters
        ----------
        sizes : mapping of str to int
            Sizes that the component is built with.

        Returns
        -------
        list of IndexRange
        """
        entries = self.table(sizes)[0]
        begins = dict(zip(reversed(self.states), entries[-2::-2]))
        return [
            IndexRange(
                state.name,
                state.integer,
                slice(
                    begins[state] + indices.first,
                    begins[state] + state.length(sizes),
                    indices.every,
                ),
                indices.low(sizes) if callable(indices.low) else indices.low,
                indices.high(sizes),
                indices,
            )
            for state in self.states
            for indices in state.indices
        ]


def _constants(title: str, names: list[str], stride: int) -> Any:
    fields = [name.replace(".", "_") for name in names]
    return namedtuple(title, fields)(*range(0, stride * len(fields), stride))
