"""A component: its declarations and kernels, and an instance of it that holds the buffers.

The life of an instance is that of an FMI slave: set parameters and inputs,
:meth:`Instance.initialise`, then :meth:`Instance.step` as often as wanted. Between two steps inputs
may change; outputs change only in a step.
"""

import hashlib
import re
import struct
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .ports import Bond, Causality, Kind, Layout, NextEvent, Variable
from .restoring import state_problem
from .shown import Picture
from .units import range_in_words

OK = 0
"""Status of a kernel that did its work. Every other value is a key of :attr:`Component.faults`."""

Buffer = NDArray[np.float64]
HEADER = struct.Struct("<8s16sqqq")
"""Of a serialized state: mark, kind, and the lengths of ``w``, ``x`` and ``k``, which follow."""
MAGIC = b"rockshed"
"""Mark at the beginning of a serialized state."""

NOT_FINITE = "%s = %s: must be a finite number (%s)"
OUT_OF_RANGE = "%s = %s%s: allowed is %s (%s)"
NOT_WHOLE = "%s = %s: must be a whole number (%s)"
UNKNOWN_STATUS = "stopped with the unknown status %d"
FOREIGN_STATE = "this is no serialized state of this component with these sizes"
IMPOSSIBLE_STATE = "this state is damaged: %s; restore another one"
LOST = "%s became %s, which is no finite number: a value of the inputs or parameters is too large"
"""Sentences that a native FMU says too, as formats of printf: of a variable's name, value, unit,
range and description; of a status; of a state; of an output's name and value."""


class ComponentError(Exception):
    """A component refuses its values, or cannot go on.

    Parameters
    ----------
    component : str
        Its name.
    problems : list of str
        Every reason, in words.
    """

    def __init__(self, component: str, problems: list[str]) -> None:
        self.component, self.problems = component, problems
        super().__init__(f"{component}: " + "; ".join(problems))


class DeferredError(ComponentError):
    """Inputs that the first step will refuse if they are not put right before."""


@dataclass(frozen=True)
class Size:
    """A number fixed when the component is built.

    Parameters
    ----------
    default : int
        Its value if none is chosen.
    minimum, maximum : int
        Its allowed range.
    description : str
        What it counts.
    """

    default: int
    minimum: int
    maximum: int
    description: str


