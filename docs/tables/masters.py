"""The kept measurement of masters on a shed on piles, made by ``python -m docs.implicit_shed``.

That command keeps what it has found; then ``python -m docs.tables`` writes the table of the page.
"""

import json
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

import rockshed
from rockshed.papers.kernel_stamps import of_series

from .forms import number, table
from .kept import FOLDER

DATA = FOLDER / "implicit_shed.json"
STOP, STEP = 0.04, 5e-6
"""End of the runs, and the internal step of all components (s), which is the shortest exchange."""
_SHORT, _COARSE = 0.018, 1e-5
"""End of the run that the stamp is of (s), when all outputs have begun, and its exchange step."""
_REMEDY = "run `python -m docs.implicit_shed`, then `python -m docs.tables`"
_UNIT = "`sequential`", _COARSE
"""Master and exchange step (s) of the run whose processor time is 1."""


class Output(NamedTuple):
    """An output that is compared: its heading, its name, and if it is a mean over an exchange."""

    title: str
    name: str
    is_mean: bool


OUTPUTS = (
    Output("transmitted force", "sand.transmitted_force", True),
    Output("force on the rock", "sand.rock.force.y", True),
    Output("at a rod's head", "rod_left.head.contact_force", True),
    Output("at its toe", "ground_left.toe.mean_force", True),
    Output("way of the head", "rod_left.head.position", False),
    Output("settlement", "ground_left.settlement", False),
)
"""The head's force is the mean over the last step, the other forces are those over an exchange."""
Rules = Mapping[str, Any]
Row = dict[str, Any]
RUNS: tuple[tuple[str, float, Rules | None], ...] = (
    ("`sequential`", 5e-6, None),
    ("`sequential`", 1e-5, None),
    ("`implicit`", 1e-4, {"window": 1e-4}),
    ("`implicit`", 5e-5, {"window": 5e-5}),
    ("`implicit`, parabolas", 5e-5, {"window": 2e-4, "interpolation": 2}),
    ("`implicit`", 1e-5, {"window": 5e-5}),
    ("`implicit`", 1e-5, {"window": 4e-4}),
)
"""Master, exchange step (s), and what is other in the table ``[iteration]``, if it iterates."""


def system(step: float, rules: Rules | None, stop: float = STOP) -> rockshed.System:
    """Return the system of a run.

    The sequential run has the ports of the implicit one: the systems are the same.
    """
    parts = ("sand", "rock", "beam", "ground_left", "ground_right")
    values: dict[str, Any] = {f"{part}.internal_step": STEP for part in parts}
    made = rockshed.case("shed-on-piles", values=values, coupling="implicit", in_process=True)
    return made.with_options(
        stop_time=stop,
        exchange_step=step,
        output_interval=step,
        record=[output.name for output in OUTPUTS],
        **({"master": "sequential"} if rules is None else {"iteration": rules}),
    )


@cache
def stamp() -> str:
    """Return the digest of the beginning of a sequential run, by the present kernels."""
    found = rockshed.simulate(system(_COARSE, None, _SHORT))
    return of_series({output.name: np.array(found[output.name]) for output in OUTPUTS})


@cache
def kept() -> Mapping[str, Any]:
    """Return the kept measurement."""
    found: Mapping[str, Any] = json.loads(DATA.read_text(encoding="utf-8"))
    return found


def outdated(measured: Mapping[str, Any]) -> list[str]:
    """Return why a measurement is not that of the present program, a line for each reason."""
    found = []
    if [(row["title"], row["step"], row["rules"]) for row in measured["rows"]] != list(RUNS):
        found.append(f"has other runs than are measured; {_REMEDY}")
    if measured["stamp"] != stamp():
        found.append(f"other than when measured, by kernels; {_REMEDY}")
    return found


def shed_on_piles() -> str:
    """Return windows, iterations, steps, ratio of processor time and errors of each run."""
    rows = kept()["rows"]
    (unit,) = (row["time"] for row in rows if (row["title"], row["step"]) == _UNIT)
    headings = ["master", "exchange step, ms", "window, ms", "windows", "iterations in all"]
    headings += ["steps of each component", "processor time", *(o.title for o in OUTPUTS)]
    lines = [
        [
            row["title"],
            f"{1e3 * row['step']:g}",
            f"{1e3 * row['rules']['window']:g}" if row["rules"] else "",
            str(row["windows"]),
            str(row["iterations"]) if row["rules"] else "",
            str(row["steps"]),
            number(row["time"] / unit, 0 if row["rules"] else 1),
            *(f"{100.0 * row['errors'][output.title]:.4f}" for output in OUTPUTS),
        ]
        for row in rows
    ]
    note = f"Measured with rockshed {kept()['rockshed']} on {kept()['platform']}."
    return f"{table(headings, lines)}\n\n{note}"


TABLES: Mapping[str, Callable[[], str]] = {"shed-on-piles": shed_on_piles}
