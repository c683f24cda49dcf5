"""Instances of FMUs of FMI 3.0 for co-simulation.

Event mode is never asked for: an FMU handles its events inside its steps, and may return early at
one. The rest of the step is then made in further ones.
"""

import contextlib
import ctypes
import itertools
import math
import os
import weakref
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from fmpy.fmi3 import (
    FMU3Slave,
    fmi3FMUState,
    fmi3IntermediateUpdateCallback,
    fmi3LogMessageCallback,
)

from ...temporary import TemporaryFolder
from ..errors import InputRefused, Problem
from .description import Description
from .slave import (
    DISCARD,
    ERROR,
    FATAL,
    OK,
    REAL,
    WARNING,
    Addresses,
    Messages,
    PartialStep,
    ValueReferences,
    Values,
    counts_of,
    status_name,
)
from .types import LARGEST_WHOLE, MORE_BITS, TYPES, TYPES_3

ROUNDING = 2.0**-51
"""Part of its time by which a step may end before its end without that being an early return."""
MOST_RETURNS = 100_000
"""Early returns in one communication step, at most: a step that ends at ever the same event."""


class File(Protocol):
    """An FMU file that can be unpacked."""

    path: Path

    def unpack(self, folder: Path) -> None:
        """Unpack everything into a folder."""


_slaves: "weakref.WeakValueDictionary[int, Fmi3Slave]" = weakref.WeakValueDictionary()
_keys = itertools.count(1)


def _log(environment: int, status: int, _category: bytes, message: bytes) -> None:
    """Pass a message of an FMU to the slave it belongs to."""
    slave = _slaves.get(environment)
    if slave is not None:
        slave.messages.append((status, (message or b"").decode("utf-8", "replace")))


_LOGGER = fmi3LogMessageCallback(_log)
_NO_UPDATE = fmi3IntermediateUpdateCallback()
_MOVE = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_size_t,
    ctypes.c_void_p,
    ctypes.c_size_t,
)


class StepsInParts:
    """Communication steps of an instance that may return early from one.

    Attributes
    ----------
    forgets : bool
        Whether it may forget states before a step: it will not go back to them.
    """

    messages: list[tuple[int, str]]
    forgets = True
    _terminated_at: float | None = None

    def partial_step(self, time: float, step: float) -> PartialStep:
        """Make a step (s) from a time (s), or the beginning of it."""
        raise NotImplementedError

    def step(self, time: float, step: float) -> int:
        """Make a step (s) from a time (s), in as many parts as the FMU makes of it."""
        end = time + step
        worst = OK
        for _ in range(MOST_RETURNS):
            done = self.partial_step(time, step)
            worst = max(worst, done.status)
            if done.ended:
                self._terminated_at = done.reached
                return DISCARD
            if done.status > WARNING or not done.early or is_reached(done.reached, end):
                return worst
            if not done.reached >= time:  # at the time of an event, a step may come no further
                break
            time = done.reached
            step = end - time
        self.messages.append((ERROR, f"returned early from its step again and again at {time:g} s"))
        return ERROR

    def terminated_at(self) -> float | None:
        """Return the time (s) up to which a step went that has ended the run."""
        return self._terminated_at


