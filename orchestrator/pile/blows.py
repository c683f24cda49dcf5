"""Blows on a rod: hammer and rod step by step, coupled by waves, without FMUs.

The exchange step is the travel time of a segment, so that everything that travels is exact. The hammer makes it as one internal
step: its force is then constant in it, and the coupling loses no energy.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from components.component import Instance

from .preparation import Prepared

Floats = NDArray[np.float64]
Done = Callable[[int, int], None]
"""Told the number of blows done, and of all."""

FOOT = 0.3
"""Penetration (m) that blows are counted for."""
_TAIL = 0.1
"""Last part of a blow's time whose mean is the residual force: waves that still travel cancel in it."""
TRACES = {"head.contact_force": "N", "head.zv": "N", "toe.contact_force": "N", "gauge.force": "N", "gauge.zv": "N",
          "head.position": "m", "toe.position": "m", "toe.set": "m"}
"""Outputs of the rod that are kept over time, and their units."""


@dataclass(frozen=True)
class Blow:
    """What a blow did. SI; compression positive, tension too.

    set: penetration that stays (m). compression, tension: largest stresses (Pa) in the segments in this blow. residual: force (N)
    in the segments at its end. transferred: largest work on the head (J). unbalanced: error of the energy balance (J). moving:
    kinetic energy of the rod at the end (J).
    """

    resistance: float
    set: float
    toe_displacement: float
    head_force: float
    compression: Floats
    tension: Floats
    residual: Floats
    transferred: float
    impact_energy: float
    unbalanced: float
    moving: float
    traces: dict[str, Floats] = field(default_factory=dict)

    @property
    def count(self) -> float | None:
        """Blows per 0.3 m; None where nothing stays."""
        return FOOT / self.set if self.set > 0.0 else None


def drive(made: Prepared, done: Done = lambda i, n: None) -> list[Blow]:
    """The blows of a site, one after the other: the rod keeps what is in it, and the soil too."""
    rod, found = made.rod(), []
    for number in range(made.site.blows):
        found.append(strike(made, rod, number * made.steps, made.resistance))
        done(number + 1, made.site.blows)
    return found


def bearing_graph(made: Prepared, done: Done = lambda i, n: None) -> list[Blow]:
    """A first blow for each ultimate resistance of the bearing graph, in rising order, without traces."""
    resistances = sorted(made.site.bearing.resistances) if made.site.bearing else []
    found = []
    for number, resistance in enumerate(resistances):
        found.append(replace(strike(made, made.rod(resistance), 0, resistance), traces={}))
        done(number + 1, len(resistances))
    return found


def strike(made: Prepared, rod: Instance, begun: int, resistance: float) -> Blow:
    """One blow, from the step number ``begun`` on. The rod is left as it is at its end."""
    hammer, steps, step = made.hammer(), made.steps, made.step
    rod["stress.compression"][:], rod["stress.tension"][:] = 0.0, 0.0
    before = {name: rod[name] for name in ("toe.set", "toe.position", "energy.head", "energy.residual", "energy.work.head")}
    wave, impedance, force = rod.references["head.wave"], rod.references["head.impedance"], rod.references["head.force"]
    kept = np.array([rod.references[name] for name in TRACES])
    hammer.w[hammer.references["head.impedance"]] = rod.w[impedance]
    hammer.initialise()
    to_wave, of_force, work = hammer.references["head.wave"], hammer.references["force"], rod.references["energy.head"]
    rows, residual, most = np.empty((steps, len(TRACES))), np.zeros(made.site.segments), 0.0
    tail = min(round((1.0 - _TAIL) * steps), steps - 1)
    for number in range(steps):
        time = (begun + number) * step
        hammer.w[to_wave] = rod.w[wave]
        hammer.step(time, step)
        rod.w[force] = hammer.w[of_force]
        rod.step(time, step)
        rows[number] = rod.w[kept]
        most = max(most, rod.w[work] - before["energy.head"])
        if number >= tail:
            residual += rod["force"]
    rod.w[force] = 0.0
    traces: dict[str, Floats] = {**dict(zip(TRACES, rows.T)), "time": step * np.arange(begun + 1.0, begun + steps + 1.0)}
    unbalanced = (rod["energy.residual"] - before["energy.residual"] + hammer["energy.residual"]
                  + rod["energy.work.head"] - before["energy.work.head"] + hammer["energy.work.head"])
    return Blow(resistance, rod["toe.set"] - before["toe.set"], float(traces["toe.position"].max()) - before["toe.position"],
                float(traces["head.contact_force"].max()), rod["stress.compression"].copy(), rod["stress.tension"].copy(),
                residual / (steps - tail), most, hammer["energy.start"], unbalanced, rod["energy.kinetic"], traces)


def blow_figures(made: Prepared, blow: Blow) -> Sequence[tuple[str, float | None, str]]:
    """Name, value and unit of what is told of a blow."""
    middle = 0.5 * (made.depths[1:] + made.depths[:-1])
    return (
        ("set", blow.set, "m"), ("blows_per_0.3_m", blow.count, "1"), ("toe_displacement", blow.toe_displacement, "m"),
        ("head_force", blow.head_force, "N"), ("compression", float(blow.compression.max()), "Pa"),
        ("compression_depth", float(middle[blow.compression.argmax()]), "m"), ("tension", float(blow.tension.max()), "Pa"),
        ("tension_depth", float(middle[blow.tension.argmax()]), "m"), ("transferred_energy", blow.transferred, "J"),
        ("energy_ratio", blow.transferred / made.rated_energy, "1"), ("residual_force", float(np.abs(blow.residual).max()), "N"),
        ("energy_unbalanced", blow.unbalanced / blow.impact_energy, "1"), ("energy_moving", blow.moving / blow.impact_energy, "1"))
