"""Form of everything that passes between a run and the process of an isolated instance.

Errands and replies are records of fixed length in two pipes; a pipe ends with the process behind
it, however that ends. Numbers lie in memory that both processes see. Everything else follows the
record: JSON, and bytes as they are. A reply may come from code that has gone astray: its lengths
are looked at, and nothing in it is executed.
"""

import json
import mmap
import os
import struct
import tempfile
from typing import Any, NamedTuple

import numpy as np

from ..fmu.slave import ValueReferences, Values
from ..fmu.types import TYPES

CALL, SET, GET, STEP = range(4)
"""Operations: a call by its name, and those of the exchange."""
KINDS = list(TYPES)
"""Types of numbers by the number that stands for them in an errand."""
MOST_TOLD = 1 << 26
"""Largest size (bytes) of the JSON in a reply."""
MOST_CONTENT = 1 << 34
"""Largest size (bytes) of a serialized state."""
_BYTES = 12
"""Size of a value and its reference in the memory."""


class Errand(NamedTuple):
    """An errand: operation, type and number of values, times (s), what is behind it.

    kind: of a step, whether earlier states may be forgotten.
    number: of the errand. capacity: values for which the memory has room. told, content: bytes of
    JSON, and others.
    """

    operation: int
    kind: int = 0
    references: int = 0
    values: int = 0
    time: float = 0.0
    step: float = 0.0
    number: int = 0
    capacity: int = 0
    told: int = 0
    content: int = 0


class Reply(NamedTuple):
    """A reply: status, how far a step came (s) and why it ended there, what is behind it.

    number: of the errand, by which a reply is told from what the code has written by mistake.
    """

    status: int
    event: bool = False
    ended: bool = False
    early: bool = False
    reached: float = 0.0
    number: int = 0
    told: int = 0
    content: int = 0


_ERRAND = struct.Struct("<BBIIddQQQQ")
_REPLY = struct.Struct("<i???dQQQ")
ERRAND_BYTES = _ERRAND.size
REPLY_BYTES = _REPLY.size
pack_errand = _ERRAND.pack
pack_reply = _REPLY.pack


def errand_of(record: bytes) -> Errand:
    """Return the errand of a record."""
    return Errand(*_ERRAND.unpack(record))


def reply_of(record: bytes) -> Reply:
    """Return the reply of a record."""
    return Reply(*_REPLY.unpack(record))


def as_json(told: Any) -> bytes:
    """Return plain data as JSON; floats keep all their bits."""
    return json.dumps(told).encode() if told else b""


def from_json(told: bytes) -> dict[str, Any]:
    """Return the data of a JSON object.

    Raises
    ------
    ValueError
        It is none.
    """
    if not told:
        return {}
    try:
        data = json.loads(told)
    except RecursionError as error:
        raise ValueError("nested too deeply") from error
    if not isinstance(data, dict):
        raise ValueError("no object")
    return data


def make_memory() -> int:
    """Return the descriptor of memory without a name: it goes with the last process that has it."""
    if hasattr(os, "memfd_create"):
        import fcntl

        made = os.memfd_create("rockshed", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
        fcntl.fcntl(made, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK)  # it cannot be taken away
        return made
    with tempfile.TemporaryFile() as file:
        return os.dup(file.fileno())


class Memory:
    """Values and references of one call, in memory that two processes see.

    Parameters
    ----------
    descriptor : int
        Of :func:`make_memory`.

    Attributes
    ----------
    capacity : int
        Values for which there is room.
    values : array of float, shape (capacity,)
        Their values.
    references : array of uint32, shape (capacity,)
        Their value references.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self.capacity = 0
        self.values: Values = np.empty(0)
        self.references: ValueReferences = np.empty(0, np.uint32)

    def grow(self, number: int) -> None:
        """Make room for a number of values, if there is too little."""
        if number > self.capacity:
            capacity = max(512, 2 * number)
            os.ftruncate(self._descriptor, capacity * _BYTES)
            self.see(capacity)

    def see(self, capacity: int) -> None:
        """See the memory as large as the other process has made it."""
        if capacity == self.capacity:
            return
        content = mmap.mmap(self._descriptor, capacity * _BYTES)
        self.capacity = capacity
        self.values = np.frombuffer(content, np.float64, capacity)
        self.references = np.frombuffer(content, np.uint32, capacity, 8 * capacity)
