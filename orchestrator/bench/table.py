"""The benchmark as one table."""

import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from rockshed.fmus.build import BuildError, Runtime
from rockshed.fmus.native.fmu import CPU

from ..temporary import TemporaryFolder
from . import coupling, discs, rockfall
from . import exchange_price as price
from .exchange import BARE, OURS, PEERS, Pair
from .interleave import interleave
from .peer import Peer, answers
from .residuals import LADDERS, measured, of_logarithms


@dataclass(frozen=True)
class BenchmarkRow:
    """One measured value.

    Attributes
    ----------
    name : str
        In words.
    value : float or None
        None where it could not be measured; ``unit`` then says why.
    unit : str
        Of the value.
    compared_with : str
        Reference of a ratio.
    goal : float, optional
        Largest value that is good.
    """

    name: str
    value: float | None
    unit: str
    compared_with: str = ""
    goal: float | None = None

    @property
    def is_missed(self) -> bool:
        """Tell whether there is a goal and it is not reached."""
        return self.goal is not None and self.value is not None and self.value > self.goal


_DISC_GOALS = {370: 0.13, 10_000: 0.13, 100_000: 0.09}
"""Largest ratio to the time of LAMMPS, by the number of discs."""


def disc_rows(rounds: int) -> Iterator[BenchmarkRow]:
    """Measure the time per disc and step on one core, LAMMPS, and two threads."""
    with Peer(discs.LAMMPS) if answers(discs.LAMMPS) else nullcontext() as peer:
        times = interleave(discs.contestants(peer), rounds)
    for number in discs.WIDTHS:
        ours = discs.per_disc_and_step(times.median(f"ours {number}"), number)
        yield BenchmarkRow(f"sand kernel, {number} discs", ours, "ns per disc and step", goal=30.0)
        if peer is not None:
            theirs = discs.per_disc_and_step(times.median(f"lammps {number}"), number)
            yield BenchmarkRow(f"LAMMPS, {number} discs", theirs, "ns per disc and step")
            yield BenchmarkRow(
                f"sand kernel, {number} discs",
                times.ratio(f"ours {number}", f"lammps {number}"),
                "ratio",
                "LAMMPS",
                _DISC_GOALS[number],
            )
    yield BenchmarkRow(
        f"sand kernel, {discs.THREADED} discs, 2 threads, by the clock on the wall",
        times.ratio("2 threads", "1 threads"),
        "ratio",
        "one thread",
    )


def coupling_rows(rounds: int) -> Iterator[BenchmarkRow]:
    """Measure the processor time of the co-simulated laboratory impact, and of the one program."""
    with Peer(coupling.BASELINE, coupling.AS_NATIVE) as baseline:
        contestants = coupling.contestants(baseline)
        times = interleave(contestants, rounds)
    yield BenchmarkRow(
        "one program, 20 ms of the laboratory impact", times.median("one program") * 1e3, "ms"
    )
    for name, title, goal in (
        ("paper", "co-simulation, exchange 1e-5 s", 4.0),
        ("impulse", "co-simulation, exchange 1e-4 s, impulse-conserving", 1.3),
        ("paper, native", "native co-simulation, exchange 1e-5 s", 1.05),
        ("impulse, native", "native co-simulation, exchange 1e-4 s, impulse-conserving", None),
    ):
        if name in contestants:
            native = name.endswith("native")
            yield BenchmarkRow(
                title,
                times.ratio(name, "one program"),
                "ratio",
                "one program",
                None if native else goal,
            )
            if native:
                yield BenchmarkRow(
                    title,
                    times.ratio(name, "one program, baseline"),
                    "ratio",
                    f"one program for {CPU.name}, as FMUs are",
                    goal,
                )


def exchange_rows(rounds: int) -> Iterator[BenchmarkRow]:
    """Measure a macro step of two FMUs, 50 inputs and 150 outputs each, in all tools."""
    for runtime in (Runtime.NATIVE, Runtime.PYTHON):
        what = f"macro step, two {runtime} FMUs, 50 inputs and 150 outputs each"
        try:
            pair = Pair(runtime, rounds + 2)
        except BuildError as error:
            yield BenchmarkRow(what, None, str(error))
            continue
        with pair:
            times = interleave(pair.contestants, rounds)
        for tool in (OURS, *PEERS):
            if tool in pair.missing:
                yield BenchmarkRow(f"{what}: {tool}", None, pair.missing[tool])
                continue
            yield BenchmarkRow(f"{what}: {tool}", times.median(tool) / pair.steps * 1e6, "us")
            if tool != BARE and BARE in pair.contestants:
                goal = 0.25 if (tool, runtime) == (OURS, Runtime.NATIVE) else None
                yield BenchmarkRow(
                    f"{what}: {tool}", times.ratio(tool, BARE), "ratio", "bare ctypes loop", goal
                )


_TURNS = 5
"""Turns of each pair of relays in a round: they take some milliseconds, and their least counts."""


