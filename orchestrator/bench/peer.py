"""A contestant in a process of its own, which times itself: it answers each line of text with the seconds that the work took."""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from types import TracebackType

from .interleave import Contestant


class Peer:
    """Python with these arguments, in this environment beside the present one; ends with the ``with`` block."""

    def __init__(
        self, arguments: Sequence[str], environment: Mapping[str, str] | None = None
    ) -> None:
        self._process = subprocess.Popen(
            [sys.executable, *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, **(environment or {})},
        )

    def contestant(self, question: str) -> Contestant:
        """The work that the question asks for."""
        return lambda: self._ask(question)

    def _ask(self, question: str) -> float:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(question + "\n")
        self._process.stdin.flush()
        return float(self._process.stdout.readline())

    def __enter__(self) -> "Peer":
        """The peer itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(10.0)


def answers(arguments: Sequence[str]) -> bool:
    """Whether Python with these arguments and ``probe`` ends without an error: what the peer needs is installed."""
    return (
        subprocess.run(
            [sys.executable, *arguments, "probe"], capture_output=True, check=False
        ).returncode
        == 0
    )
