"""The paper's standard penetration test (its table 1) on a rod, by any scheme."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError, Instance
from rockshed.components.common.units import cm, cm2, standard_gravity
from rockshed.components.pile_rod.st_venant import StVenant

MASS = 63.5
"""Mass of the hammer (kg)."""
DROP = 75 * cm
"""Height of its fall (m)."""
AREA = 5.8 * cm2
"""Cross-section of the rod (m2)."""
DENSITY = 7850.0
"""Density of the rod (kg/m3)."""
SPEED = 5120.0
"""Speed of waves in the rod (m/s)."""
QUAKE = 2.5e-3
"""Displacement (m) at which Smith's ground yields, his 0.1 in; the paper's is not stated."""
SOURCE = "Table 1: hammer 63.5 kg (the scan's 63.5 kN), 75 cm, rod 5.8 cm², 7.85 g/cm³, 5120 m/s."


@dataclass(frozen=True)
class Traces:
    """Outputs of a struck rod over time.

    Attributes
    ----------
    time : array, shape (steps,)
        Ends of the steps (s).
    values : mapping of str to array, shape (steps,)
        Outputs by name (SI).
    rod : Instance
        The rod at the end.
    ended : bool
        Whether the run came to its end; one that diverges ends where its numbers do.
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
        """Travel time L/c of a wave along the rod (s)."""
        return float(self.rod["travel_time"])

    def relative(self, name: str) -> NDArray[np.float64]:
        """Return a force over that with which the hammer strikes, shape (steps,)."""
        return self[name] / self.front

    def first_without(self, name: str) -> float | None:
        """Return the time (s) at which a force first is not positive; None if it always is."""
        there = np.flatnonzero(self[name] <= 0.0)
        return float(self.time[there[0]]) if there.size else None


def alpha(kappa: float) -> float:
    """Return the reflection coefficient for a ratio of stiffnesses or impedances, eqs (8), (9)."""
    return (1.0 - kappa) / (1.0 + kappa)


def kappa(reflection: float) -> float:
    """Return the ratio of stiffnesses or impedances for a reflection coefficient, eqs (8), (9)."""
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
    """Strike a rod and follow the waves in it.

    Parameters
    ----------
    length : float
        Length of the rod (m).
    segments : int
        Number of its segments.
    outputs : tuple of str
        Outputs that are kept.
    times : float
        Number of travel times that are followed.
    scheme : str
        Scheme of the component.
    parts : int
        Steps in a critical step.
    ground : int
        Segments of the ground as a rod.
    **parameters
        Further parameters; ``__`` in a name stands for a dot.

    Returns
    -------
    Traces
        Outputs at the end of every step.
    """
    rod = component("PileRod").instance(segments=segments, ground_segments=ground)
    rod["scheme"] = scheme
    rod["section.length"] = length
    rod["ram.mass"] = MASS
    rod["ram.velocity"] = float(np.sqrt(2.0 * standard_gravity * DROP))
    for name, value in parameters.items():
        rod[name.replace("__", ".")] = value
    rod["internal_step"] = length / SPEED / segments / parts * (1.0 + 1e-12)
    rod.initialise()
    step = rod["time_step"]
    steps = round(times * rod["travel_time"] / step)
    rows = []
    for n in range(steps):
        try:
            rod.step(n * step, step)
        except ComponentError:
            break
        rows.append([rod[name] for name in outputs])
    values = {
        name: np.array(column)
        for name, column in zip(outputs, zip(*rows, strict=True), strict=True)
    }
    time = np.arange(1, len(rows) + 1) * step
    return Traces(time, values, rod, ended=len(rows) == steps)


def reflecting(reflection: float) -> dict[str, Any]:
    """Return the parameters of a toe that reflects this part of the displacement."""
    return {"toe__condition": "reflection", "toe__reflection": reflection}


def closed_form(traces: Traces, reflection: float) -> StVenant:
    """Return St. Venant's solution for the same rod."""
    return StVenant(
        MASS,
        traces.rod["ram.velocity"],
        traces.rod["head.impedance"],
        traces.travel_time,
        reflection,
    )
