"""The program ``rockshed``, also as ``python -m rockshed``: who ends it early gets no traceback.

Python puts the working folder first where modules are looked for. What lies there is a user's, or
somebody else's, and is not imported.
"""

import os
import signal
import sys
from collections.abc import Callable
from types import FrameType
from typing import NoReturn

_INTERRUPTED = 130


def main() -> None:
    """Run the command line. Until a command has begun, a request to end does so at once."""
    _end_at_once(os._exit)
    from .commands.app import main as run  # takes a while
    from .core.supervisor import leave

    _end_at_once(leave)
    run()


def _end_at_once(leave: Callable[[int], NoReturn]) -> None:
    """End at every request: nothing is there yet, or any more, that has to be tidied up."""

    def end(_number: int, _frame: FrameType | None) -> None:
        os.write(2, b"failed: interrupted\n")
        sys.stdout.flush()
        leave(_INTERRUPTED)

    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, end)


if __name__ == "__main__":
    if not sys.flags.safe_path:
        del sys.path[0]
    main()
