"""Measure the table of the shed on piles in `docs/masters.md`: `python -m docs.implicit_shed`."""

import time
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

import rockshed
from rockshed.runs.run import Run
from rockshed.tables import Table

STOP, STEP = 0.04, 5e-6
"""End of the runs, and the internal step of all components (s), which is the shortest exchange."""
FORCES = {
    "transmitted": "sand.transmitted_force",
    "rock": "sand.rock.force.y",
    "head": "rod_left.head.contact_force",
    "toe": "ground_left.toe.mean_force",
}
"""Outputs that are means over an exchange, but the head's: that is the mean over the last step."""
MOTIONS = {"head's way": "rod_left.head.position", "settlement": "ground_left.settlement"}
Rules = Mapping[str, Any]
RUNS: Mapping[str, tuple[float, Rules | None]] = {
    "sequential, 0.005 ms": (5e-6, None),
    "sequential, 0.01 ms": (1e-5, None),
    "implicit, 0.1 ms": (1e-4, {"window": 1e-4}),
    "implicit, 0.05 ms": (5e-5, {"window": 5e-5}),
    "implicit, 0.05 ms in windows of 0.2 ms, parabolas": (
        5e-5,
        {"window": 2e-4, "interpolation": 2},
    ),
    "implicit, 0.01 ms in windows of 0.05 ms": (1e-5, {"window": 5e-5}),
    "implicit, 0.01 ms in windows of 0.4 ms": (1e-5, {"window": 4e-4}),
}
"""Exchange step (s), and what is other in the table ``[iteration]``, if it is iterated at all."""


def run(step: float, rules: Rules | None) -> tuple[Run, float]:
    """Return a run and its processor time (s).

    The sequential run has the ports of the implicit one: the systems are the same.
    """
    parts = ("sand", "rock", "beam", "ground_left", "ground_right")
    values: dict[str, Any] = {f"{part}.internal_step": STEP for part in parts}
    system = rockshed.case("shed-on-piles", values=values, coupling="implicit", in_process=True)
    system = system.with_options(
        stop_time=STOP,
        exchange_step=step,
        output_interval=step,
        record=[*FORCES.values(), *MOTIONS.values()],
        **({"master": "sequential"} if rules is None else {"iteration": rules}),
    )
    began = time.process_time()
    return rockshed.simulate(system), time.process_time() - began


def over_exchanges(values: NDArray[np.float64], number: int) -> NDArray[np.float64]:
    """Return the means of each number of rows, without the first row."""
    return np.asarray(values[1:].reshape(-1, number).mean(axis=1))


def error(found: Run, reference: Run, name: str) -> float:
    """Return the largest difference of an output over time, as a part of its largest amount.

    A force is the mean over an exchange: it is held against the mean of the reference over the
    same time.
    """
    every = round((found.time[1] - found.time[0]) / (reference.time[1] - reference.time[0]))
    known = np.asarray(reference[name])
    if name in FORCES.values():
        known = np.append(known[0], over_exchanges(known, every))
    else:
        known = known[::every]
    return float(np.abs(found[name] - known).max() / np.abs(known).max())


def rows() -> Iterator[list[str]]:
    """Yield run, windows, iterations in all, processor time and errors (%)."""
    outputs = [*FORCES.values(), *MOTIONS.values()]
    reference, _ = run(STEP, {"window": 10 * STEP, "tolerance": 1e-6})
    shortest = 0.0
    for name, (step, rules) in RUNS.items():
        found, took = run(step, rules)
        told = found.provenance.get("iteration", {}).get("iterations", {"1": round(STOP / step)})
        windows = sum(told.values())
        every = sum(int(number) * count for number, count in told.items())
        shortest = shortest or took
        errors = (f"{100.0 * error(found, reference, output):.4f}" for output in outputs)
        yield [name, f"{windows}", f"{every}", f"{took / shortest:.1f}", *errors]


if __name__ == "__main__":
    columns = ("run", "windows", "iterations", "time", *FORCES, *MOTIONS)
    table = Table(columns, right=columns[1:])
    for row in rows():
        table.add(*row)
    print(table)
