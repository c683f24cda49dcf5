"""Measure the table in `docs/adaptive.md`: `python -m docs.adaptive_steps`."""

from collections.abc import Iterator, Mapping
from typing import Any

import rockshed
from rockshed.tables import Table

TIMES = {"stop_time": 0.0384, "output_interval": 1.28e-3, "state_interval": 1.28e-2}
FIGURES = ("peak_transmitted_force", "penetration")
FINEST, FIXED = 5e-7, (1.6e-4, 8e-5, 4e-5, 2e-5, 1e-5, 5e-6)
"""Exchange steps (s) of the reference, and of the runs with fixed steps."""
LINEAR = {"sand.kinematics": "linear"}
INPUTS: Mapping[str, tuple[str, int, Mapping[str, Any]]] = {
    "hold (paper)": ("paper", 0, {}),
    "hold (jacobi)": ("jacobi", 0, {}),
    "lines (jacobi)": ("jacobi", 1, {}),
    "lines, and sand.kinematics": ("jacobi", 1, LINEAR),
    "parabolas, and sand.kinematics": ("jacobi", 2, LINEAR),
    "coupling impulse": ("impulse", 0, {}),
}
"""Coupling, order of extrapolation and values of the sand, by what inputs do."""
TOLERANCES = {"ledger": (3e-2, 1e-2, 3e-3, 1e-3, 1e-4), "doubling": (1e-1, 3e-2)}


def run(inputs: str, step: float, adaptive: Mapping[str, Any] | None = None) -> Any:
    """Return the metrics of a run."""
    coupling, order, values = INPUTS[inputs]
    options = {**TIMES, "exchange_step": step, "extrapolation": order, "adaptive": adaptive}
    system = rockshed.case("lab-impact", coupling=coupling, values=values, **options)
    return rockshed.simulate(system).metrics


def rows() -> Iterator[tuple[str, str, str, str]]:
    """Yield inputs, kind of step, exchanges and error of each run."""
    finest = run("hold (paper)", FINEST)

    def told(inputs: str, kind: str, found: Any) -> tuple[str, str, str, str]:
        error = max(abs(found[name].value / finest[name].value - 1.0) for name in FIGURES)
        return inputs, kind, f"{found['exchanges'].value:,.0f}", f"{100.0 * error:.3f} %"

    for inputs in INPUTS:
        for step in FIXED:
            yield told(inputs, f"fixed, {1e6 * step:g} us", run(inputs, step))
        for control, tolerances in TOLERANCES.items():
            longest = 2.56e-4 if INPUTS[inputs][2] else 1.28e-4
            for tolerance in tolerances:
                adaptive = {"tolerance": tolerance, "largest_step": longest, "control": control}
                found = run(inputs, 1e-6, adaptive)
                yield told(inputs, f"{control}, {tolerance:g}", found)


if __name__ == "__main__":
    table = Table(("inputs", "step", "exchanges", "error"), right=("exchanges", "error"))
    for row in rows():
        table.add(*row)
    print(table)
