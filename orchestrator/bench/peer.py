"""A contestant in a process of its own, which times itself.

It answers each line of text with the seconds that the work took.
"""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from types import TracebackType

from .interleave import Contestant


class Peer:
    """A Python process. A context manager, which ends the process.

    Parameters
    ----------
    arguments : sequence of str
        Of Python.
    environment : mapping of str to str, optional
        Added to the present one.
    """

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
        """Return the work that a question asks for, as a contestant."""
        return lambda: self._ask(question)

    def _ask(self, question: str) -> float:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(question + "\n")
        self._process.stdin.flush()
        return float(self._process.stdout.readline())

    def __enter__(self) -> "Peer":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(10.0)


def answers(arguments: Sequence[str]) -> bool:
    """Tell whether a peer has everything that it needs.

    Parameters
    ----------
    arguments : sequence of str
        Python with these and ``probe`` has to end without an error.
    """
    command = [sys.executable, *arguments, "probe"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0
