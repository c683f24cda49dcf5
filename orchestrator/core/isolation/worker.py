"""The process of an isolated instance: ``python -m rockshed.core.isolation.worker MEMORY``.

It reads errands from its stdin and replies to its stdout. Both are put aside before the code of an
FMU runs: that reads nothing, and what it prints goes to stderr, where the run listens.
"""

import ctypes
import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...processes import end_with_parent
from ..errors import InputRefused
from ..fmu.fmu_slave import FmuFile
from ..fmu.slave import FATAL, OK, Messages
from .wire import (
    ERRAND_BYTES,
    GET,
    KINDS,
    SET,
    STEP,
    Errand,
    Memory,
    Reply,
    as_json,
    errand_of,
    from_json,
    pack_reply,
)

_NOT_BUFFERED = 2
"""Mode of setvbuf(3) in which what is printed is written at once."""


class _Unsent(Messages):
    """Messages of an instance, and those that have not been passed on."""

    def __init__(self, earlier: list[tuple[int, str]]) -> None:
        super().__init__()
        self.unsent: list[tuple[int, str]] = []
        for message in earlier:
            self.append(message)

    def append(self, message: tuple[int, str]) -> None:
        """Take a message, and pass it on with the next reply."""
        super().append(message)
        self.unsent.append(message)

    def taken(self) -> list[tuple[int, str]]:
        """Return the messages that have not been passed on; they are now."""
        taken = self.unsent
        self.unsent = []
        return taken


class _Done(NamedTuple):
    """A reply with the facts and the bytes that go with it."""

    reply: Reply
    facts: Mapping[str, Any] = {}
    content: bytes = b""


class _Worker:
    """Carries out errands.

    Parameters
    ----------
    errands, replies : int
        Descriptors of the pipes.
    memory : Memory
        Shared with the run.
    """

    def __init__(self, errands: int, replies: int, memory: Memory) -> None:
        self._errands = errands
        self._replies = replies
        self._memory = memory
        self._slave: Any = None
        self._messages = _Unsent([])

    def serve(self) -> None:
        """Reply until the run wants nothing more, or is no more."""
        while len(record := self._read(ERRAND_BYTES)) == ERRAND_BYTES:
            errand = errand_of(record)
            self._memory.see(errand.capacity)
            told = from_json(self._read(errand.told))
            content = self._read(errand.content)
            self._answer(errand, told, content)

    def _read(self, size: int) -> bytes:
        """Read so many bytes; fewer where the run has ended."""
        content = b""
        while len(content) < size:
            part = os.read(self._errands, size - len(content))
            if not part:
                break
            content += part
        return content

    def _answer(self, errand: Errand, told: dict[str, Any], content: bytes) -> None:
        """Carry out one errand; an exception goes back as a text."""
        try:
            done = self._done(errand, told, content)
        except InputRefused as refusal:
            problems = [[p.where, p.what, p.remedy] for p in refusal.problems]
            done = _Done(Reply(FATAL), {"refused": problems})
        except RuntimeError as error:
            done = _Done(Reply(FATAL), {"error": str(error)})
        except Exception as error:
            done = _Done(Reply(FATAL), {"error": f"{type(error).__name__}: {error}"})
        messages = self._messages.taken()
        facts = {**done.facts, "messages": messages} if messages else done.facts
        self._write(done.reply, errand.number, as_json(facts), done.content)

    def _done(self, errand: Errand, told: dict[str, Any], content: bytes) -> _Done:
        if errand.operation in (SET, GET):
            return _Done(Reply(self._move(errand)))
        if errand.operation == STEP:
            return _Done(self._step(errand))
        return self._call(str(told["call"]), told.get("arguments", []), content)

    def _write(self, reply: Reply, number: int, told: bytes, content: bytes) -> None:
        record = pack_reply(*reply[:-3], number, len(told), len(content))
        left = memoryview(record + told + content)
        while left:
            left = left[os.write(self._replies, left) :]

    # ------------------------------------------------------------------ errands

    def _move(self, errand: Errand) -> int:
        references = self._memory.references[: errand.references]
        values = self._memory.values[: errand.values]
        move = self._slave.set if errand.operation == SET else self._slave.get
        return int(move(references, values, KINDS[errand.kind]))

    def _step(self, errand: Errand) -> Reply:
        self._slave.forgets = bool(errand.kind)
        if hasattr(self._slave, "partial_step"):
            return Reply(*self._slave.partial_step(errand.time, errand.step))
        return Reply(self._slave.step(errand.time, errand.step))

    def _call(self, name: str, arguments: list[Any], content: bytes) -> _Done:
        if name == "begin":
            return _Done(Reply(OK))
        if name == "instantiate":
            self._instantiate(*arguments)
            return _Done(Reply(OK))
        if name == "state":
            return _Done(Reply(OK), content=self._slave.state())
        if name == "restore":
            arguments = [content]
        if name == "configure":
            arguments = [[_setting(*size) for size in arguments]]
        return _Done(Reply(OK), {"value": getattr(self._slave, name)(*arguments)})

    def _instantiate(self, path: str, name: str) -> None:
        self._slave = FmuFile(Path(path)).instantiate(name)
        self._messages = self._slave.messages = _Unsent(self._slave.messages)


def _setting(references: list[int], values: list[float], kind: str) -> tuple[Any, Any, str]:
    return np.array(references, np.uint32), np.array(values, np.float64), kind


def _own_pipes() -> tuple[int, int]:
    """Return descriptors of errands and replies; stdin is empty then, and stdout is stderr."""
    errands, replies = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    return errands, replies


def _print_at_once() -> None:
    """Have code in C print without a buffer: a crash would take it along."""
    library = ctypes.CDLL(None)
    with suppress(ValueError, AttributeError):
        name = "__stdoutp" if sys.platform == "darwin" else "stdout"
        stdout = ctypes.c_void_p.in_dll(library, name)
        library.setvbuf(stdout, None, _NOT_BUFFERED, ctypes.c_size_t(0))


def _without_core_files() -> None:
    """Leave no image of the memory behind after a crash."""
    import resource  # Windows has none, and no isolation either

    hard = resource.getrlimit(resource.RLIMIT_CORE)[1]
    resource.setrlimit(resource.RLIMIT_CORE, (0, hard))


def main() -> None:
    """Serve one run, then end at once: nothing of the FMU is called any more."""
    end_with_parent()
    errands, replies = _own_pipes()
    _print_at_once()
    _without_core_files()
    memory = int(sys.argv[1])
    os.set_inheritable(memory, False)
    with suppress(BrokenPipeError):  # the run is no more
        _Worker(errands, replies, Memory(memory)).serve()
    os._exit(0)


if __name__ == "__main__":
    main()
