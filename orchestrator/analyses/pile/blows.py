"""Blows on a rod: hammer and rod step by step, coupled by waves, without FMUs.

The exchange step is the travel time of a segment, so that everything that travels is exact. The hammer makes it as one internal
step: its force is then constant in it, and the coupling loses no energy.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.component import Instance

from .preparation import Prepared

Floats = NDArray[np.float64]
Done = Callable[[int, int], None]
"""Told the number of blows done, and of all."""

FOOT = 0.3
"""Penetration (m) that blows are counted for."""
_LONGEST_REST, _AT_REST = 100, 1e-12
"""Travel times that a rod may take to come to rest, and the part of the impact energy that moves it then."""
TRACES = {
    "head.contact_force": "N",
    "head.zv": "N",
    "toe.contact_force": "N",
    "gauge.force": "N",
    "gauge.zv": "N",
    "head.position": "m",
    "toe.position": "m",
    "toe.set": "m",
}
"""Outputs of the rod that are kept over time, and their units."""


@dataclass(frozen=True)
class Blow:
    """What a blow did. SI; compression positive, tension too.

    set: penetration that stays (m). compression, tension: largest stresses (Pa) in the segments in this blow. residual: force (N)
    in the segments when the rod has come to rest. transferred: largest work on the head (J). unbalanced: error of the energy
    balance (J). moving: kinetic energy of the rod at the end of the blow's time (J).
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
    """One blow, from the step number ``begun`` on. The rod is left at rest, as the next blow finds it seconds later."""
    hammer, steps, step = made.hammer(), made.steps, made.step
    rod["stress.compression"][:], rod["stress.tension"][:] = 0.0, 0.0
    before = {
        name: rod[name]
        for name in (
            "toe.set",
            "toe.position",
            "energy.head",
            "energy.residual",
            "energy.work.head",
        )
    }
    wave, impedance, force = (
        rod.references["head.wave"],
        rod.references["head.impedance"],
        rod.references["head.force"],
    )
    kept = np.array([rod.references[name] for name in TRACES])
    hammer.w[hammer.references["head.impedance"]] = rod.w[impedance]
    hammer.initialise()
    to_wave, of_force, work = (
        hammer.references["head.wave"],
        hammer.references["force"],
        rod.references["energy.head"],
    )
    rows, most = np.empty((steps, len(TRACES))), 0.0
    for number in range(steps):
        time = (begun + number) * step
        hammer.w[to_wave] = rod.w[wave]
        hammer.step(time, step)
        rod.w[force] = hammer.w[of_force]
        rod.step(time, step)
        rows[number] = rod.w[kept]
        most = max(most, rod.w[work] - before["energy.head"])
    traces: dict[str, Floats] = {
        **dict(zip(TRACES, rows.T)),
        "time": step * np.arange(begun + 1.0, begun + steps + 1.0),
    }
    unbalanced = (
        rod["energy.residual"]
        - before["energy.residual"]
        + hammer["energy.residual"]
        + rod["energy.work.head"]
        - before["energy.work.head"]
        + hammer["energy.work.head"]
    )
    moving = rod["energy.kinetic"]
    come_to_rest(rod, begun + steps, step, _AT_REST * hammer["energy.start"])
    return Blow(
        resistance,
        rod["toe.set"] - before["toe.set"],
        float(traces["toe.position"].max()) - before["toe.position"],
        float(traces["head.contact_force"].max()),
        rod["stress.compression"].copy(),
        rod["stress.tension"].copy(),
        rod["force"].copy(),
        most,
        hammer["energy.start"],
        unbalanced,
        moving,
        traces,
    )


def come_to_rest(rod: Instance, begun: int, step: float, energy: float) -> None:
    """Let the rod come to rest without the ram: until so much kinetic energy (J) is left, at most.

    Every wave that arrives at the head leaves the rod there (F = -c/2, so that none is sent down again), in the place of what
    damps it in the seconds between two blows. At rest the head bears no force.
    """
    segments = rod["force"].size
    wave, force, kinetic = (
        rod.references[name] for name in ("head.wave", "head.force", "energy.kinetic")
    )
    for number in range(_LONGEST_REST * segments):
        rod.w[force] = -0.5 * rod.w[wave]
        rod.step((begun + number) * step, step)
        if number % segments == 0 and rod.w[kinetic] <= energy:
            break
    rod.w[force] = 0.0


def blow_figures(made: Prepared, blow: Blow) -> Sequence[tuple[str, float | None, str]]:
    """Name, value and unit of what is told of a blow."""
    middle = 0.5 * (made.depths[1:] + made.depths[:-1])
    return (
        ("set", blow.set, "m"),
        ("blows_per_0.3_m", blow.count, "1"),
        ("toe_displacement", blow.toe_displacement, "m"),
        ("head_force", blow.head_force, "N"),
        ("compression", float(blow.compression.max()), "Pa"),
        ("compression_depth", float(middle[blow.compression.argmax()]), "m"),
        ("tension", float(blow.tension.max()), "Pa"),
        ("tension_depth", float(middle[blow.tension.argmax()]), "m"),
        ("transferred_energy", blow.transferred, "J"),
        ("energy_ratio", blow.transferred / made.rated_energy, "1"),
        ("residual_force", float(np.abs(blow.residual).max()), "N"),
        ("energy_unbalanced", blow.unbalanced / blow.impact_energy, "1"),
        ("energy_moving", blow.moving / blow.impact_energy, "1"),
    )
