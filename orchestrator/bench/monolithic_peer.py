"""The one program of the coupling benchmark in a process of its own.

Numba compiles for one processor per process. ``python -m rockshed.bench.monolithic_peer`` answers
each line with the processor time (s) of a run.
"""

import sys

from .coupling import one_program


def main() -> None:
    """Answer lines until the input ends."""
    work = one_program()
    for _ in sys.stdin:
        print(work(), flush=True)


if __name__ == "__main__":
    main()
