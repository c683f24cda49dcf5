"""The process of an isolated instance, seen from the run: it may end or hang at any moment."""

import os
import select
import signal
import subprocess
import sys
import time
import weakref
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

from ...processes import ended_in_words
from ...temporary import TemporaryFolder
from .wire import (
    CALL,
    MOST_CONTENT,
    MOST_TOLD,
    REPLY_BYTES,
    Errand,
    Memory,
    Reply,
    as_json,
    from_json,
    make_memory,
    pack_errand,
    reply_of,
)

_WORKER = [sys.executable, "-P", "-u", "-m", "rockshed.core.isolation.worker"]
_AT_ONCE = 1 << 16
"""Bytes that are read at a time, at most."""
_LOOK_EVERY = 1.0
"""Time (s) between two looks at a process that does not reply: a pipe may be held by others."""
_TO_BEGIN = 60.0
"""Time (s) that a process has to begin, with none of the FMU's code in it."""
_TO_END = 5.0
"""Time (s) that a process has to end by itself."""


class Gone(Exception):  # noqa: N818 (it says what happened)
    """The process has ended, does not return or answers nonsense; the text says which."""


class Replied(NamedTuple):
    """A reply with the data and the bytes behind it."""

    reply: Reply
    told: dict[str, Any]
    content: bytes


class Process:
    """A process that carries out errands.

    Parameters
    ----------
    limit : float
        Longest time (s) of an errand; then the process is ended.
    printed : callable
        Called with what the process prints, as it comes.

    Attributes
    ----------
    memory : Memory
        Shared with it.
    """

    def __init__(self, limit: float, printed: Callable[[bytes], None]) -> None:
        self._limit = limit
        self._printed = printed
        self._number = 0
        self._folder = TemporaryFolder()
        descriptor = make_memory()
        self.memory = Memory(descriptor)
        self.memory.grow(1)
        self._process = subprocess.Popen(
            [*_WORKER, str(descriptor)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            bufsize=0,
            pass_fds=(descriptor,),
            env={**os.environ, "TMPDIR": self._folder.name},
            start_new_session=True,  # Ctrl-C is the run's
        )
        pipes = (self._process.stdin, self._process.stdout, self._process.stderr)
        self._errands, self._replies, self._output = (pipe.fileno() for pipe in pipes if pipe)
        for pipe in (self._errands, self._replies, self._output):
            os.set_blocking(pipe, False)
        self._to_read, self._to_write = select.poll(), select.poll()
        self._to_read.register(self._replies, select.POLLIN)
        self._to_write.register(self._errands, select.POLLOUT)
        for poll in (self._to_read, self._to_write):
            poll.register(self._output, select.POLLIN)
        self._finish = weakref.finalize(self, _finish, self._process, self._folder, descriptor)

    def begin(self) -> None:
        """Wait until the process has begun, which is no call of the FMU and has its own limit.

        Raises
        ------
        Gone
            It has not.
        """
        limit, self._limit = self._limit, _TO_BEGIN
        self.ask(Errand(CALL), as_json({"call": "begin"}))
        self._limit = limit

    def ask(self, errand: Errand, told: bytes = b"", content: bytes = b"") -> Replied:
        """Send an errand and wait for its reply.

        Raises
        ------
        Gone
            There is none. The process has ended; nothing may be asked any more.
        """
        deadline = time.monotonic() + self._limit
        self._number += 1
        sizes = (self.memory.capacity, len(told), len(content))
        record = pack_errand(*errand[:-4], self._number, *sizes)
        try:
            self._send(record + told + content, deadline)
            reply = reply_of(self._receive(REPLY_BYTES, deadline))
            is_ours = reply.number == self._number
            if not is_ours or reply.told > MOST_TOLD or reply.content > MOST_CONTENT:
                raise Gone("answers nonsense")
            facts = from_json(self._receive(reply.told, deadline)) if reply.told else {}
            return Replied(reply, facts, self._receive(reply.content, deadline))
        except ValueError as error:
            self.end()
            raise Gone("answers nonsense") from error
        except BaseException:  # also Ctrl-C: what would be replied next is not known any more
            self.end()
            raise

    def leave(self) -> None:
        """Let the process end by itself, and see that it does."""
        if self._finish.alive and self._process.stdin is not None:
            self._process.stdin.close()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(_TO_END)
        self.end()

    def end(self) -> None:
        """End the process at once, with all that it has started."""
        self._finish()

    # ------------------------------------------------------------------ pipes

    def _send(self, content: bytes, deadline: float) -> None:
        left = memoryview(content)
        with suppress(BrokenPipeError):  # that it has ended is seen when it does not reply
            while left:
                try:
                    left = left[os.write(self._errands, left) :]
                except BlockingIOError:
                    self._wait(self._to_write, deadline)

    def _receive(self, size: int, deadline: float) -> bytes:
        """Return so many bytes of a reply."""
        content = bytearray()
        while len(content) < size:
            self._wait(self._to_read, deadline)
            with suppress(BlockingIOError):  # it has printed only
                part = os.read(self._replies, min(size - len(content), _AT_ONCE))
                if not part:
                    raise Gone(self._end_in_words())
                content += part
        return bytes(content)

    def _wait(self, poll: "select.poll", deadline: float) -> None:
        """Wait until a pipe is ready, and listen to what is printed."""
        ready = poll.poll(1e3 * self._slice(deadline))
        if any(pipe == self._output for pipe, _ in ready):
            self._hear()
        if not ready and self._process.poll() is not None:
            raise Gone(self._end_in_words())

    def _slice(self, deadline: float) -> float:
        """Return the time (s) until the next look at the process."""
        left = deadline - time.monotonic()
        if left <= 0.0:
            raise Gone(f"has not returned after {self._limit:g} s")
        return min(left, _LOOK_EVERY)

    def _hear(self) -> None:
        """Read what was printed; at its end, listen no more."""
        with suppress(BlockingIOError):
            part = os.read(self._output, _AT_ONCE)
            if part:
                self._printed(part)
            else:
                for poll in (self._to_read, self._to_write):
                    poll.unregister(self._output)

    def _end_in_words(self) -> str:
        """Say how the process has ended; what it printed before is heard first."""
        try:
            code = self._process.wait(_TO_END)
        except subprocess.TimeoutExpired:
            return "has closed the pipes to the run"
        with suppress(BlockingIOError, OSError):
            while part := os.read(self._output, _AT_ONCE):
                self._printed(part)
        return ended_in_words(code)


def _finish(process: "subprocess.Popen[bytes]", folder: TemporaryFolder, descriptor: int) -> None:
    """End a process with all that it has started, and remove what it has unpacked."""
    with suppress(ProcessLookupError, PermissionError):  # PermissionError: only zombies (macOS)
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    for pipe in (process.stdin, process.stdout, process.stderr):
        if pipe is not None:
            pipe.close()
    os.close(descriptor)
    folder.cleanup()
