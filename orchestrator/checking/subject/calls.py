"""Calls of an FMU's functions: each is written down before it is made, and its status looked at.

A process that ends inside a call leaves the name of the function behind.
"""

import ctypes
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from ...core.fmu.slave import ERROR, OK, WARNING, status_name
from .variables import Declared, Numbers

_LONGEST_NAME = 128
"""Bytes for the name of a function in the trail."""


class Trail:
    """File with the name of the function that is being called.

    Parameters
    ----------
    file : Path
        Is written.
    """

    def __init__(self, file: Path) -> None:
        self._number = os.open(file, os.O_RDWR | os.O_CREAT, 0o600)

    def mark(self, function: str) -> None:
        """Write down that a function is called now."""
        os.lseek(self._number, 0, os.SEEK_SET)
        os.write(self._number, function.encode()[:_LONGEST_NAME].ljust(_LONGEST_NAME))


@dataclass(frozen=True)
class Said:
    """A message of the FMU: status, category and text."""

    status: int
    category: str
    text: str


class CallRefused(Exception):  # noqa: N818 (often the right answer)
    """A call that returned a bad status.

    Attributes
    ----------
    function : str
        Name of the function.
    status : int
        As it was returned.
    said : str
        The first message of the call; empty without any.
    """

    def __init__(self, function: str, status: int, said: str = "") -> None:
        self.function = function
        self.status = status
        self.said = said
        reason = f" ({said})" if said else ""
        super().__init__(f"{function} returned {status_name(status)}{reason}")


class NoInstance(Exception):  # noqa: N818
    """The FMU made no instance; the text is that of its messages."""


class CannotLoad(Exception):  # noqa: N818
    """The library of the FMU cannot be loaded, or lacks functions."""


@dataclass
class Answer:
    """The answer of an FMU to a call that it may refuse.

    Attributes
    ----------
    status : int
        As it was returned.
    said : list of Said
        Messages of the call.
    """

    status: int
    said: list[Said] = field(default_factory=list)

    @property
    def refused(self) -> bool:
        """Tell whether the importer hears that the call was wrong: by status or by message."""
        bad = not OK <= self.status <= WARNING
        return bad or any(message.status >= ERROR for message in self.said)


@dataclass(frozen=True)
class Stepped:
    """End of a step: time reached (s), whether it ended early, whether the FMU wants to end."""

    reached: float
    early: bool = False
    terminated: bool = False


