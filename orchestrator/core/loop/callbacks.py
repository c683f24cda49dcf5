"""C functions that call a slave in Python, so that the loop calls every slave by addresses."""

import ctypes
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..fmu.slave import ERROR, FATAL, WARNING, Addresses, Slave, SlaveLost, SlaveOfFmi3
from ..fmu.types import TYPES, NumberType

_MOVE = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p
)
_COUNTED_MOVE = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_size_t,
    ctypes.c_void_p,
    ctypes.c_size_t,
)
_STEP = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int
)
_PARTIAL_STEP = ctypes.CFUNCTYPE(
    *(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int),
    *[ctypes.POINTER(ctypes.c_bool)] * 3,
    ctypes.POINTER(ctypes.c_double),
)


class Callbacks:
    """C functions for one slave.

    An exception cannot cross the loop. The first one is kept in ``raised``, becomes a message of
    the slave, and the status Error ends the loop.

    Parameters
    ----------
    slave : Slave
        Without addresses of its own.

    Attributes
    ----------
    addresses : Addresses
        Of the C functions, which live as long as this object.
    raised : BaseException or None
        Exception of the slave.
    """

    def __init__(self, slave: Slave) -> None:
        self._slave = slave
        self._arrays: dict[tuple[int, int, Any], NDArray[Any]] = {}
        self.raised: BaseException | None = None
        setters = {name: self._made(moved, self._set) for name, moved in TYPES.items()}
        getters = {name: self._made(moved, self._get) for name, moved in TYPES.items()}
        in_parts = hasattr(slave, "partial_step")
        made = (_PARTIAL_STEP, self._partial_step) if in_parts else (_STEP, self._step)
        step = made[0](self._guarded(made[1]))
        self._kept = (setters, getters, step)
        self.addresses = Addresses(
            0,
            {kind: _address(function) for kind, function in setters.items()},
            {kind: _address(function) for kind, function in getters.items()},
            _address(step),
            may_return_early=in_parts,
        )

    def _guarded(self, function: Callable[..., int]) -> Callable[..., int]:
        def call(*arguments: Any) -> int:
            try:
                return function(*arguments)
            except SlaveLost as lost:  # its messages say so
                self.raised = lost
                return FATAL
            except BaseException as error:
                self.raised = error
                self._slave.messages.append((ERROR, f"{type(error).__name__}: {error}"))
                return ERROR

        return call

    def _made(self, moved: NumberType, move: Callable[..., int]) -> Any:
        """Return a C function that moves values of a type."""

        def call(_instance: Any, references: int, count: int, values: int, number: int = 0) -> int:
            numbers = self._array(references, count, np.dtype(np.uint32))
            return move(moved.name, numbers, self._array(values, number or count, moved.number))

        return (_COUNTED_MOVE if moved.is_counted else _MOVE)(self._guarded(call))

    def _set(self, name: str, references: NDArray[np.uint32], values: NDArray[Any]) -> int:
        return self._slave.set(references, values.astype(np.float64, copy=False), name)

    def _get(self, name: str, references: NDArray[np.uint32], values: NDArray[Any]) -> int:
        if values.dtype == np.float64:
            return self._slave.get(references, values, name)
        out = np.zeros(values.size)
        status = self._slave.get(references, out, name)
        if status <= WARNING:  # what is refused may not fit here
            values[:] = out
        return status

    def _step(self, _instance: Any, time: float, step: float, forgets: int) -> int:
        self._tell(forgets)
        return self._slave.step(time, step)

    def _partial_step(
        self, _instance: Any, time: float, step: float, forgets: int, *told: Any
    ) -> int:
        self._tell(forgets)
        done = cast(SlaveOfFmi3, self._slave).partial_step(time, step)
        for place, fact in zip(told, done[1:], strict=True):
            place[0] = fact
        return done.status

    def _tell(self, forgets: int) -> None:
        """Tell a slave that passes it on whether it will have to go back before this step."""
        if hasattr(self._slave, "forgets"):
            self._slave.forgets = bool(forgets)

    def _array(self, address: int, count: int, number: np.dtype[Any]) -> NDArray[Any]:
        """Return the numbers at an address; the loop uses the same few addresses all the time."""
        key = (address, count, number)
        if key not in self._arrays:
            content: Any = (ctypes.c_uint8 * (count * number.itemsize)).from_address(address)
            self._arrays[key] = np.frombuffer(content, number)
        return self._arrays[key]


def _address(function: Any) -> int:
    return int(ctypes.cast(function, ctypes.c_void_p).value or 0)
