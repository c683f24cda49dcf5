"""The benchmark as one table of figures."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import perf_counter

from . import coupling, discs
from .interleave import interleave


@dataclass(frozen=True)
class Row:
    """A figure: what was measured, its value and unit, what it is a ratio to, and the goal where there is one."""

    name: str
    value: float
    unit: str
    compared_with: str = ""
    goal: float | None = None


def disc_rows(rounds: int, progress: Callable[[], None]) -> Iterator[Row]:
    """Time per disc and step on one core, and the ratio to LAMMPS where it is installed."""
    peer = discs.LammpsPeer() if discs.lammps_available() else None
    try:
        times = interleave(discs.contestants(peer), rounds, progress)
    finally:
        if peer is not None:
            peer.close()
    for number in discs.WIDTHS:
        ours = discs.per_disc_and_step(times.median(f"ours {number}"), number)
        yield Row(f"sand kernel, {number} discs", ours, "ns per disc and step", goal=30.0)
        if peer is not None:
            theirs = discs.per_disc_and_step(times.median(f"lammps {number}"), number)
            yield Row(f"LAMMPS, {number} discs", theirs, "ns per disc and step")
            yield Row(f"sand kernel, {number} discs", times.ratio(f"ours {number}", f"lammps {number}"), "ratio", "LAMMPS", 1 / 3)


def coupling_rows(rounds: int, progress: Callable[[], None]) -> Iterator[Row]:
    """Wall time of the co-simulated laboratory impact against the one program."""
    times = interleave(coupling.contestants(), rounds, progress)
    yield Row("one program, 20 ms of the laboratory impact", times.median("one program") * 1e3, "ms")
    for name, title, goal in (("paper", "co-simulation, exchange 1e-5 s", 4.5),
                              ("impulse", "co-simulation, exchange 1e-4 s, impulse-conserving", 1.5),
                              ("paper, plain calls", "co-simulation, exchange 1e-5 s, plain calls", None)):
        yield Row(title, times.ratio(name, "one program"), "ratio", "one program", goal)


def start_row(rounds: int) -> Row:
    """From the command line to the end of the first exchange, caches warm: the command as a whole, minus nothing."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "orchestrator.cli", "run", "lab-impact", "--stop-time", "1e-4", "--no-figures", "--quiet",
                   "--output-dir", os.path.join(folder, "run")]
        seconds = []
        for _ in range(rounds + 1):
            begin = perf_counter()
            subprocess.run(command, check=True, capture_output=True)
            seconds.append(perf_counter() - begin)
    return Row("rockshed run lab-impact, one exchange of results, warm caches", sorted(seconds[1:])[rounds // 2], "s", goal=2.0)


def measure(rounds: int, progress: Callable[[], None] = lambda: None) -> list[Row]:
    """All figures; contestants that are compared take turns in every round."""
    return [*disc_rows(rounds, progress), *coupling_rows(rounds, progress), start_row(rounds)]
