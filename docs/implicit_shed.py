"""Measure the shed on piles for `docs/masters.md`: `python -m docs.implicit_shed`.

What was found takes the place of what is kept in `docs/results`; then `python -m docs.tables`
writes the table of the page.
"""

import json
import platform
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import rockshed
from rockshed.runs.run import Run

from .tables.masters import DATA, OUTPUTS, RUNS, STEP, STOP, Row, Rules, stamp, system


def run(step: float, rules: Rules | None, stop: float = STOP) -> tuple[Run, float]:
    """Return a run and its processor time (s)."""
    began = time.process_time()
    return rockshed.simulate(system(step, rules, stop)), time.process_time() - began


def over_exchanges(values: NDArray[np.float64], number: int) -> NDArray[np.float64]:
    """Return the means of each number of rows, without the first row."""
    return np.asarray(values[1:].reshape(-1, number).mean(axis=1))


def error(found: Run, reference: Run, name: str, is_mean: bool) -> float:
    """Return the largest difference of an output over time, as a part of its largest amount.

    A force is the mean over an exchange: it is held against the mean of the reference over the
    same time.
    """
    every = round((found.time[1] - found.time[0]) / (reference.time[1] - reference.time[0]))
    known = np.asarray(reference[name])
    known = np.append(known[0], over_exchanges(known, every)) if is_mean else known[::every]
    return float(np.abs(found[name] - known).max() / np.abs(known).max())


def rows() -> Iterator[Row]:
    """Yield windows, iterations, steps, processor time (s) and errors of each run."""
    for _, step, rules in RUNS:
        run(step, rules, 40 * step)  # kernels are compiled, or read, before time is taken
    reference, _ = run(STEP, {"window": 10 * STEP, "tolerance": 1e-6})
    for title, step, rules in RUNS:
        found, took = run(step, rules)
        told = found.provenance.get("iteration", {}).get("iterations", {"1": round(STOP / step)})
        windows = sum(told.values())
        iterations = sum(int(number) * count for number, count in told.items())
        exchanges = round(STOP / step) // windows
        again = windows if exchanges > 1 else 0  # a window is made once more for its rows
        yield {
            "title": title,
            "step": step,
            "rules": rules,
            "windows": windows,
            "iterations": iterations,
            "steps": (iterations + again) * exchanges,
            "time": took,
            "errors": {
                output.title: error(found, reference, output.name, output.is_mean)
                for output in OUTPUTS
            },
        }


def measurement() -> dict[str, Any]:
    """Return all runs, what they follow from, and where they were made."""
    return {
        "stamp": stamp(),
        "rockshed": rockshed.__version__,
        "platform": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "rows": list(rows()),
    }


if __name__ == "__main__":
    DATA.write_text(json.dumps(measurement(), indent=1) + "\n", encoding="utf-8")
