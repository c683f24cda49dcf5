"""Blows on a rod: hammer and rod step by step, coupled by waves, without FMUs.

The exchange step is the travel time of a segment, so that everything that travels is exact. The
hammer makes it as one internal step: its force is then constant in it, and the coupling loses no
energy. The loop of the co-simulation core does not serve here: between two blows the rod goes on
alone until it is at rest, and each blow has a new ram.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from rockshed.components.common.component import Instance

from ...sites.pile.preparation import PreparedPile
from ..frame import Count, FloatArray

FOOT = 0.3
"""Penetration (m) that blows are counted for."""
_LONGEST_REST, _AT_REST = 100, 1e-12
"""Travel times that a rod may take to come to rest, and the part of the impact energy left then."""
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
_HEAD_ENERGY = "energy.head"
"""Output of the rod: work on its head (J)."""


@dataclass(frozen=True)
class Blow:
    """Results of one blow in SI units; compression is positive, and so is tension.

    Attributes
    ----------
    resistance : float
        Ultimate resistance of the soil (N).
    set, toe_displacement : float
        Penetration that stays, and largest displacement of the toe (m).
    head_force : float
        Largest force on the head (N).
    compression, tension : array of float, shape (segments,)
        Largest stresses in this blow (Pa).
    residual : array of float, shape (segments,)
        Force when the rod has come to rest (N).
    transferred, impact_energy : float
        Largest work on the head, and energy with which the ram strikes (J).
    unbalanced : float
        Error of the energy balance (J).
    moving : float
        Kinetic energy of the rod at the end of the blow's time (J).
    traces : mapping of str to array of float, shape (steps,)
        ``time`` (s) from the stroke on, and the outputs in :data:`TRACES`.
    """

    resistance: float
    set: float
    toe_displacement: float
    head_force: float
    compression: FloatArray
    tension: FloatArray
    residual: FloatArray
    transferred: float
    impact_energy: float
    unbalanced: float
    moving: float
    traces: Mapping[str, FloatArray] = field(default_factory=dict)

    @property
    def count(self) -> float | None:
        """Blows per 0.3 m; None where nothing stays."""
        return FOOT / self.set if self.set > 0.0 else None


def drive(pile: PreparedPile, count: Count = lambda done, total: None) -> list[Blow]:
    """Compute the blows of a site, one after the other.

    Parameters
    ----------
    pile : PreparedPile
        With hammer and rod.
    count : Count
        Called with the numbers of blows done and of all.

    Returns
    -------
    list of Blow
        Rod and soil keep from blow to blow what is in them.
    """
    rod = pile.rod()
    blows = []
    for number in range(pile.site.blows):
        blows.append(strike(pile, rod, number * pile.steps, pile.resistance))
        count(number + 1, pile.site.blows)
    return blows


@dataclass(frozen=True)
class BearingPoint:
    """First and last blow for one ultimate resistance of a bearing graph, without traces."""

    first: Blow
    last: Blow


def bearing_graph(
    pile: PreparedPile, count: Count = lambda done, total: None
) -> list[BearingPoint]:
    """Compute blows for each ultimate resistance of the bearing graph.

    Parameters
    ----------
    pile : PreparedPile
        With hammer and rod.
    count : Count
        Called with the numbers of resistances done and of all.

    Returns
    -------
    list of BearingPoint
        By rising resistance; empty if the site has no bearing graph. Where it has one blow, or no
        last one is wanted, first and last blow are one.
    """
    wanted = pile.site.bearing
    resistances = sorted(wanted.resistances) if wanted else []
    blows = pile.site.blows if wanted and wanted.last_blow else 1
    points = []
    for number, resistance in enumerate(resistances, 1):
        rod = pile.rod(resistance)
        struck = [
            replace(strike(pile, rod, blow * pile.steps, resistance), traces={})
            for blow in range(blows)
        ]
        points.append(BearingPoint(struck[0], struck[-1]))
        count(number, len(resistances))
    return points


def strike(pile: PreparedPile, rod: Instance, begun: int, resistance: float) -> Blow:
    """Compute one blow.

    Parameters
    ----------
    pile : PreparedPile
        With the hammer and the times.
    rod : Instance
        Initialised; it is left at rest, as the next blow meets it seconds later.
    begun : int
        Number of the step with which the blow begins.
    resistance : float
        Ultimate resistance of the soil (N).

    Returns
    -------
    Blow
        With traces.
    """
    hammer = pile.hammer()
    hammer["head.impedance"] = rod["head.impedance"]
    hammer.initialise()
    rod["stress.compression"][:] = 0.0
    rod["stress.tension"][:] = 0.0
    before = {name: rod[name] for name in _COUNTED}
    traces = _exchange(hammer, rod, begun, pile.steps, pile.step)
    work = traces.pop(_HEAD_ENERGY)
    unbalanced = _unbalanced(hammer, rod, before)
    moving = rod["energy.kinetic"]
    come_to_rest(rod, begun + pile.steps, pile.step, _AT_REST * hammer["energy.start"])
    return Blow(
        resistance=resistance,
        set=rod["toe.set"] - before["toe.set"],
        toe_displacement=float(traces["toe.position"].max()) - before["toe.position"],
        head_force=float(traces["head.contact_force"].max()),
        compression=rod["stress.compression"].copy(),
        tension=rod["stress.tension"].copy(),
        residual=rod["force"].copy(),
        transferred=max(0.0, float((work - before[_HEAD_ENERGY]).max())),
        impact_energy=hammer["energy.start"],
        unbalanced=unbalanced,
        moving=moving,
        traces=traces,
    )


_COUNTED = ("toe.set", "toe.position", _HEAD_ENERGY, "energy.residual", "energy.work.head")
"""Outputs of the rod that a blow adds to."""


def _exchange(
    hammer: Instance, rod: Instance, begun: int, steps: int, step: float
) -> dict[str, FloatArray]:
    """Step hammer and rod in turn, and return the outputs of the rod over time.

    The hammer takes the wave that arrives at the head, the rod the force of the hammer.
    """
    names = (*TRACES, _HEAD_ENERGY)
    kept = np.array([rod.references[name] for name in names])
    rows = np.empty((steps, len(names)))
    wave = rod.references["head.wave"]
    force = rod.references["head.force"]
    to_hammer = hammer.references["head.wave"]
    from_hammer = hammer.references["force"]
    for number in range(steps):
        time = (begun + number) * step
        hammer.w[to_hammer] = rod.w[wave]
        hammer.step(time, step)
        rod.w[force] = hammer.w[from_hammer]
        rod.step(time, step)
        rows[number] = rod.w[kept]
    traces: dict[str, FloatArray] = dict(zip(names, rows.T, strict=True))
    traces["time"] = step * np.arange(begun + 1.0, begun + steps + 1.0)
    return traces


def _unbalanced(hammer: Instance, rod: Instance, before: Mapping[str, float]) -> float:
    """Return the error of the energy balance of a blow (J).

    The works on both sides of the head add to zero if the coupling is exact.
    """
    return (
        rod["energy.residual"]
        - before["energy.residual"]
        + hammer["energy.residual"]
        + rod["energy.work.head"]
        - before["energy.work.head"]
        + hammer["energy.work.head"]
    )


def come_to_rest(rod: Instance, begun: int, step: float, energy: float) -> None:
    """Let the rod come to rest without the ram.

    Every wave that arrives at the head leaves the rod there (F = -c/2, so that none is sent down
    again), in the place of what damps it in the seconds between two blows. At rest the head bears
    no force.

    Parameters
    ----------
    rod : Instance
        Initialised.
    begun : int
        Number of the step with which the rest begins.
    step : float
        Of the exchange (s).
    energy : float
        Kinetic energy (J) of a rod at rest, at most.
    """
    segments = rod["force"].size
    wave = rod.references["head.wave"]
    force = rod.references["head.force"]
    kinetic = rod.references["energy.kinetic"]
    for number in range(_LONGEST_REST * segments):
        rod.w[force] = -0.5 * rod.w[wave]
        rod.step((begun + number) * step, step)
        if number % segments == 0 and rod.w[kinetic] <= energy:
            break
    rod.w[force] = 0.0