@dataclass(frozen=True)
class Component:
    """A subsystem of the rock shed: its declarations, and where its kernels are.

    Parameters
    ----------
    name : str
        Name of its FMU.
    title : str
        One line for people.
    layout : Layout
        Its variables and hidden arrays.
    kernels : str
        Module of its kernels, imported when the first of them is called:
        ``initialise(w, x, k)`` computes the state at the start from the parameters,
        ``evaluate(w, x, k)`` the outputs at the start from state and inputs and checks that they
        fit together, ``step(t, h, w, x, k)`` advances by ``h`` (s) from time ``t`` (s) with the
        inputs in ``w``. Each returns a status. If the module has a function
        ``problems(instance)``, it returns in words everything that is wrong with parameters which
        are in range one by one.
    folder : Path
        Its sources, with README.md and icon.png.
    sizes : mapping of str to Size
        The sizes it can be built with.
    faults : mapping of int to str
        Message of each status other than OK; ``{name}`` stands for the value of the scalar
        variable ``name``.
    deferred : frozenset of int
        Statuses of ``evaluate`` that blame inputs: an FMU leaves its initialisation nevertheless,
        as inputs may change before the first step, and ``step`` refuses while they hold.
    default_step, default_stop_time : float
        Proposal for a simulation (s).
    bonds : tuple of Bond
        Mechanical power bonds to other components.
    next_event : NextEvent or None
        Where the component tells when it meets its next event, if it does.
    contents : str
        What a serialized state holds, for readers that know how to draw or measure it:
        ``granular.discs``; empty where none does.
    pictures : tuple of Picture
        Pictures of its outputs, as data.
    """

    name: str
    title: str
    layout: Layout
    kernels: str
    folder: Path
    sizes: Mapping[str, Size] = field(default_factory=dict)
    faults: Mapping[int, str] = field(default_factory=dict)
    deferred: frozenset[int] = frozenset()
    default_step: float = 1e-4
    default_stop_time: float = 0.02
    bonds: tuple[Bond, ...] = ()
    next_event: NextEvent | None = None
    contents: str = ""
    pictures: tuple[Picture, ...] = ()

    def __post_init__(self) -> None:
        for bond in self.bonds:
            members = bond.members(self.layout.variables)
            if lost := sorted(set(bond.named) - set(members)):
                raise ValueError(
                    f"{self.name}: bond {bond.name!r} names {', '.join(lost)}: no member, or its "
                    f"variable is no input or output"
                )
            if len({v.causality for v in members.values()}) < 2:
                raise ValueError(
                    f"{self.name}: bond {bond.name!r} needs motion and force, one of them an "
                    f"input, one an output"
                )

    @cached_property
    def _module(self) -> ModuleType:
        return import_module(self.kernels)

    @cached_property
    def initialise(self) -> Callable[..., int]:
        """Kernel that computes the state at the start."""
        return self._kernel("initialise")

    @cached_property
    def evaluate(self) -> Callable[..., int]:
        """Kernel that computes the outputs at the start."""
        return self._kernel("evaluate")

    @cached_property
    def step(self) -> Callable[..., int]:
        """Kernel that advances in time."""
        return self._kernel("step")

    def _kernel(self, name: str) -> Callable[..., int]:
        kernel: Callable[..., int] = getattr(self._module, name)
        return kernel

    def refusals(self, instance: "Instance") -> list[str]:
        """Return what is wrong with parameters that are in range one by one.

        Parameters
        ----------
        instance : Instance
            Of this component, not yet initialised.

        Returns
        -------
        list of str
            Every reason, in words.
        """
        problems = getattr(self._module, "problems", None)
        return [] if problems is None else list(problems(instance))

    def with_sizes(self, sizes: Mapping[str, int] | None = None) -> dict[str, int]:
        """Return the sizes to build with: the defaults, overridden by ``sizes``.

        Parameters
        ----------
        sizes : mapping of str to int, optional
            Those that differ from the defaults.

        Returns
        -------
        dict of str to int
            All sizes.

        Raises
        ------
        ComponentError
            A size that the component has not, or that is out of its range.
        """
        given = dict(sizes or {})
        problems = [
            f"has no size {name!r}; its sizes are: {', '.join(self.sizes) or 'none'}"
            for name in given
            if name not in self.sizes
        ]
        chosen = {name: given.get(name, size.default) for name, size in self.sizes.items()}
        problems += [
            f"{name} = {value}: allowed is {self.sizes[name].minimum} to "
            f"{self.sizes[name].maximum} ({self.sizes[name].description})"
            for name, value in chosen.items()
            if not self.sizes[name].minimum <= value <= self.sizes[name].maximum
        ]
        if problems:
            raise ComponentError(self.name, problems)
        return chosen

    def instance(self, **sizes: int) -> "Instance":
        """Return a new instance with start values everywhere, not yet initialised.

        Parameters
        ----------
        **sizes : int
            Those that differ from the defaults.

        Returns
        -------
        Instance
            The instance.

        Raises
        ------
        ComponentError
            A size that the component has not, or that is out of its range.
        """
        return Instance(self, self.with_sizes(sizes))

    def documentation(self) -> str:
        """Return the component's README: equations, frames, signs, sources (Markdown)."""
        return (self.folder / "README.md").read_text(encoding="utf-8")