def price_rows(rounds: int) -> Iterator[BenchmarkRow]:
    """Measure what an exchange of native FMUs costs with ledger and rows, and with FMI 3.0."""
    turns = _TURNS * rounds
    try:
        with price.accounts_of_relays(turns + 1) as contestants:
            relays = interleave(contestants, turns)
        impact = interleave(price.accounts_of_impact(), rounds)
        with price.versions_of_fmi(turns + 1) as contestants:
            versions = interleave(contestants, turns)
    except BuildError as error:
        yield BenchmarkRow("exchange of native FMUs, with ledger, rows, FMI 3.0", None, str(error))
        return
    bonds = f"exchange of two relays, {2 * price.CHANNELS} forces in bonds"
    whole = "exchange of the laboratory impact, 1e-5 s, with ledger and a row every 0.1 ms"
    arrays = f"exchange of {price.VALUES} values, {price.ARRAYS}"
    for times, name, contestant, reference, goal in (
        (relays, f"{bonds}, with ledger", price.LEDGER, price.BARE, None),
        (relays, f"{bonds}, with ledger and a row each", price.KEPT, price.BARE, 1.3),
        (impact, whole, price.KEPT, price.BARE, 1.3),
        (versions, arrays, price.ARRAYS, price.SCALARS, 1.0),
    ):
        ratio = times.ratio_of_least(contestant, reference)
        yield BenchmarkRow(name, ratio, "ratio", reference, goal)


def start_rows(rounds: int) -> Iterator[BenchmarkRow]:
    """Measure a warm start of the command, to the first exchange and to its end."""
    first: list[float] = []
    whole: list[float] = []
    with TemporaryFolder() as folder:
        for _ in range(rounds + 1):
            to_first_exchange, to_end = _timed_start(folder / "run")
            first.append(to_first_exchange)
            whole.append(to_end)
    name = "rockshed run lab-impact, warm"
    yield BenchmarkRow(
        f"{name}: to the first exchange", statistics.median(first[1:]), "s", goal=0.5
    )
    yield BenchmarkRow(
        f"{name}: the whole command without pictures", statistics.median(whole[1:]), "s", goal=1.0
    )


_START = ("run", "lab-impact", "--stop-time", "0.02", "--no-figures", "--quiet", "--output-dir")


def _timed_start(folder: Path) -> tuple[float, float]:
    """Run the command; return the times (s) to the first exchange and to its end."""
    command = [sys.executable, "-P", "-m", "rockshed.commands.app", *_START, str(folder)]
    # a warm start has bytecode
    kept = {name: text for name, text in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    began = time.time()
    subprocess.run(command, check=True, capture_output=True, env=kept)
    took = time.time() - began
    facts = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    return datetime.fromisoformat(facts["started"]).timestamp() - began, took


def rockfall_rows(rounds: int) -> Iterator[BenchmarkRow]:
    """Measure the CPU time of a trial on one core, and of one of pyrockfall."""
    with Peer(rockfall.PYROCKFALL) if answers(rockfall.PYROCKFALL) else nullcontext() as peer:
        others = {"pyrockfall": peer.contestant(str(rockfall.PEER_TRIALS))} if peer else {}
        times = interleave({"ours": rockfall.own_kernel(), **others}, rounds)
    took = times.median("ours") / rockfall.TRIALS
    yield BenchmarkRow(
        "rockfall trial, 15 cells and 3 search lines", took * 1e6, "us of one core", goal=10.0
    )
    if peer is not None:
        theirs = times.median("pyrockfall") / rockfall.PEER_TRIALS
        yield BenchmarkRow("pyrockfall, the same profile", theirs * 1e6, "us of one core")
        share = times.ratio("ours", "pyrockfall") * rockfall.PEER_TRIALS / rockfall.TRIALS
        yield BenchmarkRow(
            "rockfall trial, 15 cells and 3 search lines", share, "ratio", "pyrockfall"
        )


def cluster_rows(rounds: int) -> Iterator[BenchmarkRow]:
    """Measure the wall time of a campaign on one and on two local Dask workers.

    Two idle cores are needed.
    """
    if not rockfall.dask_available():
        return
    with rockfall.dask_campaigns() as contestants:
        times = interleave(contestants, rounds)
    one = times.median("1 workers")
    yield BenchmarkRow("rockfall, 1,000,000 trials on one Dask worker", one, "s")
    yield BenchmarkRow(
        "rockfall, 1,000,000 trials on two Dask workers",
        2.0 * times.ratio("2 workers", "1 workers"),
        "ratio",
        "half of one worker's",
        1.25,
    )


def residual_rows(_rounds: int) -> Iterator[BenchmarkRow]:
    """Correlate the energy residuals of runs with their errors."""
    pairs = measured()
    for case in LADDERS:
        value = of_logarithms([pair for pair in pairs if pair.case == case])
        name = f"energy residual and error of the peak transmitted force, {case}"
        yield BenchmarkRow(name, value, "correlation of logarithms")
    value = 1.0 - of_logarithms(pairs)
    name = f"the same, all {len(pairs)} runs"
    yield BenchmarkRow(name, value, "1 - correlation of logarithms", goal=0.1)


PARTS: Mapping[str, Callable[[int], Iterator[BenchmarkRow]]] = {
    "discs": disc_rows,
    "coupling": coupling_rows,
    "exchange": exchange_rows,
    "price": price_rows,
    "start": start_rows,
    "rockfall": rockfall_rows,
    "cluster": cluster_rows,
    "residuals": residual_rows,
}
"""Parts of the benchmark. Contestants that are compared take turns in every round."""
