"""A WebAssembly module with its memory, for tests: run by wasmtime, as far from us as a browser."""

import struct

import numpy as np
import pytest


class Hosted:
    """A module and its memory; buffers lie in it one after the other.

    Parameters
    ----------
    content : bytes
        The module.
    """

    def __init__(self, content):
        wasmtime = pytest.importorskip("wasmtime")
        self._store = wasmtime.Store()
        module = wasmtime.Module(self._store.engine, content)
        assert module.imports == [], "it needs something of its host"
        self._exports = wasmtime.Instance(self._store, module, []).exports(self._store)
        self.memory = self._exports["memory"]
        self.names = {export.name for export in module.exports}
        self._end = self._exports["__heap_base"].value(self._store)

    def room(self, size):
        """Return the address of further bytes of memory."""
        at = -(-self._end // 64) * 64
        self._end = at + size
        lacking = self._end - self.memory.data_len(self._store)
        if lacking > 0:
            self.memory.grow(self._store, -(-lacking // 65536))
        return at

    def placed(self, array):
        """Copy an array into the memory and return its address."""
        at = self.room(array.nbytes)
        self.write(at, array)
        return at

    def write(self, at, array):
        self.memory.write(self._store, array.tobytes(), at)

    def read(self, at, array):
        """Return an array of the kind and length of another from the memory."""
        content = self.memory.read(self._store, at, at + array.nbytes)
        return np.frombuffer(bytes(content), array.dtype)

    def call(self, name, *arguments):
        return self._exports[name](self._store, *arguments)


class HostedInstance:
    """The buffers of an instance in the memory of a module."""

    def __init__(self, content, instance):
        self.host, self._instance = Hosted(content), instance
        self._buffers = (instance.w, instance.x, instance.k)
        self.places = [self.host.placed(buffer) for buffer in self._buffers]
        self.lengths = [buffer.size for buffer in self._buffers]

    def give(self):
        """Take over all variables of the instance."""
        self.host.write(self.places[0], self._instance.w)

    def call(self, name, *times):
        return self.host.call(name, *times, *self.places, *self.lengths)

    def buffers(self):
        """Return w, x and k as they are in the memory."""
        return [self.host.read(*pair) for pair in zip(self.places, self._buffers)]


def bits(number):
    """Return the bits of a number; all NaN are one."""
    return "nan" if number != number else struct.pack("<d", number)