class Called:
    """An instance of the FMU under check. Every bad status raises :class:`CallRefused`.

    Subclasses have the functions of one version of FMI.

    Parameters
    ----------
    dll : object
        Library with functions whose types are set.
    trail : Trail
        Gets the name of each function.
    name : str
        Of the instance.

    Attributes
    ----------
    time : float
        Communication point (s).
    aside : str
        Stands behind the name of the next function in the trail.
    messages : list of Said
        All messages, oldest first.
    """

    prefix = ""
    types: ClassVar[Mapping[str, Any]] = {}

    def __init__(self, dll: Any, trail: Trail, name: str) -> None:
        self.dll = dll
        self.trail = trail
        self.name = name
        self.pointer: Any = None
        self.time = 0.0
        self.aside = ""
        self.messages: list[Said] = []

    # ------------------------------------------------------------------ calls

    def call(self, function: str, *arguments: Any) -> int:
        """Call a function of this instance that returns a status.

        Parameters
        ----------
        function : str
            Without ``fmi2`` or ``fmi3``.
        *arguments
            Behind the instance.

        Returns
        -------
        int
            OK or WARNING.

        Raises
        ------
        CallRefused
            Any other status.
        """
        name = self.prefix + function
        before = len(self.messages)
        self.trail.mark(name + self.aside)
        self.aside = ""
        status = int(getattr(self.dll, name)(self.pointer, *arguments))
        if not OK <= status <= WARNING:
            said = self.messages[before:]
            raise CallRefused(name, status, said[0].text if said else "")
        return status

    def attempt(self, act: Callable[..., Any], *arguments: Any) -> Answer:
        """Return the answer to a call that the FMU may refuse.

        Parameters
        ----------
        act : callable
            A method of this instance.
        *arguments
            Of the method.
        """
        before = len(self.messages)
        status = OK
        try:
            act(*arguments)
        except CallRefused as refused:
            status = refused.status
        return Answer(status, self.messages[before:])

    def terminate(self) -> None:
        """End the simulation of this instance."""
        self.call("Terminate")

    def reset(self) -> None:
        """Go back to the state after the instantiation."""
        self.call("Reset")

    def free(self) -> None:
        """Free the instance, after which nothing may be called."""
        self.trail.mark(f"{self.prefix}FreeInstance")
        getattr(self.dll, f"{self.prefix}FreeInstance")(self.pointer)
        self.pointer = None

    def exit_initialisation(self) -> None:
        """Leave the initialisation mode, ready to step."""
        self.call("ExitInitializationMode")

    def initialise(self, start: float = 0.0, stop: float | None = None) -> None:
        """Set up the experiment, enter and exit the initialisation mode."""
        self.enter_initialisation(start, stop)
        self.exit_initialisation()

    def enter_initialisation(self, start: float = 0.0, stop: float | None = None) -> None:
        """Enter the initialisation mode, with times (s)."""
        raise NotImplementedError

    def step(self, step: float, time: float | None = None) -> Stepped:
        """Make a step (s), from the communication point or another time (s)."""
        raise NotImplementedError

    # ------------------------------------------------------------------ values

    def get(self, variables: Sequence[Declared]) -> dict[str, Numbers]:
        """Read variables, with one call for each family of types."""
        values: dict[str, Numbers] = {}
        for kind in dict.fromkeys(variable.kind for variable in variables):
            group = [variable for variable in variables if variable.kind == kind]
            values |= self._get_kind(kind, group)
        return {variable.name: values[variable.name] for variable in variables}

    def _get_kind(self, kind: str, group: Sequence[Declared]) -> dict[str, Numbers]:
        total = sum(variable.size for variable in group)
        found = self.get_raw(kind, [variable.reference for variable in group], total)
        values = {}
        at = 0
        for variable in group:
            values[variable.name] = tuple(found[at : at + variable.size])
            at += variable.size
        return values

    def get_raw(self, kind: str, references: Sequence[int], total: int) -> list[Any]:
        """Read values by their references.

        Parameters
        ----------
        kind : str
            Family of types.
        references : sequence of int
            Value references.
        total : int
            Number of values.
        """
        raise NotImplementedError

    def set(self, variable: Declared, values: Numbers) -> None:
        """Set all elements of a variable."""
        self.set_raw(variable.kind, [variable.reference], values)

    def set_raw(self, kind: str, references: Sequence[int], values: Sequence[Any]) -> None:
        """Set values by their references."""
        raise NotImplementedError

    # ------------------------------------------------------------------ derivatives

    def derivatives(
        self,
        unknowns: Sequence[Declared],
        knowns: Sequence[Declared],
        seed: Sequence[float],
        adjoint: bool = False,
    ) -> list[float]:
        """Return partial derivatives times a seed.

        Parameters
        ----------
        unknowns, knowns : sequence of Declared
            Variables that are derived, and by which.
        seed : sequence of float
            Weight of each element of the knowns; of an adjoint, of the unknowns.
        adjoint : bool
            Whether the derivatives of the weighted unknowns are asked for.

        Returns
        -------
        list of float
            One for each element of the unknowns; of an adjoint, of the knowns. An element that the
            FMU leaves as it is, is NaN.
        """
        total = sum(variable.size for variable in (knowns if adjoint else unknowns))
        found = as_ctypes(ctypes.c_double, [math.nan] * total)
        arguments: list[Any] = []
        for group in (unknowns, knowns):
            which = as_ctypes(ctypes.c_uint, [variable.reference for variable in group])
            arguments += (which, len(group))
        arguments += self._seed_and_result(seed, found, total)
        self.call(f"Get{'Adjoint' if adjoint else 'Directional'}Derivative", *arguments)
        return list(found[:total])

    def _seed_and_result(self, seed: Sequence[float], found: Any, total: int) -> tuple[Any, ...]:
        """Return the last arguments of a call for derivatives."""
        raise NotImplementedError

    # ------------------------------------------------------------------ state

    _STATE = ""
    _DESERIALIZE = ""

    def state(self, into: Any = None) -> Any:
        """Return the state; ``into`` is one to write over."""
        pointer = ctypes.c_void_p() if into is None else into
        self.call(f"Get{self._STATE}", ctypes.byref(pointer))
        return pointer

    def restore(self, state: Any) -> None:
        """Go back to a state."""
        self.call(f"Set{self._STATE}", state)

    def free_state(self, state: Any) -> None:
        """Free a state that was taken."""
        self.call(f"Free{self._STATE}", ctypes.byref(state))

    def serialize(self, state: Any) -> bytes:
        """Return a state as bytes."""
        size = ctypes.c_size_t()
        self.call(f"Serialized{self._STATE}Size", state, ctypes.byref(size))
        content = (self._BYTE * size.value)()
        self.call(f"Serialize{self._STATE}", state, content, size.value)
        return bytes(content)

    def deserialize(self, content: bytes) -> Any:
        """Return the state of bytes."""
        pointer = ctypes.c_void_p()
        held = (self._BYTE * max(1, len(content))).from_buffer_copy(content or b"\0")
        self.call(self._DESERIALIZE, held, len(content), ctypes.byref(pointer))
        return pointer

    _BYTE: Any = ctypes.c_char


def as_numbers(content: Sequence[Any]) -> list[Any]:
    """Return the values of an array of ctypes; texts are decoded."""
    return [v.decode("utf-8") if isinstance(v, bytes) else v for v in content]


def as_ctypes(kind: Any, values: Sequence[Any]) -> Any:
    """Return an array of ctypes with room for one value at least."""
    held = (kind * max(1, len(values)))()
    for place, value in enumerate(values):
        held[place] = value.encode() if isinstance(value, str) else value
    return held