class Instance:
    """The buffers of one component, reached by name. Value reference = index in ``w``.

    Parameters
    ----------
    component : Component
        Its declarations and kernels.
    sizes : mapping of str to int
        All its sizes, as :meth:`Component.with_sizes` returns them.
    """

    def __init__(self, component: Component, sizes: Mapping[str, int]) -> None:
        self.component = component
        self.sizes = dict(sizes)
        entries, n_w, n_x, n_k = component.layout.table(sizes)
        self.w: Buffer = np.zeros(n_w)
        self.x: Buffer = _on_cache_lines(n_x)
        self.k: NDArray[np.int64] = np.zeros(n_k, np.int64)
        self.k[: len(entries)] = entries
        for index, (variable, number) in enumerate(self._elements()):
            if variable.causality is not Causality.OUTPUT:
                self.w[index] = variable.start_at(number, sizes)

    def _elements(self) -> Iterator[tuple[Variable, int]]:
        for variable in self.component.layout.ordered:
            for number in range(1 if variable.size is None else self.sizes[variable.size]):
                yield variable, number

    @cached_property
    def references(self) -> dict[str, int]:
        """Value reference of every variable, arrays element by element."""
        names = (n for v in self.component.layout.ordered for n in v.element_names(self.sizes))
        return {name: index for index, name in enumerate(names)}

    @cached_property
    def _slices(self) -> dict[str, slice]:
        slices = {}
        start = 0
        for variable in self.component.layout.ordered:
            length = 1 if variable.size is None else self.sizes[variable.size]
            slices[variable.name] = slice(start, start + length)
            start += length
        return slices

    def __getitem__(self, name: str) -> Any:
        """Return the value of a scalar or array element (float), or a view of a whole array."""
        name = self._present(name)
        if name in self.references:
            return float(self.w[self.references[name]])
        return self.w[self._slices[name]]

    def __setitem__(self, name: str, value: Any) -> None:
        """Set a scalar, an array element or a whole array; a choice may be given by its word."""
        name = self._present(name)
        if isinstance(value, str):
            value = self._choice(name, value)
        self.w[self.references[name] if name in self.references else self._slices[name]] = value

    def _present(self, name: str) -> str:
        """Return the present name of a variable; an older one is taken with a warning."""
        if name in self.references or name in self._slices:
            return name
        base, bracket, element = name.partition("[")
        if base not in self.component.layout.renamed:
            return name
        present = self.component.layout.renamed[base]
        warnings.warn(
            f"{self.component.name}: {base} is called {present} now", FutureWarning, stacklevel=3
        )
        return present + bracket + element

    def _choice(self, name: str, word: str) -> float:
        variable = next(v for v in self.component.layout.variables if v.name == name)
        if word not in variable.choices:
            raise ComponentError(
                self.component.name,
                [f"{name} = {word}: choose one of {', '.join(variable.choices)}"],
            )
        return float(variable.choices.index(word) + 1)

    def state(self, name: str) -> NDArray[Any]:
        """Return a view of a hidden array.

        Parameters
        ----------
        name : str
            Name of its declaration.

        Returns
        -------
        ndarray of float64 or int64
            The array, in one dimension.
        """
        entry = getattr(self.component.layout.array, name.replace(".", "_"))
        integer = next(s.integer for s in self.component.layout.states if s.name == name)
        return (self.k if integer else self.x)[self.k[entry] : self.k[entry] + self.k[entry + 1]]

    def problems(self) -> list[str]:
        """Return everything that is wrong with the present parameters and inputs.

        Returns
        -------
        list of str
            Values that are not finite or out of range; if there are none, those refused together.
        """
        return self.value_problems() or self.component.refusals(self)

    def value_problems(self) -> list[str]:
        """Return every present parameter or input that is no number or out of its range.

        Returns
        -------
        list of str
            The reasons in words.
        """
        found = []
        names = list(self.references)
        for index, (variable, _) in enumerate(self._elements()):
            if variable.causality is not Causality.OUTPUT:
                found += value_problems(variable, names[index], float(self.w[index]))
        return found

    def initialise(self) -> None:
        """Check the parameters, compute the state and the outputs at the start.

        Raises
        ------
        ComponentError
            Parameters or inputs that are refused, all reasons at once.
        """
        if found := self.problems():
            raise ComponentError(self.component.name, found)
        self._check(self.component.initialise(self.w, self.x, self.k))
        self.evaluate()

    def evaluate(self) -> None:
        """Compute the outputs at the start anew, after an input was set.

        Raises
        ------
        DeferredError
            The inputs do not fit the state; they may still change before the first step.
        ComponentError
            There are no outputs.
        """
        status = self.component.evaluate(self.w, self.x, self.k)
        if status in self.component.deferred:
            raise DeferredError(self.component.name, [self.message(status)])
        self._check(status)
        if lost := self.lost():
            raise ComponentError(self.component.name, [lost])

    def step(self, time: float, step: float) -> None:
        """Advance in time.

        Parameters
        ----------
        time, step : float
            Time at the start and length of the step (s).

        Raises
        ------
        ComponentError
            The component cannot go on.
        """
        self._check(self.component.step(time, step, self.w, self.x, self.k), time)
        if lost := self.lost():
            raise ComponentError(self.component.name, [f"at t = {time:.9g} s {lost}"])

    def _check(self, status: int, time: float | None = None) -> None:
        if status != OK:
            at = "" if time is None else f"at t = {time:.9g} s "
            raise ComponentError(self.component.name, [at + self.message(status)])

    def message(self, status: int) -> str:
        """Return the message of a kernel's status, with the present values in it.

        Parameters
        ----------
        status : int
            Status other than OK.

        Returns
        -------
        str
            In words.
        """
        template = self.component.faults.get(status, UNKNOWN_STATUS % status)
        return re.sub(r"\{([^}]+)\}", lambda match: f"{self[match.group(1)]:.6g}", template)

    @property
    def kind(self) -> bytes:
        """16 bytes that only instances with the same variables and sizes share."""
        content = repr(
            (
                self.component.name,
                sorted(self.sizes.items()),
                list(self.references),
                self.x.size,
                self.k.size,
            )
        )
        return hashlib.sha256(content.encode()).digest()[:16]

    def to_bytes(self) -> bytes:
        """Return the complete state, exact to the bit."""
        header = HEADER.pack(MAGIC, self.kind, self.w.size, self.x.size, self.k.size)
        return header + self.w.tobytes() + self.x.tobytes() + self.k.tobytes()

    def from_bytes(self, content: bytes, computed: bool = True) -> None:
        """Take over a state that :meth:`to_bytes` wrote, in this process or another.

        Parameters
        ----------
        content : bytes
            The serialized state.
        computed : bool
            Whether its instance was initialised; before, the hidden arrays are not looked at.

        Raises
        ------
        ComponentError
            Not such a state, of another component or size, cut short, or with numbers in it that
            no state of this component has. Nothing is taken over then.
        """
        expected = HEADER.pack(MAGIC, self.kind, self.w.size, self.x.size, self.k.size)
        if content[: HEADER.size] != expected or len(content) != len(expected) + 8 * (
            self.w.size + self.x.size + self.k.size
        ):
            raise ComponentError(self.component.name, [FOREIGN_STATE])
        values = np.frombuffer(content, np.float64, self.w.size + self.x.size, len(expected))
        integers = np.frombuffer(content, np.int64, self.k.size, len(expected) + values.nbytes)
        layout = self.component.layout
        if problem := state_problem(layout, self.sizes, values, integers, computed):
            raise ComponentError(self.component.name, [IMPOSSIBLE_STATE % problem])
        self.w[:], self.x[:] = values[: self.w.size], values[self.w.size :]
        self.k[:] = integers

    def lost(self) -> str:
        """Return why the present values are no result: one of them is no finite number.

        Returns
        -------
        str
            The first such value in words; empty if there is none.
        """
        where = np.flatnonzero(~np.isfinite(self.w))
        if not where.size:
            return ""
        return LOST % (list(self.references)[where[0]], f"{self.w[where[0]]:.6g}")