class Fmi3Slave(StepsInParts):
    """An instance of an FMU of FMI 3.0. See :class:`rockshed.core.fmu.slave.Slave`.

    Parameters
    ----------
    file : File
        The FMU.
    name : str
        Of the component.
    description : Description
        Of the FMU.

    Raises
    ------
    InputRefused
        The library cannot be loaded, or it makes no instance.
    """

    def __init__(self, file: File, name: str, description: Description) -> None:
        self.name = name
        self.messages: list[tuple[int, str]] = Messages()
        self._folder = TemporaryFolder()
        self._fmu: Any = None
        self._span: tuple[float, float, float | None] = (0.0, math.inf, None)
        self._mark = fmi3FMUState()
        self._key = next(_keys)
        _slaves[self._key] = self
        try:
            file.unpack(Path(self._folder.name))
            # fmpy goes elsewhere, and stays there if the library cannot be loaded
            with contextlib.chdir(os.getcwd()):
                self._fmu = FMU3Slave(
                    instanceName=name,
                    guid=description.guid,
                    modelIdentifier=description.identifier,
                    unzipDirectory=self._folder.name,
                )
            self._instantiate(description)
            self._elements = _elements(description)
        except Exception as error:  # the loader raises many kinds
            self._unload()
            said = "; ".join(text for _, text in self.messages)
            what = f"no instance of {file.path} can be made: {error} {said}".rstrip()
            remedy = "see whether the FMU runs in another tool"
            raise InputRefused([Problem(name, what, remedy)]) from error
        self.addresses: Addresses | None = self._find_addresses()
        self._setters = {key: _MOVE(address) for key, address in self.addresses.set.items()}
        self._getters = {key: _MOVE(address) for key, address in self.addresses.get.items()}

    def _instantiate(self, description: Description) -> None:
        self._instance = self._fmu.dll.fmi3InstantiateCoSimulation(
            self.name.encode(),
            description.guid.encode(),
            os.path.join(self._folder.name, "resources", "").encode(),
            False,
            True,
            False,
            description.may_return_early,
            (ctypes.c_uint * 0)(),
            0,
            self._key,
            _LOGGER,
            _NO_UPDATE,
        )
        if not self._instance:
            raise ValueError("fmi3InstantiateCoSimulation returned no instance")

    def _find_addresses(self) -> Addresses:
        def address(function: str) -> int:
            return int(ctypes.cast(getattr(self._fmu.dll, function), ctypes.c_void_p).value or 0)

        return Addresses(
            int(self._instance),
            {key: address(f"fmi3Set{TYPES[key].call}") for key in TYPES_3},
            {key: address(f"fmi3Get{TYPES[key].call}") for key in TYPES_3},
            address("fmi3DoStep"),
            may_return_early=True,
        )

    # ------------------------------------------------------------------ values

    def set(self, references: ValueReferences, values: Values, kind: str = REAL) -> int:
        """Set variables of one type; of arrays, all elements one after the other."""
        passed = np.ascontiguousarray(values, TYPES[kind].number)
        return self._move(self._setters[kind], references, passed)

    def get(self, references: ValueReferences, out: Values, kind: str = REAL) -> int:
        """Read variables of one type into ``out``."""
        passed = np.zeros(out.size, TYPES[kind].number)
        status = self._move(self._getters[kind], references, passed)
        out[:] = passed
        if TYPES[kind].is_whole and (unfit := _inexact(passed)) is not None:
            name = self._variable(references, unfit)
            self.messages.append((ERROR, f"{name} = {passed[unfit]}, {MORE_BITS}"))
            return ERROR
        return status

    def _variable(self, references: ValueReferences, place: int) -> str:
        """Return the name of the variable whose value is at a place among those of references."""
        elements = [name for reference in references for name in self._elements[int(reference)]]
        return elements[place]

    def _move(self, function: Any, references: ValueReferences, values: Any) -> int:
        return int(
            function(
                self._instance,
                references.ctypes.data,
                references.size,
                values.ctypes.data,
                values.size,
            )
        )

    def set_text(self, reference: int, text: str) -> int:
        """Set one variable of the kind String."""
        return self.set_texts(reference, [text])

    def set_texts(self, reference: int, texts: Sequence[str]) -> int:
        """Set all elements of a variable of the kind String."""
        values = (ctypes.c_char_p * len(texts))(*(text.encode() for text in texts))
        return self._status("SetString", (ctypes.c_uint * 1)(reference), 1, values, len(texts))

    def get_texts(self, reference: int, count: int) -> tuple[int, list[str]]:
        """Return status and texts of a variable of the kind String."""
        values = (ctypes.c_char_p * count)()
        passed = ((ctypes.c_uint * 1)(reference), 1, values, count)
        status = self._status("GetString", *passed)
        return status, [(value or b"").decode("utf-8", "replace") for value in values]

    # ------------------------------------------------------------------ life cycle

    def configure(self, sizes: Sequence[tuple[ValueReferences, Values, str]]) -> int:
        """Set structural parameters, in configuration mode."""
        entered = self._status("EnterConfigurationMode")
        if entered > WARNING:
            return entered
        worst = max(entered, *(self.set(*size) for size in sizes))
        return max(worst, self._status("ExitConfigurationMode"))

    def setup_experiment(self, start: float, stop: float, tolerance: float | None = None) -> int:
        """Keep start and end of the run (s), and the relative tolerance of the FMU's solver."""
        self._span = (start, stop, tolerance)
        return OK

    def enter_initialisation(self) -> int:
        """Enter the initialisation mode of the FMU, with the times of the run."""
        start, stop, tolerance = self._span
        has_tolerance = tolerance is not None
        has_stop = math.isfinite(stop)
        times = (start, has_stop, stop if has_stop else 0.0)
        return self._status("EnterInitializationMode", has_tolerance, tolerance or 0.0, *times)

    def exit_initialisation(self) -> int:
        """Leave the initialisation mode of the FMU."""
        return self._status("ExitInitializationMode")

    def partial_step(self, time: float, step: float) -> PartialStep:
        """Make a step (s) from a time (s), or the beginning of it."""
        event, terminate, early = (ctypes.c_bool() for _ in range(3))
        reached = ctypes.c_double(time)
        told = [ctypes.byref(answer) for answer in (event, terminate, early, reached)]
        status = self._status("DoStep", time, step, self.forgets, *told)
        return PartialStep(status, event.value, terminate.value, early.value, reached.value)

    def reset(self) -> int:
        """Go back to the state after the instantiation."""
        self._terminated_at = None
        return self._status("Reset")

    def terminate(self) -> int:
        """End the run of this instance."""
        return self._status("Terminate")

    def free(self) -> None:
        """Free the instance, unload the library and remove the unpacked files.

        An instance that failed beyond repair is not called any more.
        """
        if all(status != FATAL for status, _ in self.messages):
            self._forget_mark()
            self._fmu.dll.fmi3FreeInstance(self._instance)
        self._unload()

    def _unload(self) -> None:
        if self._fmu is not None:
            self._fmu.freeLibrary()
        self._folder.cleanup()

    # ------------------------------------------------------------------ state

    def state(self) -> bytes:
        """Serialize the complete state.

        Raises
        ------
        RuntimeError
            A call failed.
        """
        what = "the state cannot be read"
        state = fmi3FMUState()
        size = ctypes.c_size_t()
        self._demand(what, "GetFMUState", ctypes.byref(state))
        with self._freed(state):
            self._demand(what, "SerializedFMUStateSize", state, ctypes.byref(size))
            content = (ctypes.c_uint8 * size.value)()
            self._demand(what, "SerializeFMUState", state, content, size)
            return bytes(content)

    def restore(self, content: bytes) -> None:
        """Take over a state of :meth:`state`.

        Parameters
        ----------
        content : bytes
            State of this FMU.

        Raises
        ------
        RuntimeError
            A call failed: this is no state of its own.
        """
        what = "the state cannot be restored"
        state = fmi3FMUState()
        passed = (ctypes.c_uint8 * len(content)).from_buffer_copy(content)
        made = ctypes.byref(state)
        self._demand(what, "DeserializeFMUState", passed, len(content), made)
        with self._freed(state):
            self._demand(what, "SetFMUState", state)

    def mark(self) -> None:
        """Keep the present state in memory.

        Raises
        ------
        RuntimeError
            A call failed.
        """
        self._forget_mark()
        self._demand("the state cannot be kept", "GetFMUState", ctypes.byref(self._mark))

    def roll_back(self) -> None:
        """Go back to the state that was kept.

        Raises
        ------
        RuntimeError
            A call failed.
        """
        self._terminated_at = None
        self._demand("the state that was kept is refused", "SetFMUState", self._mark)

    def _forget_mark(self) -> None:
        if self._mark:
            self._status("FreeFMUState", ctypes.byref(self._mark))
            self._mark = fmi3FMUState()

    @contextlib.contextmanager
    def _freed(self, state: Any) -> Iterator[None]:
        try:
            yield
        finally:
            self._status("FreeFMUState", ctypes.byref(state))

    def _demand(self, what: str, function: str, *arguments: Any) -> None:
        """Call a function; raise a RuntimeError for a bad status."""
        status = self._status(function, *arguments)
        if not OK <= status <= WARNING:
            raise RuntimeError(f"{self.name}: {what}: {self.messages[-1][1]}")

    # ------------------------------------------------------------------ calls

    def _status(self, function: str, *arguments: Any) -> int:
        """Return the status of a call; a bad one becomes a message where the FMU is silent."""
        count = sum(counts_of(self.messages).values())
        status = int(getattr(self._fmu.dll, f"fmi3{function}")(self._instance, *arguments))
        if OK <= status <= WARNING:
            return status
        if sum(counts_of(self.messages).values()) == count:
            self.messages.append((status, f"fmi3{function} returned {status_name(status)}"))
        return status


def _inexact(values: Any) -> int | None:
    """Return the place of the first whole number that a float64 does not hold exactly."""
    if not values.size or max(int(values.max()), -int(values.min())) <= LARGEST_WHOLE:
        return None
    return next(i for i, value in enumerate(values) if abs(int(value)) > LARGEST_WHOLE)


def _elements(description: Description) -> dict[int, list[str]]:
    """Return the names of the variables and of the elements of arrays by value reference."""
    named: dict[int, list[str]] = {}
    for port in description.ports.values():
        if not port.is_alias:
            named.setdefault(port.reference, []).append(port.name)
    return named


def is_reached(time: float, end: float) -> bool:
    """Tell whether a time (s) is the end of a step, up to rounding."""
    return time >= end - ROUNDING * abs(end)
