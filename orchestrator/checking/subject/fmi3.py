"""An instance of FMI 3.0."""

import ctypes
from collections.abc import Sequence
from typing import Any, ClassVar

from fmpy.fmi3 import fmi3IntermediateUpdateCallback, fmi3LogMessageCallback

from .calls import Called, NoInstance, Said, Stepped, Trail, as_ctypes, as_numbers

_MOST_EVENTS = 100
"""Most discrete updates at one time."""


class Called3(Called):
    """An instance of FMI 3.0.

    Parameters
    ----------
    dll, trail, name
        As of the base.
    token : str
        Instantiation token.
    resources : str
        Path of the folder of the resources.
    logging : bool
        Whether messages are asked for.
    **asked : bool
        ``events`` and ``early``: whether event mode is used and steps may end early.

    Raises
    ------
    NoInstance
        The FMU made none.
    """

    prefix = "fmi3"
    types: ClassVar[dict[str, Any]] = {
        "Float32": ctypes.c_float,
        "Float64": ctypes.c_double,
        "Int8": ctypes.c_int8,
        "UInt8": ctypes.c_uint8,
        "Int16": ctypes.c_int16,
        "UInt16": ctypes.c_uint16,
        "Int32": ctypes.c_int32,
        "UInt32": ctypes.c_uint32,
        "Int64": ctypes.c_int64,
        "UInt64": ctypes.c_uint64,
        "Boolean": ctypes.c_bool,
        "String": ctypes.c_char_p,
    }
    _STATE = "FMUState"
    _DESERIALIZE = "DeserializeFMUState"
    _BYTE = ctypes.c_uint8

    def __init__(
        self,
        dll: Any,
        trail: Trail,
        name: str,
        token: str,
        resources: str,
        logging: bool = True,
        **asked: bool,
    ) -> None:
        super().__init__(dll, trail, name)
        self._events = asked.get("events", False)
        self._log = fmi3LogMessageCallback(self._hear)
        self._update = fmi3IntermediateUpdateCallback()  # none
        trail.mark("fmi3InstantiateCoSimulation")
        self.pointer = dll.fmi3InstantiateCoSimulation(
            name.encode(),
            token.encode(),
            resources.encode(),
            False,
            logging,
            self._events,
            asked.get("early", False),
            None,
            0,
            None,
            self._log,
            self._update,
        )
        if not self.pointer:
            raise NoInstance("; ".join(message.text for message in self.messages))

    def _hear(self, environment: Any, status: int, category: bytes, text: bytes) -> None:
        words = ((part or b"").decode("utf-8", "replace") for part in (category, text))
        self.messages.append(Said(status, *words))

    def enter_initialisation(self, start: float = 0.0, stop: float | None = None) -> None:
        """Enter the initialisation mode, with times (s)."""
        has_stop = stop is not None
        until = 0.0 if stop is None else stop
        self.call("EnterInitializationMode", False, 0.0, start, has_stop, until)
        self.time = start

    def exit_initialisation(self) -> None:
        """Leave the initialisation mode; with events, go on to the step mode."""
        super().exit_initialisation()
        if self._events:
            self.handle_events()

    def handle_events(self) -> None:
        """Update the discrete states until none is left, and enter the step mode."""
        flags = [ctypes.c_bool(False) for _ in range(5)]
        when = ctypes.c_double()
        for _ in range(_MOST_EVENTS):
            told = [ctypes.byref(flag) for flag in flags]
            self.call("UpdateDiscreteStates", *told, ctypes.byref(when))
            if not flags[0].value:
                break
        self.call("EnterStepMode")

    def step(self, step: float, time: float | None = None) -> Stepped:
        """Make a step (s), from the communication point or another time (s)."""
        begin = self.time if time is None else time
        self.aside = f" from t = {begin:g} s by {step:g} s"
        event, ends, early = (ctypes.c_bool(False) for _ in range(3))
        reached = ctypes.c_double(begin)
        told = [ctypes.byref(flag) for flag in (event, ends, early)]
        self.call("DoStep", begin, step, True, *told, ctypes.byref(reached))
        self.time = reached.value if early.value or ends.value else begin + step
        if self._events and event.value and not ends.value:
            self.call("EnterEventMode")
            self.handle_events()
        return Stepped(reached.value, bool(early.value), bool(ends.value))

    def get_raw(self, kind: str, references: Sequence[int], total: int) -> list[Any]:
        """Read values by their references."""
        which = as_ctypes(ctypes.c_uint, references)
        if kind == "Binary":
            return self._get_binary(which, len(references), total)
        held = (self.types[kind] * max(1, total))()
        self.call(f"Get{kind}", which, len(references), held, total)
        return as_numbers(held)[:total]

    def _get_binary(self, which: Any, number: int, total: int) -> list[bytes]:
        sizes = (ctypes.c_size_t * max(1, total))()
        held = (ctypes.POINTER(ctypes.c_uint8) * max(1, total))()
        self.call("GetBinary", which, number, sizes, held, total)
        return [ctypes.string_at(held[i], sizes[i]) for i in range(total)]

    def set_raw(self, kind: str, references: Sequence[int], values: Sequence[Any]) -> None:
        """Set values by their references; bytes are not set."""
        held = as_ctypes(self.types[kind], values)
        which = as_ctypes(ctypes.c_uint, references)
        self.call(f"Set{kind}", which, len(references), held, len(values))

    def _seed_and_result(self, seed: Sequence[float], found: Any, total: int) -> tuple[Any, ...]:
        return as_ctypes(ctypes.c_double, seed), len(seed), found, total