def _on_cache_lines(length: int) -> Buffer:
    """Return zeros that begin where a cache line begins.

    States whose rows are cache lines are read faster so.
    """
    room = np.zeros(length + 8)
    begin = -room.ctypes.data // 8 % 8
    return room[begin : begin + length]


def value_problems(variable: Variable, name: str, value: float) -> list[str]:
    """Return what is wrong with a value: not finite, out of range, not whole; or nothing.

    Parameters
    ----------
    variable : Variable
        Its declaration.
    name : str
        Name of the variable or of the element of an array.
    value : float
        The value, in the unit of the variable.

    Returns
    -------
    list of str
        The reason in words, if there is one.
    """
    low = -np.inf if variable.minimum is None else variable.minimum
    high = np.inf if variable.maximum is None else variable.maximum
    if not np.isfinite(value):
        return [NOT_FINITE % (name, value, variable.description)]
    if not low <= value <= high:
        words = range_in_words(variable.minimum, variable.maximum, variable.unit)
        return [
            OUT_OF_RANGE % (name, f"{value:.6g}", _suffix(variable), words, variable.description)
        ]
    if variable.kind in (Kind.INTEGER, Kind.ENUMERATION, Kind.BOOLEAN) and value != int(value):
        return [NOT_WHOLE % (name, f"{value:.6g}", variable.description)]
    return []


def _suffix(variable: Variable) -> str:
    return "" if variable.unit == "1" else f" {variable.unit}"
