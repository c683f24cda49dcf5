"""The paper's standard penetration test (its table 1) on a rod by any scheme, and its traces over time."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError, Instance
from rockshed.components.common.units import cm, cm2
from rockshed.components.pile_rod.st_venant import StVenant

MASS, DROP = 63.5, 75 * cm
"""Hammer (kg) and fall (m); 4762.5 kg cm of energy."""
AREA, DENSITY, SPEED = 5.8 * cm2, 7850.0, 5120.0
GRAVITY = 9.80665
QUAKE = 2.5e-3
"""Displacement (m) at which Smith's ground yields, his 0.1 in; the paper's is not stated."""
SOURCE = "Table 1: hammer 63.5 kg (the scan's 63.5 kN), 75 cm, rod 5.8 cm², 7.85 g/cm³, 5120 m/s."


@dataclass(frozen=True)
class Traces:
    """What a run gave: times (s) at the ends of the steps, named outputs over them, and the rod as it was at the end.

    ended: whether the run came to its end; one that diverges ends where its numbers do.
    """

    time: NDArray[np.float64]
    values: Mapping[str, NDArray[np.float64]]
    rod: Instance
    ended: bool

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self.values[name]

    @property
    def front(self) -> float:
        """Force (N) with which the hammer strikes: Z V0."""
        return float(self.rod["head.impedance"] * self.rod["ram.velocity"])

    @property
    def travel_time(self) -> float:
        """L/c (s)."""
        return float(self.rod["travel_time"])

    def relative(self, name: str) -> NDArray[np.float64]:
        """A force over that with which the hammer strikes."""
        return self[name] / self.front

    def first_without(self, name: str) -> float | None:
        """Time (s) at which a force first is zero or less after the blow; None if it never is."""
        there = np.flatnonzero(self[name] <= 0.0)
        return float(self.time[there[0]]) if there.size else None


def alpha(kappa: float) -> float:
    """Reflection coefficient for the ratio of stiffnesses or impedances, eqs (8), (9)."""
    return (1.0 - kappa) / (1.0 + kappa)


def kappa(reflection: float) -> float:
    """Ratio of stiffnesses or impedances for a reflection coefficient, eqs (8), (9)."""
    return (1.0 - reflection) / (1.0 + reflection)


def strike(
    length: float,
    segments: int,
    outputs: tuple[str, ...],
    times: float,
    scheme: str = "smith",
    parts: int = 1,
    ground: int = 1,
    **parameters: Any,
) -> Traces:
    """Strike a rod of this length (m) and follow it for a number of travel times.

    parts: of the critical step that make a step. ground: segments of the ground as a rod. ``__`` in names stands for a dot.
    """
    rod = component("PileRod").instance(segments=segments, ground_segments=ground)
    rod["scheme"], rod["section.length"], rod["ram.mass"] = scheme, length, MASS
    rod["ram.velocity"] = float(np.sqrt(2.0 * GRAVITY * DROP))
    for name, value in parameters.items():
        rod[name.replace("__", ".")] = value
    rod["internal_step"] = length / SPEED / segments / parts * (1.0 + 1e-12)
    rod.initialise()
    step = rod["time_step"]
    rows = []
    for n in range(round(times * rod["travel_time"] / step)):
        try:
            rod.step(n * step, step)
        except ComponentError:
            break
        rows.append([rod[name] for name in outputs])
    values = {
        name: np.array(column)
        for name, column in zip(outputs, zip(*rows, strict=True), strict=True)
    }
    ended = len(rows) == round(times * rod["travel_time"] / step)
    return Traces(np.arange(1, len(rows) + 1) * step, values, rod, ended)


def reflecting(reflection: float) -> dict[str, Any]:
    """Parameters of a toe that reflects this part of the displacement."""
    return {"toe__condition": "reflection", "toe__reflection": reflection}


def closed_form(traces: Traces, reflection: float) -> StVenant:
    """St. Venant's solution for the same rod."""
    return StVenant(
        MASS,
        traces.rod["ram.velocity"],
        traces.rod["head.impedance"],
        traces.travel_time,
        reflection,
    )
