"""An instance of FMI 2.0."""

import ctypes
from collections.abc import Sequence
from functools import cache
from typing import Any, ClassVar

from fmpy import calloc, free
from fmpy.fmi2 import (
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2CoSimulation,
)

from ...core.fmu.logger import set_logger
from .calls import Called, CallRefused, NoInstance, Said, Stepped, Trail, as_ctypes, as_numbers

_LAST_SUCCESSFUL_TIME, _TERMINATED = 2, 3
_DISCARD = 2


_HEARERS: dict[int, "Called2"] = {}
"""Instances by the number that their callbacks have as environment."""


def _hear(environment: Any, name: bytes, status: int, category: bytes, text: bytes) -> None:
    words = ((part or b"").decode("utf-8", "replace") for part in (category, text))
    hearer = _HEARERS.get(environment or 0)
    if hearer is not None:
        hearer.messages.append(Said(status, *words))


@cache
def _common_callbacks() -> fmi2CallbackFunctions:
    """Return callbacks that serve all instances: those of fmpy's proxy are never freed."""
    callbacks = fmi2CallbackFunctions()
    callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    set_logger(callbacks, fmi2CallbackLoggerTYPE(_hear))
    return callbacks


def _callbacks(hearer: "Called2") -> fmi2CallbackFunctions:
    """Return callbacks whose messages go to an instance."""
    number = max(_HEARERS, default=0) + 1
    _HEARERS[number] = hearer
    callbacks = fmi2CallbackFunctions.from_buffer_copy(_common_callbacks())
    callbacks.componentEnvironment = number
    return callbacks


class Called2(Called):
    """An instance of FMI 2.0.

    Parameters
    ----------
    dll, trail, name
        As of the base.
    token : str
        GUID.
    resources : str
        URI of the folder of the resources.
    logging : bool
        Whether messages are asked for.

    Raises
    ------
    NoInstance
        The FMU made none.
    """

    prefix = "fmi2"
    types: ClassVar[dict[str, Any]] = {
        "Real": ctypes.c_double,
        "Integer": ctypes.c_int,
        "Boolean": ctypes.c_int,
        "String": ctypes.c_char_p,
    }
    _STATE = "FMUstate"
    _DESERIALIZE = "DeSerializeFMUstate"

    def __init__(
        self, dll: Any, trail: Trail, name: str, token: str, resources: str, logging: bool = True
    ) -> None:
        super().__init__(dll, trail, name)
        self._callbacks = _callbacks(self)
        trail.mark("fmi2Instantiate")
        self.pointer = dll.fmi2Instantiate(
            name.encode(),
            fmi2CoSimulation,
            token.encode(),
            resources.encode(),
            ctypes.byref(self._callbacks),
            0,
            int(logging),
        )
        if not self.pointer:
            raise NoInstance("; ".join(message.text for message in self.messages))

    def free(self) -> None:
        """Free the instance, and forget its callbacks."""
        super().free()
        _HEARERS.pop(int(self._callbacks.componentEnvironment), None)

    def set_up(self, start: float = 0.0, stop: float | None = None) -> None:
        """Set up the experiment, with times (s)."""
        has_stop = int(stop is not None)
        self.call("SetupExperiment", 0, 0.0, start, has_stop, 0.0 if stop is None else stop)
        self.time = start

    def enter_initialisation(self, start: float = 0.0, stop: float | None = None) -> None:
        """Enter the initialisation mode, with times (s)."""
        self.set_up(start, stop)
        self.call("EnterInitializationMode")

    def step(self, step: float, time: float | None = None) -> Stepped:
        """Make a step (s), from the communication point or another time (s)."""
        begin = self.time if time is None else time
        self.aside = f" from t = {begin:g} s by {step:g} s"
        try:
            self.call("DoStep", begin, step, 1)
        except CallRefused as refused:
            if refused.status == _DISCARD and (reached := self._terminated_at()) is not None:
                self.time = reached
                return Stepped(reached, terminated=True)
            raise
        self.time = begin + step
        return Stepped(self.time)

    def _terminated_at(self) -> float | None:
        """Return the time (s) reached, if the FMU wants to end there."""
        wants = ctypes.c_int()
        reached = ctypes.c_double()
        try:
            self.call("GetBooleanStatus", _TERMINATED, ctypes.byref(wants))
            self.call("GetRealStatus", _LAST_SUCCESSFUL_TIME, ctypes.byref(reached))
        except CallRefused:
            return None
        return reached.value if wants.value else None

    def get_raw(self, kind: str, references: Sequence[int], total: int) -> list[Any]:
        """Read values by their references."""
        held = (self.types[kind] * max(1, total))()
        which = as_ctypes(ctypes.c_uint, references)
        self.call(f"Get{kind}", which, len(references), held)
        values = as_numbers(held)[:total]
        return [value != 0 if kind == "Boolean" else value for value in values]

    def set_raw(self, kind: str, references: Sequence[int], values: Sequence[Any]) -> None:
        """Set values by their references."""
        held = as_ctypes(self.types[kind], values)
        self.call(f"Set{kind}", as_ctypes(ctypes.c_uint, references), len(references), held)

    def _seed_and_result(self, seed: Sequence[float], found: Any, total: int) -> tuple[Any, ...]:
        return as_ctypes(ctypes.c_double, seed), found
