"""Metrics of a pile: every blow, and the whole."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...core.results.metric import Metric
from ...sites.pile.preparation import PreparedPile
from .blows import Blow


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


def metrics_of(
    pile: PreparedPile, blows: Sequence[Blow], graph: Sequence[Blow]
) -> Iterator[Metric]:
    """Yield the metrics of a pile.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blows : sequence of Blow
        One after the other.
    graph : sequence of Blow
        Of the bearing graph.

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
    for blow in graph:
        yield from _of_blow(f"bearing.{blow.resistance:g}", pile, blow)


def _of_blow(prefix: str, pile: PreparedPile, blow: Blow) -> Iterator[Metric]:
    for entry in blow_values(pile, blow):
        if entry.value is not None:
            yield Metric(f"{prefix}.{entry.name}", entry.value, entry.unit)
