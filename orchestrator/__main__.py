"""The program ``rockshed``, also as ``python -m rockshed``: who ends it early gets no traceback.

Python puts the working folder first where modules are looked for. What lies there is a user's, or
somebody else's, and is not imported.
"""

import os
import signal
import sys
from types import FrameType

_INTERRUPTED = 130


def main() -> None:
    """Run the command line. Until a command has begun, a request to end does so at once."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGXCPU"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _end)
    from .commands.app import main as run  # takes a while

    run()


def _end(_number: int, _frame: FrameType | None) -> None:
    """End the process: nothing is there yet, or any more, that would have to be tidied up."""
    os.write(2, b"failed: interrupted\n")
    sys.stdout.flush()
    os._exit(_INTERRUPTED)


if __name__ == "__main__":
    if not sys.flags.safe_path:
        del sys.path[0]
    main()
