"""Price of the distinct elements: time per disc and step.

LAMMPS computes the same packing with the same kind of law.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from rockshed.components.common.component import Instance
from rockshed.components.sand_cushion import COMPONENT
from rockshed.components.sand_cushion.declarations import ROW

from .interleave import Contestant
from .peer import Peer

STEPS = {370: 2_700, 10_000: 100, 100_000: 20}
"""Steps of one measurement, by the number of discs."""

WARM_UP = 10
"""Steps before a measurement, as in lammps_peer.py."""

STEP = 1e-5
"""Time step (s), that of the paper."""

THERMAL = 0.01
"""Standard deviation of the discs' velocity components at the start (m/s).

Contacts then open, close and slide."""

WIDTHS = {370: 0.37, 10_000: 1.0, 100_000: 4.0}
"""Box widths (m) of a square packing of discs of 1 cm, by the number of discs."""

THREADED = 100_000
"""Number of discs that two threads are measured with."""


def stirred_cushion(discs: int) -> Instance:
    """Return a settled square packing on the floor between side walls with random velocities.

    Energy bookkeeping is always on.

    Parameters
    ----------
    discs : int
        One of the numbers in :data:`WIDTHS`.
    """
    sand = COMPONENT.instance(discs=discs)
    for name, value in {
        "base": "floor",
        "box.left": 0.0,
        "box.width": WIDTHS[discs],
        "rock.position.x": 0.5 * WIDTHS[discs],
        "rock.position.y": 50.0,
    }.items():
        sand[name] = value
    sand.initialise()
    body = sand.state("body").reshape(-1, ROW)
    body[:discs, 2:4] = np.random.default_rng(1).normal(0.0, THERMAL, (discs, 2))
    return sand


def own_kernel(
    discs: int, threads: int = 1, clock: Callable[[], float] = process_time
) -> Contestant:
    """Return the sand cushion's kernel, called directly, as a contestant.

    Parameters
    ----------
    discs : int
        One of the numbers in :data:`WIDTHS`.
    threads : int
        Of the kernel.
    clock : callable
        Time (s); that of the processor by default.
    """
    start = stirred_cushion(discs).to_bytes()
    sand = COMPONENT.instance(discs=discs)

    def work() -> float:
        sand.from_bytes(start)
        sand["threads"] = threads
        sand.step(0.0, WARM_UP * STEP)
        begin = clock()
        sand.step(WARM_UP * STEP, STEPS[discs] * STEP)
        return clock() - begin

    return work


LAMMPS = (str(Path(__file__).with_name("lammps_peer.py")),)
"""LAMMPS as a :class:`~.peer.Peer`; one MPI rank, one thread."""


def per_disc_and_step(seconds: float, discs: int) -> float:
    """Return a time (s) in nanoseconds per disc and step."""
    return seconds / (STEPS[discs] * discs) * 1e9


def contestants(peer: Peer | None) -> Mapping[str, Contestant]:
    """Return our kernel at every size, and LAMMPS where it is installed."""
    found: dict[str, Contestant] = {}
    for discs in WIDTHS:
        found[f"ours {discs}"] = own_kernel(discs)
        if peer is not None:
            found[f"lammps {discs}"] = peer.contestant(f"{discs} {WIDTHS[discs]} {STEPS[discs]}")
    for threads in (1, 2):
        found[f"{threads} threads"] = own_kernel(THREADED, threads, perf_counter)
    return found
