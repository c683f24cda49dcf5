"""Metrics of a pile: every blow, and the whole."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...core.results.metric import Metric
from ...sites.pile.preparation import PreparedPile
from .blows import BearingPoint, Blow
from .drivability import Stage
from .formulas import by_formulas
from .rods import RodBlow


@dataclass(frozen=True)
class BlowValue:
    """A single value of a blow; None where it has none, as the blow count without a set."""

    name: str
    value: float | None
    unit: str


def blow_values(pile: PreparedPile, blow: Blow) -> list[BlowValue]:
    """Return the single values of a blow.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blow : Blow
        Of its hammer.

    Returns
    -------
    list of BlowValue
        In SI units, in the order of the files.
    """
    return [
        BlowValue("set", blow.set, "m"),
        BlowValue("blows_per_0.3_m", blow.count, "1"),
        BlowValue("toe_displacement", blow.toe_displacement, "m"),
        BlowValue("head_force", blow.head_force, "N"),
        BlowValue("compression", float(blow.compression.max()), "Pa"),
        BlowValue("compression_depth", float(pile.middles[blow.compression.argmax()]), "m"),
        BlowValue("tension", float(blow.tension.max()), "Pa"),
        BlowValue("tension_depth", float(pile.middles[blow.tension.argmax()]), "m"),
        BlowValue("transferred_energy", blow.transferred, "J"),
        BlowValue("energy_ratio", blow.transferred / pile.rated_energy, "1"),
        BlowValue("residual_force", float(np.abs(blow.residual).max()), "N"),
        BlowValue("energy_unbalanced", blow.unbalanced / blow.impact_energy, "1"),
        BlowValue("energy_moving", blow.moving / blow.impact_energy, "1"),
    ]


def formula_values(pile: PreparedPile, blow: Blow) -> list[BlowValue]:
    """Return the ultimate resistances (N) that dynamic formulas make of the set of a blow."""
    found = by_formulas(pile, blow)
    return [BlowValue("hiley", found.hiley, "N"), BlowValue("gates", found.gates, "N")]


def rod_values(rod: RodBlow) -> list[BlowValue]:
    """Return the single values of a blow on a rod of one length, in SI units."""
    return [
        BlowValue("length", rod.length, "m"),
        BlowValue("energy_ratio", rod.energy_ratio, "1"),
        BlowValue("first_wave_ratio", rod.first_wave_ratio, "1"),
        BlowValue("set", rod.blow.set, "m"),
        BlowValue("count", rod.count, "1"),
        BlowValue("count_60", rod.corrected, "1"),
        BlowValue("customary_factor", rod.customary, "1"),
    ]


def stage_values(stage: Stage) -> list[BlowValue]:
    """Return the single values of a penetration.

    Parameters
    ----------
    stage : Stage
        Of a drivability analysis.

    Returns
    -------
    list of BlowValue
        In SI units, in the order of the files; those of a blow are None where there is none.
    """
    site = stage.pile.site
    made = [
        BlowValue("penetration", stage.penetration, "m"),
        BlowValue("shaft_resistance", stage.pile.shaft_resistance, "N"),
        BlowValue("toe_resistance", site.toe.resistance, "N"),
        BlowValue("blows_per_way", stage.count, "1"),
        BlowValue("blows", stage.driven, "1"),
        BlowValue("time", stage.time, "s"),
    ]
    blow = stage.blow
    if blow is not None:
        return [*made, *blow_values(stage.pile, blow)]
    return [*made, *(BlowValue(name, None, unit) for name, unit in _BLOW_UNITS)]


_BLOW_UNITS = (
    *(("set", "m"), ("blows_per_0.3_m", "1"), ("toe_displacement", "m"), ("head_force", "N")),
    *(("compression", "Pa"), ("compression_depth", "m"), ("tension", "Pa"), ("tension_depth", "m")),
    *(("transferred_energy", "J"), ("energy_ratio", "1"), ("residual_force", "N")),
    *(("energy_unbalanced", "1"), ("energy_moving", "1")),
)
"""Names and units of :func:`blow_values`."""


def metrics_of(
    pile: PreparedPile,
    blows: Sequence[Blow],
    graph: Sequence[BearingPoint],
    stages: Sequence[Stage],
    rods: Sequence[RodBlow] = (),
) -> Iterator[Metric]:
    """Yield the metrics of a pile.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blows : sequence of Blow
        One after the other.
    graph : sequence of BearingPoint
        Of the bearing graph.
    stages : sequence of Stage
        Of the drivability analysis.
    rods : sequence of RodBlow
        Of a penetration test.

    Yields
    ------
    Metric
        ``blows``, ``penetration``, ..., ``blow.1.set``, ..., ``bearing.20000.tension``, ...
    """
    yield Metric("blows", len(blows))
    yield Metric("rated_energy", pile.rated_energy, "J")
    yield Metric("impact_energy", blows[0].impact_energy, "J")
    yield Metric("resistance", pile.resistance, "N")
    yield Metric("travel_time", pile.travel_time, "s")
    yield Metric("penetration", sum(blow.set for blow in blows), "m")
    for number, blow in enumerate(blows, 1):
        yield from _of_blow(f"blow.{number}", pile, blow)
    for point in graph:
        yield from _of_blow(f"bearing.{point.first.resistance:g}", pile, point.first)
        for entry in formula_values(pile, point.first):
            yield from _metric(f"bearing.{point.first.resistance:g}", entry)
        if point.last is not point.first:
            yield from _of_blow(f"bearing_last.{point.last.resistance:g}", pile, point.last)
            for entry in formula_values(pile, point.last):
                yield from _metric(f"bearing_last.{point.last.resistance:g}", entry)
    for stage in stages:
        for entry in stage_values(stage):
            yield from _metric(f"drivability.{stage.penetration:g}", entry)
    for rod in rods:
        for entry in rod_values(rod):
            yield from _metric(f"rod.{rod.length:g}", entry)


def _of_blow(prefix: str, pile: PreparedPile, blow: Blow) -> Iterator[Metric]:
    for entry in blow_values(pile, blow):
        yield from _metric(prefix, entry)


def _metric(prefix: str, entry: BlowValue) -> Iterator[Metric]:
    if entry.value is not None:
        yield Metric(f"{prefix}.{entry.name}", entry.value, entry.unit)
