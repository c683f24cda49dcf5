"""C functions that call a slave in Python, so that the loop calls every slave by addresses."""

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fmu.slave import BOOLEAN, ERROR, INTEGER, REAL, Addresses, Slave

_MOVE = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p
)
_STEP = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int
)
_KINDS = (REAL, INTEGER, BOOLEAN)


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
        setters = {kind: _MOVE(self._guarded(self._setter(kind))) for kind in _KINDS}
        getters = {kind: _MOVE(self._guarded(self._getter(kind))) for kind in _KINDS}
        step = _STEP(self._guarded(self._step))
        self._kept = (setters, getters, step)
        self.addresses = Addresses(
            0,
            {kind: _address(function) for kind, function in setters.items()},
            {kind: _address(function) for kind, function in getters.items()},
            _address(step),
        )

    def _guarded(self, function: Callable[..., int]) -> Callable[..., int]:
        def call(*arguments: Any) -> int:
            try:
                return function(*arguments)
            except BaseException as error:
                self.raised = error
                self._slave.messages.append((ERROR, f"{type(error).__name__}: {error}"))
                return ERROR

        return call

    def _setter(self, kind: str) -> Callable[..., int]:
        def move(_instance: Any, references: int, count: int, values: int) -> int:
            numbers = self._array(references, count, ctypes.c_uint32)
            if kind == REAL:
                return self._slave.set(numbers, self._array(values, count, ctypes.c_double), kind)
            whole = self._array(values, count, ctypes.c_int32)
            return self._slave.set(numbers, whole.astype(np.float64), kind)

        return move

    def _getter(self, kind: str) -> Callable[..., int]:
        def move(_instance: Any, references: int, count: int, values: int) -> int:
            numbers = self._array(references, count, ctypes.c_uint32)
            if kind == REAL:
                return self._slave.get(numbers, self._array(values, count, ctypes.c_double), kind)
            out = np.zeros(count)
            status = self._slave.get(numbers, out, kind)
            self._array(values, count, ctypes.c_int32)[:] = out
            return status

        return move

    def _step(self, _instance: Any, time: float, step: float, _forgets: int) -> int:
        return self._slave.step(time, step)

    def _array(self, address: int, count: int, number: Any) -> NDArray[Any]:
        """Return the numbers at an address; the loop uses the same few addresses all the time."""
        key = (address, count, number)
        if key not in self._arrays:
            self._arrays[key] = np.frombuffer((number * count).from_address(address), number)
        return self._arrays[key]


def _address(function: Any) -> int:
    return int(ctypes.cast(function, ctypes.c_void_p).value or 0)
