"""Mends how pythonfmu's binary leaves a process in which Python was running before it."""

import ctypes
import os
import sys
from glob import escape, glob


def let_go_of_interpreter(resources: str) -> None:
    """Make the binary forget the interpreter.

    The binary has not started it and would let go of it twice when it is unloaded. The second time,
    at the end of the process, it writes to memory that is no longer its own, and some processes are
    aborted. Nothing is done for a program that is no Python: there the binary has started the
    interpreter, and ends it.

    Parameters
    ----------
    resources : str
        Folder of the resources of an instance. Instances that exist already are not affected.
    """
    if sys.platform != "linux" or not sys.orig_argv:
        return
    for path in glob(os.path.join(escape(os.path.dirname(resources)), "binaries", "*", "*.so")):
        try:
            binary = ctypes.CDLL(path, mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
        except OSError:  # the tool has loaded another file
            continue
        binary.finalizePythonInterpreter()
        ctypes.CDLL(None).dlclose(ctypes.c_void_p(binary._handle))  # ctypes would keep it loaded
